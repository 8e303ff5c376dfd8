//! Figure 4 of the paper: simulated and real paths of a controller, a panel a start.

use std::ops::Range;

use glam::DVec2;
use plotters::element::{Circle, Rectangle};
use plotters::style::{Color, RGBColor, WHITE};

use super::chart::{Axis, BELOW_PX, Chart, LEFT_PX, chart, headed, heading_px, is_drawable, no_data};
use super::figure::{Canvas, Drawn, Figure};
use super::glyph::{Place, arrowhead, cross, dashed_line, rimmed_dot, solid_line};
use super::legend::{self, Entry};
use super::style::{BLUE, GREEN, GREY, INK, SOLID, VERMILION, line, px};
use mindgap_foundations::geometry::Pose;
use mindgap_logs::Scene;

/// The longer side of the largest plot, px.
const PLOT_PX: f64 = 380.0;
const RIGHT_PX: f64 = 24.0;
const MARGIN_PX: f64 = 14.0;
const PANELS_A_ROW: usize = 2;
/// Margin of a panel, as a share of its longer side.
const EDGE: f64 = 0.03;

const SIMULATED: RGBColor = BLUE;
const REAL: RGBColor = VERMILION;

/// The runs of one controller from one start.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPanel {
    /// Title of the panel.
    pub title: String,
    /// The scene; its target and walls are drawn, its starts are not.
    pub scene: Scene,
    /// Start pose of the runs.
    pub start: Pose,
    /// Radius of the target, cm.
    pub target_radius_cm: f64,
    /// Simulated runs.
    pub simulated: Vec<Trace>,
    /// Runs on the robot.
    pub real: Vec<Trace>,
}

/// Path of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Positions in order of time, cm. The line is broken where one is not finite because the tracker lost the robot.
    pub points_cm: Vec<DVec2>,
    /// Whether it ended in a collision.
    pub crashed: bool,
}

/// Draws a panel for every start, two a row, with equal scales on both axes.
pub fn paths(panels: &[PathPanel]) -> Figure {
    let columns = panels.len().clamp(1, PANELS_A_ROW);
    let rows = panels.len().div_ceil(columns).max(1);
    let plots: Vec<DVec2> = panels.iter().map(plot_size_px).collect();
    let largest = plots.iter().copied().reduce(DVec2::max).unwrap_or(DVec2::splat(PLOT_PX));
    let cell = largest + DVec2::new(LEFT_PX + RIGHT_PX, heading_px(0) + BELOW_PX + MARGIN_PX);
    let inner = cell * DVec2::new(columns as f64, rows as f64);
    let entries = legend(panels);
    let legend_px = f64::from(legend::height_px(&entries, inner.x));
    let size = inner + DVec2::new(2.0 * MARGIN_PX, 2.0 * MARGIN_PX + legend_px);
    Figure::draw(libm::ceil(size.x) as u32, libm::ceil(size.y) as u32, |canvas| {
        let inside = canvas.margin(px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX), px(MARGIN_PX));
        let (grid, strip) = inside.split_vertically(px(inner.y));
        for ((cell, panel), plot) in grid.split_evenly((rows, columns)).iter().zip(panels).zip(&plots) {
            draw_panel(cell, panel, *plot)?;
        }
        if panels.is_empty() {
            no_data(&grid)?;
        }
        legend::draw(&strip, &entries)
    })
}

fn draw_panel(cell: &Canvas, panel: &PathPanel, plot_px: DVec2) -> Drawn {
    let body = headed(cell, &panel.title, &[])?;
    let body = body.shrink((0, 0), (px(LEFT_PX + plot_px.x), px(BELOW_PX + plot_px.y)));
    let Some((low, high)) = bounds_cm(panel) else { return no_data(&body) };
    let axis = |name: &str, range: Range<f64>, length_px: f64| Axis::new(name, range, (length_px / 55.0) as usize + 2);
    let (x, y) = (axis("x (cm)", low.x..high.x, plot_px.x), axis("y (cm)", low.y..high.y, plot_px.y));
    let chart = chart(&body, &x, &y)?;
    draw_scene(&chart, panel)?;
    for trace in &panel.real {
        for places in pieces(&chart, trace) {
            solid_line(&chart.canvas, &places, line(REAL, 1.25))?;
        }
    }
    for trace in &panel.simulated {
        for places in pieces(&chart, trace) {
            dashed_line(&chart.canvas, &places, line(SIMULATED, 1.25))?;
        }
    }
    arrowhead(&chart.canvas, place(&chart, panel.start.position_cm), panel.start.direction(), 13.0, INK)?;
    for (traces, colour) in [(&panel.real, REAL), (&panel.simulated, SIMULATED)] {
        for trace in traces {
            let Some(end) = trace.points_cm.iter().rev().find(|p| is_drawable(**p)) else { continue };
            let mark = if trace.crashed { crash } else { stop };
            mark(&chart.canvas, place(&chart, *end), colour)?;
        }
    }
    Ok(())
}

