//! The scale of a quantity that is drawn in colours.

use glam::DVec2;

use super::axis::Axis;
use super::style::{Colour, GREY, INK, SMALL_PX, TEXT_PX, Text};
use super::svg::{Area, Svg};

/// Width of a scale with its numbers, px.
pub const SCALE_PX: f64 = 52.0;
const BAR_PX: f64 = 12.0;
const STEPS: usize = 48;

/// Draws a bar with all colours of the scale left of the right edge of `beside`, as high as it, with the numbers of an axis
/// whose name is set above.
pub fn draw(svg: &mut Svg, beside: Area, axis: &Axis) {
    let left = beside.right() + 14.0;
    let bar = Area { left, width: BAR_PX, ..beside };
    for (step, cell) in bar.cells(STEPS, 1).enumerate() {
        let share = 1.0 - (step as f64 + 0.5) / STEPS as f64;
        // A little overlap with the next cell keeps the ground from shining through the seam.
        let height = (cell.height + 0.5).min(bar.bottom() - cell.top);
        svg.rect(Area { height, ..cell }, Colour::viridis(share).fill());
    }
    for (share, label) in axis.labelled() {
        let at = DVec2::new(bar.right(), bar.bottom() - share * bar.height);
        svg.line(&[at, at + DVec2::X * 3.0], GREY.line(0.75));
        svg.text(at + DVec2::X * 6.0, &label, Text::new(SMALL_PX, GREY).from_here());
    }
    svg.text(DVec2::new(left + SCALE_PX - 14.0, bar.top - 12.0), &axis.name, Text::new(TEXT_PX, INK).to_here());
}
