//! Points with intervals along an axis, one colour and mark per kind, joined by lines or not.

use std::ops::Range;

use glam::DVec2;

use super::axis::{Axis, is_drawable, is_range, span};
use super::chart::{ABOVE_PX, BELOW_PX, Plane, no_data};
use super::figure::Figure;
use super::glyph::mark;
use super::legend::{self, Entry};
use super::style::{BLUE, Colour, GREEN, GREY, INK, SMALL_PX, SOLID, Text, VERMILION, number};
use super::svg::{Area, Svg};

const PLOT_PX: f64 = 190.0;
/// Room above the plane for remarks.
const REMARK_PX: f64 = 16.0;
/// Margin beyond the outermost points, as a share of their span.
const ROOM: f64 = 0.06;
const MOST_TICKS: usize = 6;
/// A band is at least as wide, px.
const LEAST_BAND_PX: f64 = 2.0;
/// Colours of the curves, repeated if there are more.
const COLOURS: [Colour; 3] = [BLUE, VERMILION, GREEN];

/// Curves in one chart, with a line at zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurveChart {
    /// Title; may be empty.
    pub title: String,
    /// Quantity and unit along the chart.
    pub x_name: String,
    /// Quantity and unit upwards.
    pub y_name: String,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Whole numbers along the chart at which ticks may be; round numbers if there are none.
    pub counts: Vec<usize>,
    /// Lowest and highest value; as the points need it if `None`.
    pub y_range: Option<Range<f64>>,
    /// Whether points stand alone, each curve a little to the side of the one before.
    pub apart: bool,
    /// Words above the chart at places along it.
    pub remarks: Vec<(f64, String)>,
    /// Whether curves are lines without marks, for many points. A point that is not finite then breaks its line.
    pub dense: bool,
    /// Ranges along the chart with a grey ground, and what is read there under the pointer.
    pub bands: Vec<(Range<f64>, String)>,
    /// What the bands are, in the legend.
    pub bands_name: String,
}

/// One curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Its name in the legend.
    pub name: String,
    /// Its points from left to right.
    pub points: Vec<Point>,
}

/// A point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where it is.
    pub at: DVec2,
    /// 95 % interval of its value; from the value to the value without one.
    pub interval: [f64; 2],
}

impl Point {
    /// A point without an interval.
    pub fn new(x: f64, y: f64) -> Self {
        Point { at: DVec2::new(x, y), interval: [y, y] }
    }

    fn is_drawable(&self) -> bool {
        is_drawable(self.at) && is_drawable(DVec2::from_array(self.interval))
    }
}

impl CurveChart {
    /// Draws the curves. Points that are not finite are left out.
    pub fn draw(&self) -> Figure {
        let entries = self.entries();
        let above_px = ABOVE_PX + if self.remarks.is_empty() { 0.0 } else { REMARK_PX };
        Figure::chart(&self.title, above_px + PLOT_PX + BELOW_PX, &entries, |svg, space| {
            let points = || self.curves.iter().flat_map(|curve| &curve.points).filter(|p| p.is_drawable());
            let x_range = wider(span(points().map(|p| p.at.x)));
            let y_range = span(points().flat_map(|p| [0.0, p.at.y, p.interval[0], p.interval[1]]));
            let y_range = self.y_range.clone().unwrap_or(y_range);
            if !is_range(&x_range) || !is_range(&y_range) {
                return no_data(svg, space);
            }
            let x = if self.counts.is_empty() {
                Axis::new(self.x_name.as_str(), x_range, MOST_TICKS)
            } else {
                Axis::of_counts(self.x_name.as_str(), x_range, &self.counts, 2 * MOST_TICKS)
            };
            let space = space.without([0.0, above_px - ABOVE_PX, 0.0, 0.0]);
            let plane = Plane::new(space, x.clone(), Axis::rounded(self.y_name.as_str(), y_range, 4));
            self.draw_bands(svg, &plane);
            plane.draw_axes(svg);
            let zero = [plane.place(x.range.start, 0.0), plane.place(x.range.end, 0.0)];
            svg.line(&zero, GREY.line(1.0));
            for (kind, curve) in self.curves.iter().enumerate() {
                self.draw_curve(svg, &plane, kind, curve);
            }
            for (x, words) in &self.remarks {
                let at = DVec2::new(plane.place(*x, 0.0).x, space.top - REMARK_PX / 2.0);
                svg.text(at, words, Text::new(SMALL_PX, INK).bold());
            }
        })
    }

    fn entries(&self) -> Vec<Entry> {
        let curve = |(kind, curve): (usize, &Curve)| {
            let (colour, joined, marked) = (COLOURS[kind % COLOURS.len()], !self.apart, !self.dense);
            Entry::new(curve.name.clone(), move |svg, at| {
                if joined {
                    svg.line(&legend::stroke(at), colour.line(1.75));
                }
                if marked {
                    mark(svg, at, kind, colour);
                }
            })
        };
        let bands = (!self.bands.is_empty()).then(|| {
            Entry::new(self.bands_name.clone(), |svg, at| {
                svg.rect(Area { left: at.x - 7.0, top: at.y - 6.0, width: 14.0, height: 12.0 }, SOLID.fill());
            })
        });
        self.curves.iter().enumerate().map(curve).chain(bands).collect()
    }

    fn draw_bands(&self, svg: &mut Svg, plane: &Plane) {
        for (along, title) in &self.bands {
            let (from, to) = (plane.place(along.start, 0.0).x, plane.place(along.end, 0.0).x);
            let width = (to - from).max(LEAST_BAND_PX);
            svg.titled(title, |svg| svg.rect(Area { left: from, width, ..plane.area }, SOLID.fill()));
        }
    }

    fn draw_curve(&self, svg: &mut Svg, plane: &Plane, kind: usize, curve: &Curve) {
        let colour = COLOURS[kind % COLOURS.len()];
        if self.dense {
            for piece in curve.points.split(|point| !point.is_drawable()) {
                let places: Vec<DVec2> = piece.iter().map(|point| plane.place(point.at.x, point.at.y)).collect();
                svg.line(&places, colour.line(1.25).opacity(0.85));
            }
            return;
        }
        // Half of the curves are to the left, half to the right.
        let aside = if self.apart { 4.5 * (2.0 * kind as f64 + 1.0 - self.curves.len() as f64) } else { 0.0 };
        let place = |x: f64, y: f64| plane.place(x, y) + DVec2::X * aside;
        let points: Vec<&Point> = curve.points.iter().filter(|p| p.is_drawable()).collect();
        if !self.apart {
            let places: Vec<DVec2> = points.iter().map(|p| place(p.at.x, p.at.y)).collect();
            svg.line(&places, colour.line(1.75).opacity(0.7));
        }
        for Point { at, interval: [low, high] } in points {
            let interval =
                if low < high { format!(" ({} to {})", number(*low, 2), number(*high, 2)) } else { String::new() };
            svg.titled(&format!("{}: {}{interval}", curve.name, number(at.y, 2)), |svg| {
                if low < high {
                    svg.line(&[place(at.x, *low), place(at.x, *high)], colour.line(2.0).opacity(0.6));
                }
                mark(svg, place(at.x, at.y), kind, colour);
            });
        }
    }
}

/// A range with some room beyond its ends; one value has as much room as a step of one.
fn wider(range: Range<f64>) -> Range<f64> {
    let span = range.end - range.start;
    let room = if span > 0.0 { ROOM * span } else { 0.5 };
    range.start - room..range.end + room
}