fn draw_scene(chart: &Chart, panel: &PathPanel) -> Drawn {
    let corners = |low: DVec2, high: DVec2| [place(chart, low), place(chart, high)];
    if let Some(size) = panel.scene.arena_cm {
        let corners = corners(DVec2::ZERO, size);
        let [(left, bottom), (right, top)] = corners;
        let round = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)];
        solid_line(&chart.canvas, &round, line(INK, 1.5))?;
    }
    for obstacle in &panel.scene.obstacles {
        chart.canvas.draw(&Rectangle::new(corners(obstacle.low_cm, obstacle.high_cm), SOLID.filled()))?;
    }
    for wall in &panel.scene.walls {
        solid_line(&chart.canvas, &corners(wall.from_cm, wall.to_cm), line(INK, 1.5))?;
    }
    if let Some(target_cm) = panel.scene.target_cm {
        let at = place(chart, target_cm);
        let radius = place(chart, target_cm + DVec2::X * panel.target_radius_cm).0 - at.0;
        chart.canvas.draw(&Circle::new(at, radius, GREEN.mix(0.18).filled()))?;
        chart.canvas.draw(&Circle::new(at, radius, line(GREEN, 0.75)))?;
        plus(&chart.canvas, at)?;
    }
    Ok(())
}

fn legend(panels: &[PathPanel]) -> Vec<Entry<'static>> {
    let mut entries = Vec::new();
    if panels.is_empty() {
        return entries;
    }
    if panels.iter().any(|p| !p.real.is_empty()) {
        entries.push(Entry::new("real path", |c, at| solid_line(c, &legend::stroke(at), line(REAL, 1.25))));
    }
    if panels.iter().any(|p| !p.simulated.is_empty()) {
        entries.push(Entry::new("simulated path", |c, at| dashed_line(c, &legend::stroke(at), line(SIMULATED, 1.25))));
    }
    entries.push(Entry::new("start", |c, at| arrowhead(c, at, DVec2::X, 13.0, INK)));
    let ends = |crashed: bool| panels.iter().any(|p| p.real.iter().chain(&p.simulated).any(|t| t.crashed == crashed));
    if ends(false) {
        entries.push(Entry::new("end", |c, at| stop(c, at, GREY)));
    }
    if ends(true) {
        entries.push(Entry::new("crash", |c, at| crash(c, at, GREY)));
    }
    if panels.iter().any(|p| p.scene.target_cm.is_some()) {
        entries.push(Entry::new("target", |c, at| {
            rimmed_dot(c, at, 7.0, GREEN.mix(0.18), GREEN)?;
            plus(c, at)
        }));
    }
    entries
}

fn stop(canvas: &Canvas, at: Place, colour: RGBColor) -> Drawn {
    rimmed_dot(canvas, at, 3.25, colour, WHITE)
}

fn crash(canvas: &Canvas, at: Place, colour: RGBColor) -> Drawn {
    cross(canvas, at, colour)
}

/// The middle of the target.
fn plus(canvas: &Canvas, at: Place) -> Drawn {
    let arm = px(3.0);
    solid_line(canvas, &[(at.0 - arm, at.1), (at.0 + arm, at.1)], line(GREEN, 1.0))?;
    solid_line(canvas, &[(at.0, at.1 - arm), (at.0, at.1 + arm)], line(GREEN, 1.0))
}

/// The contiguous drawable parts of a trace.
fn pieces(chart: &Chart, trace: &Trace) -> Vec<Vec<Place>> {
    let stretches = trace.points_cm.split(|p| !is_drawable(*p)).filter(|piece| piece.len() > 1);
    stretches.map(|piece| piece.iter().map(|p| place(chart, *p)).collect()).collect()
}

fn place(chart: &Chart, point_cm: DVec2) -> Place {
    chart.place(point_cm.x, point_cm.y)
}

/// The size of a panel's plot with equal scales.
fn plot_size_px(panel: &PathPanel) -> DVec2 {
    let size_cm = bounds_cm(panel).map_or(DVec2::ONE, |(low, high)| high - low);
    size_cm * (PLOT_PX / size_cm.max_element())
}

/// The bounding box of the scene and all paths; `None` if both are empty.
fn bounds_cm(panel: &PathPanel) -> Option<(DVec2, DVec2)> {
    let sides = panel.scene.sides();
    let traces = panel.real.iter().chain(&panel.simulated).flat_map(|t| t.points_cm.iter().copied());
    let shown = sides.iter().flat_map(|w| [w.from_cm, w.to_cm]).chain(traces).filter(|p| is_drawable(*p));
    let shown: Vec<DVec2> = shown.collect();
    let reach = DVec2::splat(panel.target_radius_cm);
    let target = panel.scene.target_cm.map(|t| [t - reach, t + reach]);
    let around = shown.first().map(|_| panel.start.position_cm);
    let all = || shown.iter().copied().chain(around).chain(target.into_iter().flatten());
    shown.first()?;
    let (low, high) = (all().reduce(DVec2::min)?, all().reduce(DVec2::max)?);
    let edge = DVec2::splat(EDGE * (high - low).max_element().max(1.0));
    Some((low - edge, high + edge))
}
