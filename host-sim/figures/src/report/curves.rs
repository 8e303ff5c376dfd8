//! Curves of a few points with intervals.

use std::ops::Range;

use glam::DVec2;
use plotters::style::{Color, RGBColor};

use super::chart::{Axis, BELOW_PX, LEFT_PX, chart, headed, heading_px, is_drawable, is_range, no_data};
use super::figure::{Canvas, Drawn, Figure};
use super::glyph::{dot, solid_line};
use super::legend::{self, Entry};
use super::style::{BLUE, GREEN, GREY, VERMILION, line, px};

const PLOT_PX: [f64; 2] = [360.0, 200.0];
const MARGIN_PX: f64 = 14.0;
/// Colours of the curves, repeated if there are more.
const COLOURS: [RGBColor; 3] = [VERMILION, BLUE, GREEN];
/// Margin beyond the outermost points, as a share of their span.
const ROOM: f64 = 0.06;

/// One curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its name in the legend.
    pub name: String,
    /// Its points from left to right.
    pub points: Vec<DVec2>,
    /// Half width of each point's interval; empty without intervals.
    pub reach: Vec<f64>,
}

/// Draws curves into one chart with the zero line. Points that are not finite are left out.
pub fn curves(title: &str, x_name: &str, y_name: &str, curves: &[Curve]) -> Figure {
    let entries: Vec<Entry> = curves
        .iter()
        .zip(COLOURS.iter().cycle())
        .map(|(curve, colour)| {
            Entry::new(curve.name.clone(), |canvas, at| solid_line(canvas, &legend::stroke(at), line(*colour, 1.5)))
        })
        .collect();
    let width_px = LEFT_PX + PLOT_PX[0] + 2.0 * MARGIN_PX;
    let legend_px = f64::from(legend::height_px(&entries, width_px - 2.0 * MARGIN_PX));
    let plot_px = heading_px(0) + PLOT_PX[1] + BELOW_PX;
    let height_px = plot_px + legend_px + 2.0 * MARGIN_PX;
    Figure::draw(width_px as u32, height_px as u32, |canvas| {
        let inner = canvas.margin(px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX));
        let (plot, strip) = inner.split_vertically(px(plot_px));
        draw(&headed(&plot, title, &[])?, x_name, y_name, curves)?;
        legend::draw(&strip, &entries)
    })
}

fn draw(canvas: &Canvas, x_name: &str, y_name: &str, curves: &[Curve]) -> Drawn {
    let drawable = |curve: &Curve| -> Vec<(DVec2, f64)> {
        let reach = curve.reach.iter().copied().chain(std::iter::repeat(0.0));
        curve.points.iter().copied().zip(reach).filter(|(p, r)| is_drawable(*p) && r.is_finite()).collect()
    };
    let shown: Vec<Vec<(DVec2, f64)>> = curves.iter().map(drawable).collect();
    let points = || shown.iter().flatten();
    let x_range = spanned(points().map(|(p, _)| p.x));
    let y_range = spanned(points().flat_map(|(p, r)| [0.0, p.y - r, p.y + r]));
    if !is_range(&x_range) || !is_range(&y_range) {
        return no_data(canvas);
    }
    let chart = chart(canvas, &Axis::new(x_name, x_range.clone(), 6), &Axis::new(y_name, y_range, 5))?;
    let zero = [chart.place(x_range.start, 0.0), chart.place(x_range.end, 0.0)];
    solid_line(&chart.canvas, &zero, line(GREY, 0.75))?;
    for (points, colour) in shown.iter().zip(COLOURS.iter().cycle()) {
        let places: Vec<_> = points.iter().map(|(p, _)| chart.place(p.x, p.y)).collect();
        solid_line(&chart.canvas, &places, line(*colour, 1.5))?;
        for ((point, reach), place) in points.iter().zip(&places) {
            let ends = [chart.place(point.x, point.y - reach), chart.place(point.x, point.y + reach)];
            solid_line(&chart.canvas, &ends, line(*colour, 0.75))?;
            dot(&chart.canvas, *place, 2.5, colour.mix(1.0))?;
        }
    }
    Ok(())
}

fn spanned(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let room = ROOM * (high - low);
    low - room..high + room
}
