//! Paths on a map of the room: figure 4 of the paper, simulated and real paths per start, and a controller's runs by how they
//! ended.

use glam::DVec2;

use super::axis::is_drawable;
use super::chart::{heading, heading_px, no_data};
use super::figure::{CHART_PX, Figure, MARGIN_PX};
use super::glyph::{arrowhead, cross};
use super::legend::{self, Entry};
use super::room::Room;
use super::style::{BLUE, Colour, GREEN, GREY, INK, Style, VERMILION, WHITE};
use super::svg::{Area, Svg};
use mindgap_foundations::geometry::Pose;
use mindgap_logs::Scene;

/// Most height of a map with its labels, px.
const MOST_HEIGHT_PX: f64 = 460.0;
const GAP_PX: f64 = 14.0;
const PANELS_PER_ROW: usize = 2;

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

/// Runs that ended in one way.
#[derive(Clone, Debug, PartialEq)]
pub struct Ending {
    /// The way.
    pub name: String,
    /// Number and path of each run.
    pub runs: Vec<(usize, Trace)>,
}

/// A map with paths of several kinds.
struct Map<'a> {
    title: &'a str,
    room: Room,
    start: Pose,
    kinds: Vec<Kind<'a>>,
}

/// Paths that are drawn alike.
struct Kind<'a> {
    name: &'a str,
    colour: Colour,
    line: Style,
    /// What is read at the end of each path, and the path.
    traces: Vec<(String, &'a Trace)>,
}

/// Draws a panel for every start, two per row, with equal scales on both axes.
pub fn paths(panels: &[PathPanel]) -> Figure {
    let real = VERMILION.line(1.5);
    let simulated = BLUE.line(1.25).dashed();
    let maps: Vec<Map> = panels
        .iter()
        .map(|panel| {
            let kinds = vec![
                Kind::numbered("real path", VERMILION, real, &panel.real),
                Kind::numbered("simulated path", BLUE, simulated, &panel.simulated),
            ];
            Map::new(&panel.title, &panel.scene, panel.start, panel.target_radius_cm, kinds)
        })
        .collect();
    draw(&maps)
}

/// Draws the runs of a controller, coloured by how they ended: the first way blue, the second vermilion, the third green.
pub fn endings(scene: &Scene, start: Pose, target_radius_cm: f64, endings: &[Ending]) -> Figure {
    let kinds = endings.iter().zip([BLUE, VERMILION, GREEN]).map(|(ending, colour)| ending.kind(colour)).collect();
    draw(&[Map::new("", scene, start, target_radius_cm, kinds)])
}

fn draw(maps: &[Map]) -> Figure {
    let most = DVec2::new(CHART_PX - 2.0 * MARGIN_PX, MOST_HEIGHT_PX);
    let sizes: Vec<DVec2> = maps.iter().map(|map| map.room.size_px(most)).collect();
    let largest = sizes.iter().copied().reduce(DVec2::max).unwrap_or(most);
    let title_px = maps.iter().map(|map| heading_px(map.title, 0)).fold(0.0, f64::max);
    let columns = maps.len().clamp(1, PANELS_PER_ROW);
    let rows = maps.len().div_ceil(columns).max(1);
    let gap = DVec2::new(GAP_PX * (columns as f64 - 1.0), GAP_PX);
    let cell = largest + DVec2::new(gap.x, gap.y + title_px);
    let (width_px, height_px) = (cell.x * columns as f64, cell.y * rows as f64);
    Figure::draw(width_px, height_px, &legend(maps), |svg, space| {
        if maps.is_empty() {
            no_data(svg, space);
        }
        for ((cell, map), size) in space.cells(rows, columns).zip(maps).zip(&sizes) {
            let body = heading(svg, cell, map.title, &[]);
            map.draw(svg, Area { width: size.x, height: size.y, ..body });
        }
    })
}

