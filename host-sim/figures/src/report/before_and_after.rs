//! A quantity before and after, one per row below its name.

use glam::DVec2;

use super::axis::{Axis, is_range, span};
use super::chart::{BELOW_PX, Plane, no_data};
use super::figure::Figure;
use super::glyph::mark;
use super::legend::Entry;
use super::style::{BLUE, GREY, INK, TEXT_PX, Text, VERMILION, number, shortened};

const ROW_PX: f64 = 40.0;
/// Room left of the rows for half of the axis' first number.
const LEFT_PX: f64 = 12.0;

/// Quantities before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct BeforeAndAfter {
    /// Quantity and unit.
    pub axis: String,
    /// Names of before and after.
    pub kinds: [String; 2],
    /// Name, value before and value after, from the top.
    pub rows: Vec<(String, [f64; 2])>,
}

impl BeforeAndAfter {
    /// Draws the rows, with zero on the axis.
    pub fn draw(&self) -> Figure {
        let colours = [BLUE, VERMILION];
        let entry =
            |kind: usize| Entry::new(self.kinds[kind].clone(), move |svg, at| mark(svg, at, kind, colours[kind]));
        let body_px = self.rows.len().max(1) as f64 * ROW_PX + BELOW_PX;
        Figure::chart("", body_px, &[entry(0), entry(1)], |svg, space| {
            let range = span(self.rows.iter().flat_map(|(_, [before, after])| [0.0, *before, *after]));
            if !is_range(&range) {
                return no_data(svg, space);
            }
            let axis = Axis::rounded(self.axis.as_str(), range, 5);
            let start = axis.range.start;
            let plane = Plane::of_rows(space, axis, self.rows.len(), LEFT_PX);
            plane.draw_axes(svg);
            for (row, (name, values)) in self.rows.iter().enumerate() {
                let label = shortened(name, TEXT_PX, plane.area.width);
                let at = plane.place(start, row as f64) + DVec2::new(4.0, 12.0);
                svg.text(at, &label, Text::new(TEXT_PX, INK).from_here());
                let ends = values.map(|value| plane.place(value, row as f64) + DVec2::Y * (ROW_PX - 12.0));
                svg.line(&ends, GREY.line(2.0));
                for (kind, (value, end)) in values.iter().zip(ends).enumerate() {
                    let title = format!("{name} {}: {}", self.kinds[kind], number(*value, 3));
                    svg.titled(&title, |svg| mark(svg, end, kind, colours[kind]));
                }
            }
        })
    }
}
