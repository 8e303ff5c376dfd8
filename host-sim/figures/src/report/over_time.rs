//! Axes over the time of a run, in which a script draws what belongs to the run that is chosen.

use glam::DVec2;

use super::axis::{Axis, is_range};
use super::chart::{ABOVE_PX, BELOW_PX, Plane, no_data};
use super::figure::Figure;

const PLOT_PX: f64 = 120.0;

/// Draws axes from zero to the longest time and the largest value, and leaves the plane between them to a script, in seconds and
/// units of the value; values are negative there, for `y` points downwards.
pub fn over_time(most_s: f64, name: &str, most: f64) -> Figure {
    Figure::chart("", ABOVE_PX + PLOT_PX + BELOW_PX, &[], |svg, space| {
        if !is_range(&(0.0..most_s)) || !is_range(&(0.0..most)) {
            return no_data(svg, space);
        }
        let (x, y) = (Axis::new("time (s)", 0.0..most_s, 6), Axis::rounded(name, 0.0..most, 3));
        let high = y.range.end;
        let plane = Plane::new(space, x, y);
        plane.draw_axes(svg);
        svg.left_to_script(plane.area, DVec2::new(0.0, -high), DVec2::new(most_s, 0.0));
    })
}
