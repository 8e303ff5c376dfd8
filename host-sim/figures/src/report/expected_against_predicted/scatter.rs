//! Scatter diagram of quantities, one point a sample.

use glam::DVec2;

use super::{headed, lines};
use crate::report::axis::{Axis, is_drawable, is_range};
use crate::report::chart::{Plane, no_data};
use crate::report::glyph::arrowhead;
use crate::report::style::{BLUE, INK};
use crate::report::svg::{Area, Svg};
use crate::report::trend::Trend;

/// Predictions farther from the expected values than this share of their span are drawn at the frame's edge: one wild
/// prediction must not press all others into a line.
const REACH: f64 = 0.5;
const EDGE: f64 = 0.04;
const DOT_PX: f64 = 1.75;
const ARROW_PX: f64 = 7.0;
/// Number of points above which they are drawn fainter.
const CROWD: usize = 600;
/// Most points that are drawn: of more, evenly spread ones are.
const MOST_DRAWN: usize = 1500;

/// Draws the samples, their trend and the diagonal; the trend includes every finite sample, beyond the frame too.
pub fn draw(svg: &mut Svg, space: Area, title: &str, unit: &str, pairs: &[DVec2]) {
    let points: Vec<DVec2> = pairs.iter().copied().filter(|p| is_drawable(*p)).collect();
    let trend = Trend::of(&points);
    let frame = frame(&points);
    let (low, high) = frame.unwrap_or((0.0, 1.0));
    let every = points.len().div_ceil(MOST_DRAWN).max(1);
    let drawn = || points.iter().step_by(every);
    let beyond = points.iter().filter(|p| !(low..=high).contains(&p.y)).count();
    let mut counts = format!("n = {}", points.len());
    let fewer = if every > 1 { drawn().count() } else { 0 };
    for (count, what) in [(beyond, "beyond the frame"), (pairs.len() - points.len(), "not drawable"), (fewer, "drawn")]
    {
        if count > 0 {
            counts += &format!(", {count} {what}");
        }
    }
    let body = headed(svg, space, title, trend, counts);
    let axis = |name: &str| Axis::new(format!("{name} ({unit})"), low..high, 6);
    let plane = Plane::new(body, axis("expected"), axis("predicted"));
    plane.draw_axes(svg);
    if frame.is_none() {
        return no_data(svg, plane.area);
    }
    let opacity = if points.len() > CROWD { 0.3 } else { 0.5 };
    let place = |point: &DVec2| plane.place(point.x, point.y.clamp(low, high));
    svg.group(BLUE.fill().opacity(opacity), |svg| {
        for point in drawn().filter(|p| (low..=high).contains(&p.y)) {
            svg.circle(place(point), DOT_PX, Default::default());
        }
    });
    for point in drawn().filter(|p| !(low..=high).contains(&p.y)) {
        let up = if point.y > high { DVec2::NEG_Y } else { DVec2::Y };
        arrowhead(svg, place(point) - up * ARROW_PX, up, ARROW_PX, INK);
    }
    lines(svg, &plane, low, high, trend);
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
