//! Points of several kinds in a plane of fixed ranges.

use std::ops::Range;

use glam::DVec2;

use super::axis::{Axis, is_drawable, is_range};
use super::chart::{ABOVE_PX, BELOW_PX, Plane, no_data};
use super::figure::Figure;
use super::glyph::arrowhead;
use super::legend::Entry;
use super::style::{Colour, GREY, Style};

const PLOT_PX: f64 = 240.0;
const DOT_PX: f64 = 1.9;
const ARROW_PX: f64 = 7.0;
/// Number of points above which they are drawn fainter.
const CROWD: usize = 400;

/// Points in a plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScatterChart {
    /// Quantity and unit along the chart.
    pub x_name: String,
    /// Quantity and unit upwards.
    pub y_name: String,
    /// Values along the chart.
    pub x_range: Range<f64>,
    /// Values upwards.
    pub y_range: Range<f64>,
    /// A grey line between two points, if any.
    pub guide: Option<[DVec2; 2]>,
    /// The points; later kinds cover earlier ones.
    pub kinds: Vec<Kind>,
}

/// Points of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Kind {
    /// Its name in the legend.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Whether points are rings and not discs.
    pub hollow: bool,
    /// Its points. Those beyond the ranges become arrowheads at the edge.
    pub points: Vec<DVec2>,
}

impl ScatterChart {
    /// Draws the points; kinds without points are not in the legend.
    pub fn draw(&self) -> Figure {
        let shown: Vec<&Kind> = self.kinds.iter().filter(|kind| !kind.points.is_empty()).collect();
        let entry = |kind: &&Kind| {
            let style = kind.style(1.0);
            Entry::new(kind.name.clone(), move |svg, at| svg.circle(at, 1.5 * DOT_PX, style))
        };
        let entries: Vec<Entry> = shown.iter().map(entry).collect();
        Figure::chart("", ABOVE_PX + PLOT_PX + BELOW_PX, &entries, |svg, space| {
            if !is_range(&self.x_range) || !is_range(&self.y_range) {
                return no_data(svg, space);
            }
            let axis = |name: &str, range: &Range<f64>| Axis::new(name, range.clone(), 6);
            let plane = Plane::new(space, axis(&self.x_name, &self.x_range), axis(&self.y_name, &self.y_range));
            plane.draw_axes(svg);
            let place = |at: DVec2| plane.place(at.x, at.y);
            svg.clipped(plane.area, |svg| {
                self.guide.iter().for_each(|ends| svg.line(&ends.map(place), GREY.line(1.0)));
            });
            let low = DVec2::new(self.x_range.start, self.y_range.start);
            let high = DVec2::new(self.x_range.end, self.y_range.end);
            for kind in &shown {
                let points = || kind.points.iter().copied().filter(|point| is_drawable(*point));
                let is_within = |point: &DVec2| point.clamp(low, high) == *point;
                let opacity = if kind.points.len() > CROWD { 0.45 } else { 0.75 };
                svg.group(kind.style(opacity), |svg| {
                    points().filter(is_within).for_each(|point| svg.circle(place(point), DOT_PX, Style::default()));
                });
                for point in points().filter(|point| !is_within(point)) {
                    let edge = point.clamp(low, high);
                    let direction = ((point - edge) * DVec2::new(1.0, -1.0)).normalize_or_zero();
                    arrowhead(svg, place(edge) - direction * ARROW_PX, direction, ARROW_PX, kind.colour);
                }
            }
        })
    }
}

impl Kind {
    fn style(&self, opacity: f64) -> Style {
        if self.hollow { self.colour.line(1.0).opacity(opacity) } else { self.colour.fill().opacity(opacity) }
    }
}
