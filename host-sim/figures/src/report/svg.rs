//! Writes SVG: shapes and words on an area, all lengths in px, right and down.

use std::fmt;

use glam::DVec2;

use super::style::{Style, Text};

/// The elements of a drawing, in the order in which they cover each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Svg {
    /// The elements as text.
    pub elements: String,
}

/// A rectangle of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// A coordinate: a tenth of a px is as fine as a screen or a printer shows.
struct Tenths(f64);

impl fmt::Display for Tenths {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // Adding zero turns minus zero into zero.
        write!(f, "{}", libm::round(10.0 * self.0) / 10.0 + 0.0)
    }
}

impl Svg {
    /// Draws a rectangle.
    pub fn rect(&mut self, area: Area, style: Style) {
        let [x, y, width, height] = [area.left, area.top, area.width, area.height].map(Tenths);
        self.elements += &format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{style}/>\n");
    }

    /// Draws a circle.
    pub fn circle(&mut self, at: DVec2, radius_px: f64, style: Style) {
        let [x, y, radius] = [at.x, at.y, radius_px].map(Tenths);
        self.elements += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{style}/>\n");
    }

    /// Draws a line through points.
    pub fn line(&mut self, points: &[DVec2], style: Style) {
        self.elements += &format!("<polyline points=\"{}\"{style}/>\n", listed(points));
    }

    /// Draws a closed shape.
    pub fn polygon(&mut self, points: &[DVec2], style: Style) {
        self.elements += &format!("<polygon points=\"{}\"{style}/>\n", listed(points));
    }

    /// Writes words.
    pub fn text(&mut self, at: DVec2, words: &str, text: Text) {
        let turn = if text.is_turned() {
            format!(" transform=\"rotate(-90 {} {})\"", Tenths(at.x), Tenths(at.y))
        } else {
            String::new()
        };
        let (x, y) = (Tenths(at.x), Tenths(at.y + text.drop_px()));
        self.elements += &format!("<text x=\"{x}\" y=\"{y}\"{text}{turn}>{}</text>\n", escaped(words));
    }

    /// Draws what shares a style.
    pub fn group(&mut self, style: Style, draw: impl FnOnce(&mut Svg)) {
        self.enclosed(&format!("<g{style}>"), "</g>", draw);
    }

    /// Draws what shows a text under the pointer.
    pub fn titled(&mut self, title: &str, draw: impl FnOnce(&mut Svg)) {
        self.enclosed(&format!("<g><title>{}</title>", escaped(title)), "</g>", draw);
    }

    /// Draws what is cut off at the edges of an area.
    pub fn clipped(&mut self, area: Area, draw: impl FnOnce(&mut Svg)) {
        let [x, y, width, height] = [area.left, area.top, area.width, area.height].map(Tenths);
        let place = format!("x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"");
        self.enclosed(&format!("<svg {place} viewBox=\"{x} {y} {width} {height}\">"), "</svg>", draw);
    }

    /// Leaves an area to a script, which draws in it from `low` to `high` in units of the data, `y` downwards.
    pub fn left_to_script(&mut self, area: Area, low: DVec2, high: DVec2) {
        let [x, y, width, height] = [area.left, area.top, area.width, area.height].map(Tenths);
        let span = high - low;
        self.elements += &format!(
            "<svg class=\"plane\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{} {} {} {}\" preserveAspectRatio=\"none\"></svg>\n",
            low.x, low.y, span.x, span.y
        );
    }

    fn enclosed(&mut self, opening: &str, closing: &str, draw: impl FnOnce(&mut Svg)) {
        self.elements += opening;
        self.elements += "\n";
        draw(self);
        self.elements += closing;
        self.elements += "\n";
    }
}

impl Area {
    /// Right edge.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Lower edge.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// The point in its middle.
    pub fn middle(&self) -> DVec2 {
        DVec2::new(self.left + self.width / 2.0, self.top + self.height / 2.0)
    }

    /// Without margins: left, above, right, below.
    pub fn without(self, [left, above, right, below]: [f64; 4]) -> Self {
        Area {
            left: self.left + left,
            top: self.top + above,
            width: self.width - left - right,
            height: self.height - above - below,
        }
    }

    /// What is above a height, and what is below it.
    pub fn split_down(self, height: f64) -> (Self, Self) {
        (Area { height, ..self }, self.without([0.0, height, 0.0, 0.0]))
    }

    /// What is left of a width, and what is right of it.
    pub fn split_across(self, width: f64) -> (Self, Self) {
        (Area { width, ..self }, self.without([width, 0.0, 0.0, 0.0]))
    }

    /// Equal cells, row by row.
    pub fn cells(self, rows: usize, columns: usize) -> impl Iterator<Item = Self> {
        let (width, height) = (self.width / columns as f64, self.height / rows as f64);
        (0..rows * columns).map(move |i| {
            let (row, column) = ((i / columns) as f64, (i % columns) as f64);
            Area { left: self.left + column * width, top: self.top + row * height, width, height }
        })
    }
}

fn listed(points: &[DVec2]) -> String {
    points.iter().map(|p| format!("{},{}", Tenths(p.x), Tenths(p.y))).collect::<Vec<String>>().join(" ")
}

/// Words as XML has them; XML has no control characters, so they become replacement characters.
fn escaped(words: &str) -> String {
    let plain = words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    plain.replace(|c: char| c.is_control() || c == '\u{FFFE}' || c == '\u{FFFF}', "\u{FFFD}")
}

#[cfg(test)]
mod tests {
    use super::super::style::{BLUE, INK};
    use super::*;

    #[test]
    fn shapes_are_written_with_tenths_of_a_pixel() {
        let mut svg = Svg::default();
        svg.circle(DVec2::new(-0.04, 12.26), 1.5, BLUE.fill().opacity(0.5));
        svg.line(&[DVec2::ZERO, DVec2::new(3.0, 1.0 / 3.0)], INK.line(1.25).dashed());
        assert_eq!(
            svg.elements,
            "<circle cx=\"0\" cy=\"12.3\" r=\"1.5\" fill=\"#0072B2\" fill-opacity=\"0.5\" stroke-opacity=\"0.5\"/>\n\
             <polyline points=\"0,0 3,0.3\" fill=\"none\" stroke=\"#1D2227\" stroke-width=\"1.25\" stroke-dasharray=\"5 3.5\"/>\n"
        );
    }

    #[test]
    fn words_stay_words() {
        let mut svg = Svg::default();
        svg.text(DVec2::ZERO, "</text><a>&\u{1}", Text::new(10.0, INK));
        assert!(svg.elements.contains(">&lt;/text&gt;&lt;a&gt;&amp;\u{FFFD}</text>"), "{}", svg.elements);
    }
}