fn legend(maps: &[Map]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let Some(first) = maps.first() else { return entries };
    let runs = || maps.iter().flat_map(|map| &map.kinds).flat_map(|kind| &kind.traces).map(|(_, trace)| trace);
    for (i, Kind { name, line, .. }) in first.kinds.iter().enumerate() {
        let line = *line;
        if maps.iter().any(|map| !map.kinds[i].traces.is_empty()) {
            entries.push(Entry::new(*name, move |svg, at| svg.line(&legend::stroke(at), line)));
        }
    }
    entries.push(Entry::new("start", |svg, at| arrowhead(svg, at, DVec2::X, 13.0, INK)));
    if runs().any(|trace| !trace.crashed) {
        entries.push(Entry::new("end", |svg, at| stop(svg, at, GREY)));
    }
    if runs().any(|trace| trace.crashed) {
        entries.push(Entry::new("crash", |svg, at| cross(svg, at, GREY)));
    }
    if maps.iter().any(|map| map.room.scene.target_cm.is_some()) {
        entries.push(Entry::new("target", |svg, at| {
            svg.circle(at, 7.0, GREEN.fill().opacity(0.18));
            svg.circle(at, 7.0, GREEN.line(1.5));
        }));
    }
    entries
}

impl Ending {
    fn kind(&self, colour: Colour) -> Kind<'_> {
        let traces = self.runs.iter().map(|(run, trace)| (format!("run {run}: {}", self.name), trace)).collect();
        Kind { name: &self.name, colour, line: colour.line(1.25).opacity(0.5), traces }
    }
}

impl<'a> Kind<'a> {
    fn numbered(name: &'a str, colour: Colour, line: Style, traces: &'a [Trace]) -> Self {
        let traces = traces.iter().enumerate().map(|(i, trace)| (format!("{name} {}", i + 1), trace)).collect();
        Kind { name, colour, line, traces }
    }
}

impl<'a> Map<'a> {
    fn new(title: &'a str, scene: &Scene, start: Pose, target_radius_cm: f64, kinds: Vec<Kind<'a>>) -> Self {
        let paths =
            || kinds.iter().flat_map(|kind| &kind.traces).flat_map(|(_, trace)| trace.points_cm.iter().copied());
        let reach = DVec2::splat(target_radius_cm);
        let target = scene.target_cm.map(|at| [at - reach, at + reach]).into_iter().flatten();
        let room = Room::new(scene, target_radius_cm, paths().chain(target).chain([start.position_cm]));
        Map { title, room, start, kinds }
    }

    /// Whether there is neither a wall nor a drawable path.
    fn is_empty(&self) -> bool {
        let is_drawn = |(_, trace): &(String, &Trace)| trace.points_cm.iter().any(|p| is_drawable(*p));
        self.room.scene.sides().is_empty() && !self.kinds.iter().any(|kind| kind.traces.iter().any(is_drawn))
    }

    fn draw(&self, svg: &mut Svg, area: Area) {
        if self.is_empty() {
            return no_data(svg, area);
        }
        let plane = self.room.plane(area);
        let place = |at: DVec2| plane.place(at.x, at.y);
        plane.draw_axes(svg);
        svg.clipped(plane.area, |svg| {
            self.room.draw(svg, &plane);
            for Kind { line, traces, .. } in &self.kinds {
                let pieces = traces.iter().flat_map(|(_, trace)| trace.points_cm.split(|p| !is_drawable(*p)));
                for piece in pieces.filter(|piece| piece.len() > 1) {
                    svg.line(&piece.iter().map(|p| place(*p)).collect::<Vec<DVec2>>(), *line);
                }
            }
            let ahead = self.start.direction() * DVec2::new(1.0, -1.0);
            arrowhead(svg, place(self.start.position_cm), ahead, 13.0, INK);
            for Kind { colour, traces, .. } in &self.kinds {
                for (title, trace) in traces {
                    let Some(end) = trace.points_cm.iter().rev().find(|p| is_drawable(**p)) else { continue };
                    let mark = if trace.crashed { cross } else { stop };
                    svg.titled(title, |svg| mark(svg, place(*end), *colour));
                }
            }
        });
    }
}

/// Where a run ended without a crash.
fn stop(svg: &mut Svg, at: DVec2, colour: Colour) {
    svg.circle(at, 3.5, colour.fill().rimmed(WHITE, 1.0));
}
