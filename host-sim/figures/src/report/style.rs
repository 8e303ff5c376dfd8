//! The common style of all figures: lengths, colours, lines and fonts.

use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, IntoFont, RGBColor, ShapeStyle, TextStyle};

/// Canvas units in one pixel of the SVG. The canvas has integer coordinates only; quarters of a pixel keep lines smooth.
pub const UNIT: u32 = 4;

/// Text and frames.
pub const INK: RGBColor = RGBColor(38, 38, 38);
/// Secondary text, axes.
pub const GREY: RGBColor = RGBColor(110, 110, 110);
/// Lines of a grid.
pub const FAINT: RGBColor = RGBColor(228, 228, 228);
/// Filled bodies, such as obstacles.
pub const SOLID: RGBColor = RGBColor(205, 205, 205);
/// The first of two kinds of data. The colours are those of Okabe and Ito, which colour-blind readers distinguish.
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
/// The second kind of data.
pub const VERMILION: RGBColor = RGBColor(213, 94, 0);
/// Targets.
pub const GREEN: RGBColor = RGBColor(0, 158, 115);

/// Size of titles, px.
pub const TITLE_PX: f64 = 12.5;
/// Size of axis names and legends, px.
pub const TEXT_PX: f64 = 11.0;
/// Size of the numbers on axes, px.
pub const SMALL_PX: f64 = 10.0;

const FONTS: &str = "Noto Sans, Helvetica, Arial, sans-serif";
/// The SVG backend divides every font size by this.
const FONT_SIZE_DIVISOR: f64 = 1.24;
/// Mean width of a character, as a share of the font size.
const LETTER_WIDTH: f64 = 0.55;

/// A length in canvas units.
pub fn px(length_px: f64) -> i32 {
    libm::round(length_px * f64::from(UNIT)) as i32
}

/// An outline.
pub fn line(colour: impl Color, width_px: f64) -> ShapeStyle {
    ShapeStyle { color: colour.to_rgba(), filled: false, stroke_width: px(width_px).unsigned_abs() }
}

/// A text style of this size; `across` and `down` define the anchor of the text.
pub fn text(size_px: f64, colour: RGBColor, across: HPos, down: VPos) -> TextStyle<'static> {
    let font = (FONTS, size_px * f64::from(UNIT) * FONT_SIZE_DIVISOR).into_font();
    font.color(&colour).pos(Pos::new(across, down))
}

/// The letters of a panel's title, placed by their upper left corner.
pub fn title() -> TextStyle<'static> {
    let font = (FONTS, TITLE_PX * f64::from(UNIT) * FONT_SIZE_DIVISOR).into_font().style(FontStyle::Bold);
    font.color(&INK).pos(Pos::new(HPos::Left, VPos::Top))
}

/// Approximate width of a text, px.
pub fn text_width_px(text: &str, size_px: f64) -> f64 {
    text.chars().count() as f64 * size_px * LETTER_WIDTH
}

/// A number with a fixed number of decimals, a true minus sign, and no minus zero.
pub fn number(value: f64, decimals: usize) -> String {
    let plain = format!("{value:.decimals$}");
    match plain.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| c == '0' || c == '.') => zero.to_owned(),
        Some(size) => format!("−{size}"),
        None => plain,
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_have_a_true_minus_and_no_minus_zero() {
        assert_eq!(number(-1.25, 1), "−1.2");
        assert_eq!(number(-0.001, 2), "0.00");
        assert_eq!(number(12.0, 0), "12");
    }
}
