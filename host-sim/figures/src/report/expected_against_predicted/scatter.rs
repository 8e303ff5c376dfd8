//! Scatter diagram of quantities, one point a sample.

use glam::DVec2;
use plotters::style::Color;

use super::{heading, lines};
use crate::report::chart::{Axis, chart, is_drawable, is_range, no_data};
use crate::report::figure::{Canvas, Drawn};
use crate::report::glyph::{arrowhead, dot};
use crate::report::style::{BLUE, INK, px};
use crate::report::trend::Trend;

/// Predictions farther from the expected values than this share of their span are drawn at the frame's edge: one wild
/// prediction must not press all others into a line.
const REACH: f64 = 0.5;
const EDGE: f64 = 0.04;
const DOT_PX: f64 = 1.75;
const ARROW_PX: f64 = 7.0;
/// Number of points above which they are drawn fainter.
const CROWD: usize = 600;

/// Draws the samples, their trend and the diagonal; a trend counts every finite sample, beyond the frame too.
pub fn draw(cell: &Canvas, title: &str, unit: &str, pairs: &[DVec2]) -> Drawn {
    let points: Vec<DVec2> = pairs.iter().copied().filter(|p| is_drawable(*p)).collect();
    let trend = Trend::of(&points);
    let frame = frame(&points);
    let (low, high) = frame.unwrap_or((0.0, 1.0));
    let beyond = points.iter().filter(|p| !(low..=high).contains(&p.y)).count();
    let mut counts = format!("n = {}", points.len());
    for (count, what) in [(beyond, "beyond the frame"), (pairs.len() - points.len(), "not drawable")] {
        if count > 0 {
            counts += &format!(", {count} {what}");
        }
    }
    let body = heading(cell, title, trend, counts)?;
    let axis = |name: &str| Axis::new(format!("{name} ({unit})"), low..high, 6);
    let chart = chart(&body, &axis("expected"), &axis("predicted"))?;
    if frame.is_none() {
        return no_data(&chart.canvas);
    }
    let colour = BLUE.mix(if points.len() > CROWD { 0.3 } else { 0.5 });
    for point in &points {
        let (right, down) = chart.place(point.x, point.y.clamp(low, high));
        if point.y > high {
            arrowhead(&chart.canvas, (right, down + px(ARROW_PX)), DVec2::Y, ARROW_PX, INK)?;
        } else if point.y < low {
            arrowhead(&chart.canvas, (right, down - px(ARROW_PX)), DVec2::NEG_Y, ARROW_PX, INK)?;
        } else {
            dot(&chart.canvas, (right, down), DOT_PX, colour)?;
        }
    }
    lines(&chart, low, high, trend)
}

/// Common range of both axes: all expected values, and the predictions not far beyond them.
fn frame(points: &[DVec2]) -> Option<(f64, f64)> {
    let expected = points.iter().map(|p| p.x);
    let (least, most) = (expected.clone().reduce(f64::min)?, expected.reduce(f64::max)?);
    let reach = REACH * (most - least);
    let near = points.iter().map(|p| p.y).filter(|y| (least - reach..=most + reach).contains(y));
    let (low, high) = near.fold((least, most), |(low, high), y| (low.min(y), high.max(y)));
    let edge = if is_range(&(low..high)) { EDGE * (high - low) } else { low.abs().max(1.0) / 2.0 };
    Some((low - edge, high + edge))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wild_prediction_does_not_widen_the_frame() {
        let tame = [DVec2::new(0.0, 1.0), DVec2::new(10.0, 12.0)];
        assert_eq!(frame(&tame), Some((-0.48, 12.48)));
        assert_eq!(frame(&[tame[0], tame[1], DVec2::new(5.0, 1e9)]), Some((-0.48, 12.48)));
    }

    #[test]
    fn one_value_still_has_a_frame() {
        assert_eq!(frame(&[DVec2::new(3.0, 3.0)]), Some((1.5, 4.5)));
        assert_eq!(frame(&[]), None);
    }
}
