//! The legend of a figure, in a strip of its own so that it never covers data.

use glam::DVec2;

use super::style::{INK, TEXT_PX, Text, shortened, text_width_px};
use super::svg::{Area, Svg};

/// Height of one row, px.
const ROW_PX: f64 = 21.0;
/// Width of a mark, px.
const KEY_PX: f64 = 24.0;
const GAP_PX: f64 = 6.0;
const SPACE_PX: f64 = 18.0;

/// Draws a mark about a place.
type DrawMark = Box<dyn Fn(&mut Svg, DVec2)>;

/// One mark and its meaning.
pub struct Entry {
    /// Draws the mark about a place.
    mark: DrawMark,
    /// Its meaning.
    meaning: String,
}

impl Entry {
    /// A mark and its meaning.
    pub fn new(meaning: impl Into<String>, mark: impl Fn(&mut Svg, DVec2) + 'static) -> Self {
        Entry { mark: Box::new(mark), meaning: meaning.into() }
    }

    fn width_px(&self) -> f64 {
        KEY_PX + GAP_PX + text_width_px(&self.meaning, TEXT_PX) + SPACE_PX
    }
}

/// The ends of a line as a mark.
pub fn stroke(at: DVec2) -> [DVec2; 2] {
    [at - DVec2::X * KEY_PX / 2.0, at + DVec2::X * KEY_PX / 2.0]
}

/// Height of a legend for a width, px.
pub fn height_px(entries: &[Entry], width_px: f64) -> f64 {
    rows(entries, width_px).len() as f64 * ROW_PX
}

/// Draws a legend into a strip of [`height_px`], centred.
pub fn draw(svg: &mut Svg, strip: Area, entries: &[Entry]) {
    let words = Text::new(TEXT_PX, INK).from_here();
    for (row, entries) in rows(entries, strip.width).into_iter().enumerate() {
        let used_px = entries.iter().map(Entry::width_px).sum::<f64>() - SPACE_PX;
        let mut left = strip.left + ((strip.width - used_px) / 2.0).max(0.0);
        let y = strip.top + (row as f64 + 0.5) * ROW_PX;
        for entry in entries {
            (entry.mark)(svg, DVec2::new(left + KEY_PX / 2.0, y));
            let from = left + KEY_PX + GAP_PX;
            svg.text(DVec2::new(from, y), &shortened(&entry.meaning, TEXT_PX, strip.right() - from), words);
            left += entry.width_px();
        }
    }
}

/// The entries, row by row.
fn rows(mut entries: &[Entry], width_px: f64) -> Vec<&[Entry]> {
    let mut rows = Vec::new();
    while !entries.is_empty() {
        let mut used_px = -SPACE_PX;
        let fitting = entries.iter().take_while(|entry| {
            used_px += entry.width_px();
            used_px <= width_px
        });
        let (row, rest) = entries.split_at(fitting.count().max(1));
        rows.push(row);
        entries = rest;
    }
    rows
}
