//! The legend of a figure, in a strip of its own so that it never covers data.

use plotters::style::text_anchor::{HPos, VPos};

use super::figure::{Canvas, Drawn};
use super::glyph::Place;
use super::style::{INK, TEXT_PX, px, text, text_width_px};

/// Height of one row, px.
const ROW_PX: f64 = 20.0;
/// Width of a mark, px; lines are drawn [`KEY_PX`] / 2 to both sides of their place.
pub const KEY_PX: f64 = 24.0;
const GAP_PX: f64 = 6.0;
const SPACE_PX: f64 = 20.0;

type Mark<'a> = Box<dyn Fn(&Canvas, Place) -> Drawn + 'a>;

/// One mark and its meaning.
pub struct Entry<'a> {
    /// Draws the mark about a place.
    pub mark: Mark<'a>,
    /// Its meaning.
    pub meaning: String,
}

impl<'a> Entry<'a> {
    /// A mark and its meaning.
    pub fn new(meaning: impl Into<String>, mark: impl Fn(&Canvas, Place) -> Drawn + 'a) -> Self {
        Entry { mark: Box::new(mark), meaning: meaning.into() }
    }

    fn width_px(&self) -> f64 {
        KEY_PX + GAP_PX + text_width_px(&self.meaning, TEXT_PX) + SPACE_PX
    }
}

/// The ends of a line as a mark.
pub fn stroke(at: Place) -> [Place; 2] {
    [(at.0 - px(KEY_PX / 2.0), at.1), (at.0 + px(KEY_PX / 2.0), at.1)]
}

/// Height of a legend for a width, px.
pub fn height_px(entries: &[Entry], width_px: f64) -> u32 {
    (rows(entries, width_px).len() as f64 * ROW_PX) as u32
}

/// Draws a legend into a strip of [`height_px`], centred.
pub fn draw(canvas: &Canvas, entries: &[Entry]) -> Drawn {
    let width_px = f64::from(canvas.dim_in_pixel().0) / f64::from(px(1.0));
    let style = text(TEXT_PX, INK, HPos::Left, VPos::Center);
    for (row, entries) in rows(entries, width_px).into_iter().enumerate() {
        let used_px = entries.iter().map(Entry::width_px).sum::<f64>() - SPACE_PX;
        let mut left_px = ((width_px - used_px) / 2.0).max(0.0);
        let y = px((row as f64 + 0.5) * ROW_PX);
        for entry in entries {
            (entry.mark)(canvas, (px(left_px + KEY_PX / 2.0), y))?;
            canvas.draw_text(&entry.meaning, &style, (px(left_px + KEY_PX + GAP_PX), y))?;
            left_px += entry.width_px();
        }
    }
    Ok(())
}

/// The entries, row by row.
fn rows<'e, 'a>(mut entries: &'e [Entry<'a>], width_px: f64) -> Vec<&'e [Entry<'a>]> {
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
