//! The common style of all drawings: colours, lines, letters.

use std::fmt;

/// A colour as red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub [u8; 3]);

/// Text, walls and frames. The style sheet of the pages replaces this and the next seven colours in the dark.
pub const INK: Colour = Colour([29, 34, 39]);
/// Secondary text and axes.
pub const GREY: Colour = Colour([86, 93, 102]);
/// Grid lines.
pub const FAINT: Colour = Colour([213, 217, 222]);
/// Filled bodies, such as obstacles.
pub const SOLID: Colour = Colour([201, 206, 212]);
/// The ground.
pub const WHITE: Colour = Colour([255, 255, 255]);
/// The first kind of data. Data colours are those of Okabe and Ito, which colour-blind readers can tell apart.
pub const BLUE: Colour = Colour([0, 114, 178]);
/// The second kind of data.
pub const VERMILION: Colour = Colour([213, 94, 0]);
/// The third kind of data, and targets.
pub const GREEN: Colour = Colour([0, 158, 115]);

/// Colours of kinds that have no meaning of their own, repeated where there are more kinds.
pub const KINDS: [Colour; 9] = [
    VERMILION,
    BLUE,
    GREEN,
    Colour([204, 121, 167]),
    Colour([230, 159, 0]),
    Colour([86, 180, 233]),
    Colour([127, 95, 170]),
    Colour([160, 110, 70]),
    Colour([140, 145, 150]),
];

/// Size of titles, px.
pub const TITLE_PX: f64 = 13.5;
/// Size of axis names and legends, px.
pub const TEXT_PX: f64 = 12.0;
/// Size of the numbers on axes, px.
pub const SMALL_PX: f64 = 11.0;
/// Fonts of a figure that stands alone; pages have their own.
pub const FONTS: &str = "Noto Sans, Helvetica, Arial, sans-serif";

/// Mean width of a character, as a share of the font size.
const LETTER_WIDTH: f64 = 0.55;
/// Ten colours of matplotlib's viridis, evenly spaced.
const VIRIDIS: [[u8; 3]; 10] = [
    [68, 1, 84],
    [72, 40, 120],
    [62, 74, 137],
    [49, 104, 142],
    [38, 130, 142],
    [31, 158, 137],
    [53, 183, 121],
    [109, 205, 89],
    [180, 222, 44],
    [253, 231, 37],
];

/// How a shape is filled and outlined. A shape without either takes the style of its group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Style {
    fill: Option<Colour>,
    line: Option<Colour>,
    width_px: f64,
    opacity: Option<f64>,
    dashed: bool,
}

/// How words are set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Text {
    size_px: f64,
    colour: Colour,
    anchor: &'static str,
    bold: bool,
    /// Distance of the baseline below the given place, as a share of the size.
    drop: f64,
    turned: bool,
}

impl Colour {
    /// Filled with this colour.
    pub fn fill(self) -> Style {
        Style { fill: Some(self), ..Style::default() }
    }

    /// An outline of this colour, without filling.
    pub fn line(self, width_px: f64) -> Style {
        Style { line: Some(self), width_px, ..Style::default() }
    }

    /// The colour of a share of the viridis scale; shares beyond 0 to 1 have the colours of its ends.
    pub fn viridis(share: f64) -> Self {
        let at = share.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
        let below = (at as usize).min(VIRIDIS.len() - 2);
        let mixed = |channel: usize| {
            let [low, high] = [below, below + 1].map(|stop| f64::from(VIRIDIS[stop][channel]));
            libm::round(low + (at - below as f64) * (high - low)) as u8
        };
        Colour([mixed(0), mixed(1), mixed(2)])
    }
}

impl Style {
    /// The same with an outline.
    pub fn rimmed(self, colour: Colour, width_px: f64) -> Self {
        Style { line: Some(colour), width_px, ..self }
    }

    /// The same with this opacity, from 0 to 1.
    pub fn opacity(self, opacity: f64) -> Self {
        Style { opacity: Some(opacity), ..self }
    }

    /// The same with a dashed line.
    pub fn dashed(self) -> Self {
        Style { dashed: true, ..self }
    }
}

impl Text {
    /// Words in the middle of a place.
    pub fn new(size_px: f64, colour: Colour) -> Self {
        Text { size_px, colour, anchor: "middle", bold: false, drop: 0.36, turned: false }
    }

    /// The same, beginning at the place.
    pub fn from_here(self) -> Self {
        Text { anchor: "start", ..self }
    }

    /// The same, ending at the place.
    pub fn to_here(self) -> Self {
        Text { anchor: "end", ..self }
    }

    /// The same in bold letters.
    pub fn bold(self) -> Self {
        Text { bold: true, ..self }
    }

    /// The same, read upwards.
    pub fn turned(self) -> Self {
        Text { turned: true, ..self }
    }

    /// Distance of the baseline below the place, px.
    pub fn drop_px(&self) -> f64 {
        self.drop * self.size_px
    }

    /// Whether the words are read upwards.
    pub fn is_turned(&self) -> bool {
        self.turned
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [red, green, blue] = self.0;
        write!(f, "#{red:02X}{green:02X}{blue:02X}")
    }
}

/// As attributes of an SVG element, each after a space.
impl fmt::Display for Style {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match (self.fill, self.line) {
            (Some(colour), _) => write!(f, " fill=\"{colour}\"")?,
            (None, Some(_)) => f.write_str(" fill=\"none\"")?,
            (None, None) => {}
        }
        if let Some(colour) = self.line {
            write!(f, " stroke=\"{colour}\" stroke-width=\"{}\"", self.width_px)?;
        }
        if self.dashed {
            f.write_str(" stroke-dasharray=\"5 3.5\"")?;
        }
        self.opacity.map_or(Ok(()), |opacity| write!(f, " fill-opacity=\"{opacity}\" stroke-opacity=\"{opacity}\""))
    }
}

/// As attributes of an SVG element, each after a space.
impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, " font-size=\"{}\" fill=\"{}\"", self.size_px, self.colour)?;
        if self.anchor != "start" {
            write!(f, " text-anchor=\"{}\"", self.anchor)?;
        }
        if self.bold { f.write_str(" font-weight=\"bold\"") } else { Ok(()) }
    }
}

/// Approximate width of a text, px.
pub fn text_width_px(text: &str, size_px: f64) -> f64 {
    text.chars().count() as f64 * size_px * LETTER_WIDTH
}

/// A text cut to a width, with an ellipsis where something is cut.
pub fn shortened(text: &str, size_px: f64, width_px: f64) -> String {
    let most = (width_px / (size_px * LETTER_WIDTH)) as usize;
    if text.chars().count() <= most {
        return text.into();
    }
    text.chars().take(most.saturating_sub(1)).chain(['…']).collect()
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
    use super::*;

    #[test]
    fn numbers_have_a_true_minus_and_no_minus_zero() {
        assert_eq!(number(-1.25, 1), "−1.2");
        assert_eq!(number(-0.001, 2), "0.00");
        assert_eq!(number(12.0, 0), "12");
    }

    #[test]
    fn colours_of_a_scale_run_from_dark_to_bright() {
        let ends = [-1.0, 0.0, 0.5, 1.0, 2.0].map(|share| Colour::viridis(share).to_string());
        assert_eq!(ends, ["#440154", "#440154", "#23908C", "#FDE725", "#FDE725"]);
    }

    #[test]
    fn long_names_are_cut_to_their_place() {
        assert_eq!(shortened("weaker motor", 10.0, 100.0), "weaker motor");
        assert_eq!(shortened("weaker motor", 10.0, 40.0), "weaker…");
    }
}
