//! Figure 3 of the paper: the response of a sonar network over distance and incidence angle, with test data.
//!
//! The paper shows two views of each surface in space. This shows one in space and one from above, in which no point
//! hides another and a point that agrees with the surface has its colour.

mod from_above;
mod in_space;

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::axis::{Axis, is_range, share};
use super::chart::{heading, heading_px, no_data};
use super::figure::{CHART_PX, Figure, MARGIN_PX};
use super::glyph::bead;
use super::legend::Entry;
use super::style::{Colour, number};
use super::svg::{Area, Svg};

const VIEW_PX: f64 = CHART_PX - 2.0 * MARGIN_PX;
const MAP_PX: f64 = 440.0;
const ROW_PX: f64 = 300.0;
const GAP_PX: f64 = 14.0;
const MOST_TICKS: usize = 6;

/// The response surface of a network and its test data.
pub struct Surface<'a> {
    /// The network's name.
    pub title: String,
    /// Quantity and unit of the value.
    pub value_name: String,
    /// The response at a distance D (cm) and an incidence angle α (degrees).
    pub at: Box<dyn Fn(f64, f64) -> f64 + 'a>,
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
    let rows = surfaces.len().max(1);
    let row_px = heading_px("title", 0) + ROW_PX + GAP_PX;
    Figure::draw(VIEW_PX + MAP_PX, rows as f64 * row_px, &legend(surfaces), |svg, space| {
        if surfaces.is_empty() {
            no_data(svg, space);
        }
        for (row, surface) in space.cells(rows, 1).zip(surfaces) {
            let body = heading(svg, row, &surface.title, &[]).without([0.0, 0.0, 0.0, GAP_PX]);
            if surface.is_blank() {
                no_data(svg, body);
                continue;
            }
            let (view, map) = body.split_across(VIEW_PX);
            in_space::draw(svg, view, surface);
            from_above::draw(svg, map.without([GAP_PX, 0.0, 0.0, 0.0]), surface);
        }
    })
}

fn legend(surfaces: &[Surface]) -> Vec<Entry> {
    let mut entries = Vec::new();
    if surfaces.iter().any(|s| !s.test.is_empty()) {
        entries
            .push(Entry::new("test sample, in the colour of its value", |svg, at| bead(svg, at, Colour::viridis(0.7))));
    }
    if surfaces.iter().any(from_above::has_gaps) {
        entries.push(Entry::new("no data", |svg, at| {
            from_above::hatch(svg, Area { left: at.x - 9.0, top: at.y - 6.0, width: 18.0, height: 12.0 });
        }));
    }
    entries
}

impl Surface<'_> {
    /// Draws it as a sheet in space, alone.
    pub fn in_space(&self) -> Figure {
        self.alone(in_space::draw)
    }

    /// Draws it as colours on the plane of distance and angle, alone.
    pub fn from_above(&self) -> Figure {
        self.alone(from_above::draw)
    }

    fn alone(&self, draw: fn(&mut Svg, Area, &Surface)) -> Figure {
        let entries = legend(std::slice::from_ref(self));
        Figure::draw(VIEW_PX, ROW_PX, &entries, |svg, space| {
            if self.is_blank() { no_data(svg, space) } else { draw(svg, space, self) }
        })
    }

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

    /// What is read at a place: distance, angle and value.
    fn reading(&self, place: DVec2, value: f64) -> String {
        let [distance, incidence] =
            [along(&self.distance_cm, place.x), along(&self.incidence_deg, place.y)].map(|v| number(v, 0));
        let decimals = if self.value.end - self.value.start < 10.0 { 2 } else { 0 };
        format!("{distance} cm, {incidence}°: {}", number(along(&self.value, value), decimals))
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

/// The value at a share of a range.
fn along(range: &Range<f64>, share: f64) -> f64 {
    range.start + share * (range.end - range.start)
}
