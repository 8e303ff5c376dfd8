//! Figure 2 of the paper: held-out samples against predictions of the networks.

mod reliability;
mod scatter;

use glam::DVec2;

use super::chart::{ABOVE_PX, BELOW_PX, LEFT_PX, Plane, RIGHT_PX, heading, heading_px, no_data};
use super::figure::{CHART_PX, Figure, MARGIN_PX};
use super::glyph::arrowhead;
use super::legend::{self, Entry};
use super::style::{BLUE, GREY, INK, VERMILION, number};
use super::svg::{Area, Svg};
use super::trend::Trend;

/// Side of a plot in the figure of all networks, px.
const PLOT_PX: f64 = 236.0;
const GAP_PX: f64 = 14.0;
const NOTES: usize = 2;
const PANELS_PER_ROW: usize = 3;

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
    let columns = panels.len().clamp(1, PANELS_PER_ROW);
    let rows = panels.len().div_ceil(columns).max(1);
    let size = panel_px(PLOT_PX) + GAP_PX;
    let (width_px, height_px) = (size.x * columns as f64, size.y * rows as f64);
    Figure::draw(width_px, height_px, &legend(panels), |svg, space| {
        if panels.is_empty() {
            no_data(svg, space);
        }
        for (cell, panel) in space.cells(rows, columns).zip(panels) {
            draw(svg, cell.without([0.0, 0.0, GAP_PX, GAP_PX]), panel);
        }
    })
}

impl Panel {
    /// Draws one network alone, without a legend.
    pub fn draw(&self) -> Figure {
        let width_px = CHART_PX - 2.0 * MARGIN_PX;
        let height_px = panel_px(width_px - LEFT_PX - RIGHT_PX).y;
        Figure::draw(width_px, height_px, &[], |svg, space| draw(svg, space, self))
    }
}

/// Size of a panel with a plot of this side, px.
fn panel_px(plot_px: f64) -> DVec2 {
    DVec2::new(LEFT_PX + RIGHT_PX, heading_px("title", NOTES) + ABOVE_PX + BELOW_PX) + plot_px
}

fn draw(svg: &mut Svg, space: Area, Panel { title, samples }: &Panel) {
    match samples {
        Samples::Values { unit, pairs } => scatter::draw(svg, space, title, unit, pairs),
        Samples::Events(events) => reliability::draw(svg, space, title, events),
    }
}

fn legend(panels: &[Panel]) -> Vec<Entry> {
    if panels.is_empty() {
        return Vec::new();
    }
    let has = |events: bool| panels.iter().any(|p| matches!(p.samples, Samples::Events(_)) == events);
    let mut entries = vec![
        Entry::new("perfect prediction", |svg, at| svg.line(&legend::stroke(at), GREY.line(0.75))),
        Entry::new("trend", |svg, at| svg.line(&legend::stroke(at), VERMILION.line(1.5))),
    ];
    if has(false) {
        entries.push(Entry::new("held-out sample", |svg, at| svg.circle(at, 2.0, BLUE.fill().opacity(0.7))));
        entries.push(Entry::new("beyond the frame", |svg, at| arrowhead(svg, at, DVec2::NEG_Y, 7.0, INK)));
    }
    if has(true) {
        entries.push(Entry::new("share of a bin, 95 % interval, n below", reliability::mark));
    }
    entries
}

/// Draws a title with the trend beneath it, and returns the space below.
fn headed(svg: &mut Svg, space: Area, title: &str, trend: Option<Trend>, counts: String) -> Area {
    let fit = trend.map_or_else(String::new, |t| {
        let [slope, intercept, r2] = [t.slope, t.intercept, t.r2].map(|v| number(v, 3));
        format!("slope {slope}, intercept {intercept}, R² {r2}")
    });
    heading(svg, space, title, &[fit, counts])
}

/// Draws the diagonal, and the trend as far as it lies in the frame `low..=high` of both axes.
fn lines(svg: &mut Svg, plane: &Plane, low: f64, high: f64, trend: Option<Trend>) {
    svg.line(&[plane.place(low, low), plane.place(high, high)], GREY.line(0.75));
    let Some(trend) = trend else { return };
    let reach = [low, high].map(|y| (y - trend.intercept) / trend.slope);
    let (from, to) = if trend.slope == 0.0 {
        (low, high)
    } else {
        (low.max(reach[0].min(reach[1])), high.min(reach[0].max(reach[1])))
    };
    if from < to && (trend.slope != 0.0 || (low..=high).contains(&trend.intercept)) {
        let ends = [from, to].map(|x| plane.place(x, trend.at(x).clamp(low, high)));
        svg.line(&ends, VERMILION.line(1.5));
    }
}
