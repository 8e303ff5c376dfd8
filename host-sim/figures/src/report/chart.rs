//! A plane with two named axes, and what stands above and in place of it.

use glam::DVec2;

use super::axis::{Axis, share};
use super::style::{FAINT, GREY, INK, SMALL_PX, TEXT_PX, TITLE_PX, Text};
use super::svg::{Area, Svg};

/// Room left of a plane for the numbers of its axis, px.
pub const LEFT_PX: f64 = 44.0;
/// Room above a plane for the name of its upright axis, px.
pub const ABOVE_PX: f64 = 20.0;
/// Room right of a plane for half a number, px.
pub const RIGHT_PX: f64 = 14.0;
/// Room below a plane for the numbers and the name of its axis, px.
pub const BELOW_PX: f64 = 42.0;

const TITLE_ROW_PX: f64 = 19.0;
const NOTE_ROW_PX: f64 = 15.0;
const TICK_PX: f64 = 4.0;

/// A plane in data coordinates.
#[derive(Clone, Debug)]
pub struct Plane {
    /// The part of the drawing between the axes.
    pub area: Area,
    x: Axis,
    y: Axis,
}

impl Plane {
    /// A plane in a space, with room around it for the labels of both axes.
    pub fn new(space: Area, x: Axis, y: Axis) -> Self {
        Plane { area: space.without([LEFT_PX, ABOVE_PX, RIGHT_PX, BELOW_PX]), x, y }
    }

    /// A plane of rows below each other, with room for their names on the left.
    pub fn of_rows(space: Area, x: Axis, rows: usize, names_px: f64) -> Self {
        Plane { area: space.without([names_px, 0.0, RIGHT_PX, BELOW_PX]), x, y: Axis::of_rows(rows) }
    }

    /// Place of finite coordinates.
    pub fn place(&self, x: f64, y: f64) -> DVec2 {
        let (across, up) = (share(&self.x.range, x), share(&self.y.range, y));
        DVec2::new(self.area.left + across * self.area.width, self.area.bottom() - up * self.area.height)
    }

    /// The rectangle between two corners.
    pub fn between(&self, low: DVec2, high: DVec2) -> Area {
        let (a, b) = (self.place(low.x, low.y), self.place(high.x, high.y));
        let (from, to) = (a.min(b), a.max(b));
        Area { left: from.x, top: from.y, width: to.x - from.x, height: to.y - from.y }
    }

    /// Draws the grid, and the axes with their numbers and names.
    pub fn draw_axes(&self, svg: &mut Svg) {
        let area = self.area;
        let (left, right, top, bottom) = (area.left, area.right(), area.top, area.bottom());
        let (x_ticks, y_ticks): (Vec<_>, Vec<_>) = (self.x.labelled().collect(), self.y.labelled().collect());
        let across = |share: f64| left + share * area.width;
        let up = |share: f64| bottom - share * area.height;
        svg.group(FAINT.line(0.75), |svg| {
            for (share, _) in &x_ticks {
                svg.line(&[DVec2::new(across(*share), top), DVec2::new(across(*share), bottom)], Default::default());
            }
            for (share, _) in &y_ticks {
                svg.line(&[DVec2::new(left, up(*share)), DVec2::new(right, up(*share))], Default::default());
            }
        });
        svg.group(GREY.line(0.75), |svg| {
            svg.line(&[DVec2::new(left, top), DVec2::new(left, bottom), DVec2::new(right, bottom)], Default::default());
            for (share, _) in &x_ticks {
                let at = DVec2::new(across(*share), bottom);
                svg.line(&[at, at + DVec2::Y * TICK_PX], Default::default());
            }
            for (share, _) in &y_ticks {
                let at = DVec2::new(left, up(*share));
                svg.line(&[at, at - DVec2::X * TICK_PX], Default::default());
            }
        });
        let small = Text::new(SMALL_PX, GREY);
        for (share, label) in &x_ticks {
            svg.text(DVec2::new(across(*share), bottom + 13.0), label, small);
        }
        for (share, label) in &y_ticks {
            svg.text(DVec2::new(left - 7.0, up(*share)), label, small.to_here());
        }
        let words = Text::new(TEXT_PX, INK);
        if !self.x.name.is_empty() {
            svg.text(DVec2::new(area.middle().x, bottom + 31.0), &self.x.name, words);
        }
        if !self.y.name.is_empty() {
            svg.text(DVec2::new(left - LEFT_PX, top - 12.0), &self.y.name, words.from_here());
        }
    }
}

/// Draws a title, which may be empty, and notes, and returns the space below them.
pub fn heading(svg: &mut Svg, space: Area, title: &str, notes: &[String]) -> Area {
    if !title.is_empty() {
        let words = Text::new(TITLE_PX, INK).from_here().bold();
        svg.text(DVec2::new(space.left, space.top + TITLE_ROW_PX / 2.0), title, words);
    }
    let rows = heading_px(title, 0);
    for (row, note) in notes.iter().enumerate() {
        let at = DVec2::new(space.left, space.top + rows + (row as f64 + 0.4) * NOTE_ROW_PX);
        svg.text(at, note, Text::new(SMALL_PX, GREY).from_here());
    }
    space.split_down(heading_px(title, notes.len())).1
}

/// Height of a heading with a title, which may be empty, and this number of notes, px.
pub fn heading_px(title: &str, notes: usize) -> f64 {
    let title_px = if title.is_empty() { 0.0 } else { TITLE_ROW_PX + 4.0 };
    let notes_px = if notes == 0 { 0.0 } else { notes as f64 * NOTE_ROW_PX + 4.0 };
    title_px + notes_px
}

/// Draws "no data" in the middle of a space.
pub fn no_data(svg: &mut Svg, space: Area) {
    svg.text(space.middle(), "no data", Text::new(TEXT_PX, GREY));
}
