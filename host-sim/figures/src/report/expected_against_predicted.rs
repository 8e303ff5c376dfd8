//! Figure 2 of the paper: held-out samples against predictions of the networks.

mod reliability;
mod scatter;

use glam::DVec2;
use plotters::style::Color;

use super::chart::{BELOW_PX, Chart, LEFT_PX, headed, heading_px, no_data};
use super::figure::{Canvas, Drawn, Figure};
use super::glyph::{arrowhead, dot, solid_line};
use super::legend::{self, Entry};
use super::style::{BLUE, GREY, INK, VERMILION, line, number, px};
use super::trend::Trend;

const PLOT_PX: f64 = 236.0;
const RIGHT_PX: f64 = 22.0;
const MARGIN_PX: f64 = 14.0;
const NOTES: usize = 2;
const PANELS_A_ROW: usize = 3;

/// One network's held-out samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The network's name.
    pub title: String,
    /// Expected and predicted values.
    pub samples: Samples,
}

/// Expected and predicted values of a network.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Quantities.
    Values {
        /// Common unit.
        unit: String,
        /// One sample each: `x` expected, `y` predicted.
        pairs: Vec<DVec2>,
    },
    /// Events: predicted probability, and whether it happened. Drawn as a reliability diagram.
    Events(Vec<(f64, bool)>),
}

/// Draws a panel for every network. Values that are not finite, or beyond all scales, are left out and counted under the
/// title.
pub fn expected_against_predicted(panels: &[Panel]) -> Figure {
    let columns = panels.len().clamp(1, PANELS_A_ROW);
    let rows = panels.len().div_ceil(columns).max(1);
    let (cell_px, row_px) = (LEFT_PX + PLOT_PX + RIGHT_PX, heading_px(NOTES) + PLOT_PX + BELOW_PX + MARGIN_PX);
    let inner_px = cell_px * columns as f64;
    let entries = legend(panels);
    let legend_px = f64::from(legend::height_px(&entries, inner_px));
    let (width_px, height_px) = (inner_px + 2.0 * MARGIN_PX, rows as f64 * row_px + legend_px + 2.0 * MARGIN_PX);
    Figure::draw(width_px as u32, height_px as u32, |canvas| {
        let inner = canvas.margin(px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX));
        let (grid, strip) = inner.split_vertically(px(rows as f64 * row_px));
        for (cell, panel) in grid.split_evenly((rows, columns)).iter().zip(panels) {
            let cell = cell.margin(0, px(MARGIN_PX), 0, px(RIGHT_PX));
            match &panel.samples {
                Samples::Values { unit, pairs } => scatter::draw(&cell, &panel.title, unit, pairs)?,
                Samples::Events(events) => reliability::draw(&cell, &panel.title, events)?,
            }
        }
        if panels.is_empty() {
            no_data(&grid)?;
        }
        legend::draw(&strip, &entries)
    })
}

fn legend(panels: &[Panel]) -> Vec<Entry<'static>> {
    if panels.is_empty() {
        return Vec::new();
    }
    let has = |events: bool| panels.iter().any(|p| matches!(p.samples, Samples::Events(_)) == events);
    let mut entries = vec![
        Entry::new("perfect prediction", |canvas, at| solid_line(canvas, &legend::stroke(at), line(GREY, 0.75))),
        Entry::new("trend", |canvas, at| solid_line(canvas, &legend::stroke(at), line(VERMILION, 1.5))),
    ];
    if has(false) {
        entries.push(Entry::new("held-out sample", |canvas, at| dot(canvas, at, 2.0, BLUE.mix(0.7))));
        entries.push(Entry::new("beyond the frame", |canvas, at| arrowhead(canvas, at, DVec2::Y, 7.0, INK)));
    }
    if has(true) {
        entries.push(Entry::new("share of a bin, 95 % interval, n below", reliability::mark));
    }
    entries
}

/// A title with the trend beneath it.
fn heading<'a>(cell: &Canvas<'a>, title: &str, trend: Option<Trend>, counts: String) -> Drawn<Canvas<'a>> {
    let fit = trend.map_or_else(String::new, |t| {
        let [slope, intercept, r2] = [t.slope, t.intercept, t.r2].map(|v| number(v, 3));
        format!("slope {slope}, intercept {intercept}, R² {r2}")
    });
    headed(cell, title, &[fit, counts])
}

/// The diagonal, and the trend as far as it lies in the frame `low..=high` of both axes.
fn lines(chart: &Chart, low: f64, high: f64, trend: Option<Trend>) -> Drawn {
    solid_line(&chart.canvas, &[chart.place(low, low), chart.place(high, high)], line(GREY, 0.75))?;
    let Some(trend) = trend else { return Ok(()) };
    let reach = [low, high].map(|y| (y - trend.intercept) / trend.slope);
    let (from, to) = if trend.slope == 0.0 {
        (low, high)
    } else {
        (low.max(reach[0].min(reach[1])), high.min(reach[0].max(reach[1])))
    };
    if from < to && (trend.slope != 0.0 || (low..=high).contains(&trend.intercept)) {
        let ends = [from, to].map(|x| chart.place(x, trend.at(x).clamp(low, high)));
        solid_line(&chart.canvas, &ends, line(VERMILION, 1.5))?;
    }
    Ok(())
}
