//! Rows of segments: what makes up each row, one colour per kind.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec2;

use super::axis::{Axis, is_range};
use super::chart::{BELOW_PX, Plane, no_data};
use super::figure::Figure;
use super::legend::Entry;
use super::style::{Colour, INK, SMALL_PX, Text, WHITE};
use super::svg::Area;

/// Rows lower than this have no names, px.
const LEAST_NAMED_PX: f64 = 12.0;
/// Height that all rows share at most, px.
const MOST_PX: f64 = 480.0;

/// Rows of segments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SegmentChart {
    /// Quantity and unit along the rows.
    pub axis: String,
    /// Its values.
    pub range: Range<f64>,
    /// Width of the names, px.
    pub names_px: f64,
    /// Height of a row where there are few, px.
    pub row_px: f64,
    /// Name and colour of each kind; those that are in a row are in the legend.
    pub kinds: Vec<(String, Colour)>,
    /// From the top.
    pub rows: Vec<Row>,
}

/// Name and segments of a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Its segments.
    pub segments: Vec<Segment>,
}

/// A part of a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Where it begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Which of the kinds it is.
    pub kind: usize,
    /// What is read under the pointer.
    pub title: String,
}

impl SegmentChart {
    /// Draws the rows.
    pub fn draw(&self) -> Figure {
        let row_px = self.row_px.min(MOST_PX / self.rows.len().max(1) as f64);
        let shown: BTreeMap<usize, &(String, Colour)> = self
            .rows
            .iter()
            .flat_map(|row| &row.segments)
            .filter_map(|segment| Some((segment.kind, self.kinds.get(segment.kind)?)))
            .collect();
        let key = |(name, colour): &(String, Colour)| {
            let colour = *colour;
            Entry::new(name.clone(), move |svg, at| {
                svg.rect(Area { left: at.x - 7.0, top: at.y - 6.0, width: 14.0, height: 12.0 }, colour.fill());
            })
        };
        let entries: Vec<Entry> = shown.values().map(|kind| key(kind)).collect();
        Figure::chart("", self.rows.len().max(1) as f64 * row_px + BELOW_PX, &entries, |svg, space| {
            if self.rows.is_empty() || !is_range(&self.range) {
                return no_data(svg, space);
            }
            let axis = Axis::new(self.axis.as_str(), self.range.clone(), 6);
            let plane = Plane::of_rows(space, axis, self.rows.len(), self.names_px);
            plane.draw_axes(svg);
            let gap = if row_px < LEAST_NAMED_PX { 0.0 } else { 0.12 };
            for (number, row) in self.rows.iter().enumerate() {
                let (top, bottom) = (number as f64 + gap, (number + 1) as f64 - gap);
                for Segment { from, to, kind, title } in &row.segments {
                    let Some((_, colour)) = shown.get(kind) else { continue };
                    let area = plane.between(DVec2::new(*from, top), DVec2::new(*to, bottom));
                    let style = if gap > 0.0 { colour.fill().rimmed(WHITE, 0.5) } else { colour.fill() };
                    svg.titled(title, |svg| svg.rect(area, style));
                }
                if row_px >= LEAST_NAMED_PX {
                    let at = plane.place(self.range.start, number as f64 + 0.5) - DVec2::X * 7.0;
                    svg.text(at, &row.name, Text::new(SMALL_PX, INK).to_here());
                }
            }
        })
    }
}
