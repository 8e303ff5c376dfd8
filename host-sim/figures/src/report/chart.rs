//! A plane with two named axes.

use std::ops::Range;

use glam::DVec2;
use plotters::chart::ChartBuilder;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::drawing::DrawingArea;
use plotters::prelude::SVGBackend;
use plotters::style::text_anchor::{HPos, VPos};
use plotters::style::{Color, TRANSPARENT};

use super::figure::{Canvas, Drawn};
use super::glyph::Place;
use super::style::{self, FAINT, GREY, INK, SMALL_PX, TEXT_PX, line, number, px, text};

/// Room left of a chart for the numbers and the name of its axis, px.
pub const LEFT_PX: f64 = 50.0;
/// Room below a chart for the numbers and the name of its axis, px.
pub const BELOW_PX: f64 = 40.0;

/// Values of larger magnitude count as not drawable: an axis could not show them beside anything else.
const BOUND: f64 = 1e9;
/// Least span of an axis relative to the magnitude of its values.
const LEAST_SPAN: f64 = 1e-6;

const TITLE_ROW_PX: f64 = 18.0;
const NOTE_ROW_PX: f64 = 14.0;

/// A plane in data coordinates.
pub struct Chart<'a> {
    /// The part of the canvas between the axes.
    pub canvas: Canvas<'a>,
    plane: DrawingArea<SVGBackend<'a>, Cartesian2d<Axis, Axis>>,
}

/// Label, range and ticks of an axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity and unit.
    pub name: String,
    /// From its start to its end; [`is_range`] holds.
    pub range: Range<f64>,
    /// Positions of the ticks.
    pub ticks: Ticks,
}

/// Round numbers along an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// Values of the ticks, rising.
    pub at: Vec<f64>,
    /// Number of decimals of the labels.
    pub decimals: usize,
}

/// Whether a point can stand in a chart.
pub fn is_drawable(point: DVec2) -> bool {
    point.abs().cmple(DVec2::splat(BOUND)).all()
}

/// Whether a range is wide enough for an axis.
pub fn is_range(range: &Range<f64>) -> bool {
    let ends = DVec2::new(range.start, range.end);
    is_drawable(ends) && range.end - range.start > LEAST_SPAN * (1.0 + ends.abs().max_element())
}

/// Position of a value in a range: 0 at its start, 1 at its end.
pub fn share(range: &Range<f64>, value: f64) -> f64 {
    (value - range.start) / (range.end - range.start)
}

impl Axis {
    /// An axis with at most about `most` ticks.
    pub fn new(name: impl Into<String>, range: Range<f64>, most: usize) -> Self {
        let ticks = Ticks::in_range(&range, most);
        Axis { name: name.into(), range, ticks }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + libm::round(share(&self.range, *value) * f64::from(to - from)) as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.at.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.ticks.label(*value)
    }
}

impl Ticks {
    /// Multiples of 1, 2 or 5 times a power of ten within a range, at most `most` + 1 of them.
    pub fn in_range(range: &Range<f64>, most: usize) -> Self {
        let finest = (range.end - range.start) / most as f64;
        let exponent = libm::floor(libm::log10(finest));
        let power = libm::exp10(exponent);
        let (step, exponent) = [(1.0, 0.0), (2.0, 0.0), (5.0, 0.0), (10.0, 1.0)]
            .into_iter()
            .map(|(digit, carry)| (digit * power, exponent + carry))
            .find(|(step, _)| *step >= finest)
            .unwrap_or((finest, exponent));
        let (first, last) = (libm::ceil(range.start / step - 1e-9), libm::floor(range.end / step + 1e-9));
        let at = (0..=(last - first) as usize).map(|i| (first + i as f64) * step).collect();
        Ticks { at, decimals: (-exponent).max(0.0) as usize }
    }

    /// Label of a tick.
    pub fn label(&self, value: f64) -> String {
        number(value, self.decimals)
    }
}

