//! Figure 3 of the paper: the response of a sonar network over distance and incidence angle, with test data.
//!
//! The paper shows two views of each surface in space. This shows one in space and one from above, in which no point
//! hides another and a point that agrees with the surface has its colour.

mod from_above;
mod in_space;

use std::ops::Range;

use glam::DVec3;
use plotters::prelude::{ColorMap, ViridisRGB};
use plotters::style::RGBColor;

use super::chart::{Axis, headed, heading_px, is_range, no_data, share};
use super::figure::{Canvas, Figure};
use super::glyph::bead;
use super::legend::{self, Entry};
use super::style::px;

const VIEW_PX: f64 = 400.0;
const MAP_PX: f64 = 440.0;
const ROW_PX: f64 = 300.0;
const MARGIN_PX: f64 = 14.0;
const MOST_TICKS: usize = 6;

/// The response surface of a network and its test data.
pub struct Surface<'a> {
    /// The network's name.
    pub title: String,
    /// Quantity and unit of the value.
    pub value_name: String,
    /// The response at a distance D (cm) and an incidence angle α (degrees).
    pub at: &'a dyn Fn(f64, f64) -> f64,
    /// Whether there are data near a distance and an angle; elsewhere the response is a guess, and is not shown as one.
    pub known: Box<dyn Fn(f64, f64) -> bool + 'a>,
    /// Distances shown, cm.
    pub distance_cm: Range<f64>,
    /// Incidence angles shown, degrees.
    pub incidence_deg: Range<f64>,
    /// Values shown; those beyond are drawn at the end of the scale.
    pub value: Range<f64>,
    /// Test data: `x` distance in cm, `y` incidence angle in degrees, `z` value.
    pub test: Vec<DVec3>,
}

/// Draws a row for every network. Test data outside the ranges of distance and angle, or not finite, are left out.
pub fn sonar_surfaces(surfaces: &[Surface]) -> Figure {
    let inner_px = VIEW_PX + MAP_PX;
    let row_px = heading_px(0) + ROW_PX + MARGIN_PX;
    let entries = &legend(surfaces);
    let legend_px = f64::from(legend::height_px(entries, inner_px));
    let rows = surfaces.len().max(1);
    let height_px = rows as f64 * row_px + legend_px + 2.0 * MARGIN_PX;
    Figure::draw((inner_px + 2.0 * MARGIN_PX) as u32, height_px as u32, |canvas| {
        let inner = canvas.margin(px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX));
        let (grid, strip) = inner.split_vertically(px(rows as f64 * row_px));
        for (row, surface) in grid.split_evenly((rows, 1)).iter().zip(surfaces) {
            let body = headed(row, &surface.title, &[])?.margin(0, px(MARGIN_PX), 0, 0);
            if surface.is_blank() {
                no_data(&body)?;
                continue;
            }
            let (view, map) = body.split_horizontally(px(VIEW_PX));
            in_space::draw(&view, surface)?;
            from_above::draw(&map, surface)?;
        }
        if surfaces.is_empty() {
            no_data(&grid)?;
        }
        legend::draw(&strip, entries)
    })
}

fn legend(surfaces: &[Surface]) -> Vec<Entry<'static>> {
    let mut entries = Vec::new();
    if surfaces.iter().any(|s| !s.test.is_empty()) {
        let mark = |canvas: &Canvas, at| bead(canvas, at, colour(0.7));
        entries.push(Entry::new("test sample, coloured by its own value", mark));
    }
    if surfaces.iter().any(from_above::has_gaps) {
        entries.push(Entry::new("no data", |canvas, (x, y)| {
            from_above::hatched(canvas, [(x - px(6.0), y - px(6.0)), (x + px(6.0), y + px(6.0))])
        }));
    }
    entries
}

impl Surface<'_> {
    /// Whether there is nothing to show: an axis without a span.
    fn is_blank(&self) -> bool {
        ![&self.distance_cm, &self.incidence_deg, &self.value].into_iter().all(is_range)
    }

    /// The surface at a share of both ranges.
    fn at_share(&self, distance: f64, incidence: f64) -> f64 {
        (self.at)(along(&self.distance_cm, distance), along(&self.incidence_deg, incidence))
    }

    /// Whether there are data near a share of both ranges.
    fn is_known_at(&self, distance: f64, incidence: f64) -> bool {
        (self.known)(along(&self.distance_cm, distance), along(&self.incidence_deg, incidence))
    }

    /// A value as a share of the scale, clamped to it; `None` if it is not finite.
    fn share_of_value(&self, value: f64) -> Option<f64> {
        let share = share(&self.value, value.clamp(self.value.start, self.value.end));
        (!share.is_nan()).then_some(share)
    }

    /// The test data within the ranges, as shares of them.
    fn test_shares(&self) -> impl Iterator<Item = DVec3> {
        self.test.iter().filter_map(|sample| {
            let (distance, incidence) = (share(&self.distance_cm, sample.x), share(&self.incidence_deg, sample.y));
            let inside = (0.0..=1.0).contains(&distance) && (0.0..=1.0).contains(&incidence);
            let value = self.share_of_value(sample.z)?;
            inside.then_some(DVec3::new(distance, incidence, value))
        })
    }

    fn distance_axis(&self) -> Axis {
        Axis::new("distance D (cm)", self.distance_cm.clone(), MOST_TICKS)
    }

    fn incidence_axis(&self) -> Axis {
        Axis::new("incidence angle α (°)", self.incidence_deg.clone(), MOST_TICKS)
    }

    fn value_axis(&self) -> Axis {
        Axis::new(self.value_name.as_str(), self.value.clone(), MOST_TICKS)
    }
}

/// What lies at a share of a range.
fn along(range: &Range<f64>, share: f64) -> f64 {
    range.start + share * (range.end - range.start)
}

/// The colour of a share of the scale.
fn colour(share: f64) -> RGBColor {
    ViridisRGB.get_color(share)
}
