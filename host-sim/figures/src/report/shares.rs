//! Shares with intervals, one per row below its name: what a gap is made of, how frequent effects are.

use glam::DVec2;

use super::axis::Axis;
use super::chart::{BELOW_PX, Plane, no_data};
use super::figure::Figure;
use super::style::{Colour, INK, TEXT_PX, Text, WHITE, number, shortened};
use super::svg::{Area, Svg};

/// Height of a row.
const ROW_PX: f64 = 42.0;
const BAR_PX: f64 = 15.0;
/// Room left of the rows for half of the axis' first number.
const LEFT_PX: f64 = 6.0;
/// Half height of the ends of an interval.
const TICK_PX: f64 = 4.0;

/// Shares of something.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShareChart {
    /// Title; may be empty.
    pub title: String,
    /// What they are shares of, in per cent.
    pub axis: String,
    /// From the top.
    pub rows: Vec<Share>,
    /// Drawn as points on their intervals, otherwise as bars from zero.
    pub points: bool,
}

/// One share.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// Its name.
    pub name: String,
    /// From 0 to 1.
    pub share: f64,
    /// 95 % interval of it.
    pub interval: [f64; 2],
    /// Colour of its bar or point.
    pub colour: Colour,
}

impl ShareChart {
    /// Draws the shares.
    pub fn draw(&self) -> Figure {
        let body_px = self.rows.len().max(1) as f64 * ROW_PX + BELOW_PX;
        Figure::chart(&self.title, body_px, &[], |svg, space| {
            if self.rows.is_empty() {
                return no_data(svg, space);
            }
            let plane = Plane::of_rows(space, Axis::new(self.axis.as_str(), 0.0..100.0, 5), self.rows.len(), LEFT_PX);
            plane.draw_axes(svg);
            for (row, share) in self.rows.iter().enumerate() {
                let title = format!("{}: {}", share.name, percent_within(share.share, share.interval));
                svg.titled(&title, |svg| self.draw_row(svg, &plane, row as f64, share));
            }
        })
    }

    fn draw_row(&self, svg: &mut Svg, plane: &Plane, row: f64, Share { name, share, interval, colour }: &Share) {
        let place = |share: f64| plane.place(100.0 * share.clamp(0.0, 1.0), row);
        let middle = DVec2::Y * (ROW_PX - BAR_PX / 2.0 - 4.0);
        let [from, to, low, high] = [0.0, *share, interval[0], interval[1]].map(|share| place(share) + middle);
        if self.points {
            svg.line(&[low, high], colour.line(4.0).opacity(0.5));
            svg.circle(to, 5.0, WHITE.fill().rimmed(*colour, 2.25));
        } else {
            let bar = Area { left: from.x, top: from.y - BAR_PX / 2.0, width: to.x - from.x, height: BAR_PX };
            svg.rect(bar, colour.fill());
            svg.line(&[low, high], INK.line(1.5));
            for end in [low, high] {
                svg.line(&[end - DVec2::Y * TICK_PX, end + DVec2::Y * TICK_PX], INK.line(1.5));
            }
        }
        let label = format!("{} %\u{2002}{name}", number(100.0 * share, 0));
        let label = shortened(&label, TEXT_PX, plane.area.width - 4.0);
        svg.text(place(0.0) + DVec2::new(4.0, 12.0), &label, Text::new(TEXT_PX, INK).from_here());
    }
}

fn percent_within(share: f64, interval: [f64; 2]) -> String {
    let [share, low, high] = [share, interval[0], interval[1]].map(|share| number(100.0 * share, 0));
    format!("{share} % ({low} to {high})")
}