/// Draws axes and a grid that fill a canvas, with margins of [`LEFT_PX`] and [`BELOW_PX`] for their labels.
pub fn chart<'a>(canvas: &Canvas<'a>, x: &Axis, y: &Axis) -> Drawn<Chart<'a>> {
    let mut chart = ChartBuilder::on(canvas)
        .y_label_area_size(px(LEFT_PX))
        .x_label_area_size(px(BELOW_PX))
        .build_cartesian_2d(x.clone(), y.clone())?;
    chart
        .configure_mesh()
        .x_labels(x.ticks.at.len())
        .y_labels(y.ticks.at.len())
        .x_desc(x.name.as_str())
        .y_desc(y.name.as_str())
        .label_style(text(SMALL_PX, INK, HPos::Center, VPos::Center))
        .axis_desc_style(text(TEXT_PX, INK, HPos::Center, VPos::Center))
        .axis_style(line(GREY, 0.75))
        .bold_line_style(line(FAINT, 0.5))
        .light_line_style(TRANSPARENT.to_rgba())
        .set_all_tick_mark_size(px(3.0))
        .draw()?;
    let plane = chart.plotting_area().clone();
    Ok(Chart { canvas: plane.strip_coord_spec(), plane })
}

impl Chart<'_> {
    /// Position of finite coordinates on [`Chart::canvas`].
    pub fn place(&self, x: f64, y: f64) -> Place {
        let (place, base) = (self.plane.map_coordinate(&(x, y)), self.plane.get_base_pixel());
        (place.0 - base.0, place.1 - base.1)
    }
}

/// Draws a panel's title and notes and returns the canvas below them.
pub fn headed<'a>(cell: &Canvas<'a>, title: &str, notes: &[String]) -> Drawn<Canvas<'a>> {
    cell.draw_text(title, &style::title(), (0, 0))?;
    for (row, note) in notes.iter().enumerate() {
        let place = (0, px(TITLE_ROW_PX + row as f64 * NOTE_ROW_PX));
        cell.draw_text(note, &text(SMALL_PX, GREY, HPos::Left, VPos::Top), place)?;
    }
    Ok(cell.split_vertically(px(heading_px(notes.len()))).1)
}

/// Height of a heading with this number of notes, px.
pub fn heading_px(notes: usize) -> f64 {
    TITLE_ROW_PX + notes as f64 * NOTE_ROW_PX + 6.0
}

/// Draws "no data" in the middle of a canvas.
pub fn no_data(canvas: &Canvas) -> Drawn {
    let (width, height) = canvas.dim_in_pixel();
    let middle = (width as i32 / 2, height as i32 / 2);
    canvas.draw_text("no data", &text(TEXT_PX, GREY, HPos::Center, VPos::Center), middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(Ticks::in_range(&(0.0..300.0), 6).at, [0.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0]);
        let ticks = Ticks::in_range(&(-0.31..0.33), 5);
        assert_eq!(ticks.at.iter().map(|t| ticks.label(*t)).collect::<Vec<_>>(), ["−0.2", "0.0", "0.2"]);
    }

    proptest! {
        #[test]
        fn every_range_has_a_few_ticks_inside(start in -1e5..1e5, exponent in -3.0..5.0, most in 3_usize..9) {
            let range = start..start + libm::exp10(exponent);
            let ticks = Ticks::in_range(&range, most);
            let slack = (range.end - range.start) * 1e-6;
            prop_assert!((1..=most + 1).contains(&ticks.at.len()), "{ticks:?}");
            prop_assert!(ticks.at.iter().all(|t| *t >= range.start - slack && *t <= range.end + slack));
            let mut labels: Vec<String> = ticks.at.iter().map(|t| ticks.label(*t)).collect();
            labels.dedup();
            prop_assert_eq!(labels.len(), ticks.at.len());
        }
    }
}
