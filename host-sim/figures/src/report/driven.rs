//! The logged paths of many runs on a map of their room, with marked places.

use glam::DVec2;

use super::axis::is_drawable;
use super::figure::{CHART_PX, Figure, MARGIN_PX};
use super::glyph::{bead, mark};
use super::legend::{self, Entry};
use super::paths::Trace;
use super::room::Room;
use super::style::{BLUE, GREEN, VERMILION};

const MOST_HEIGHT_PX: f64 = 460.0;
/// Number of runs above which lines are drawn fainter.
const CROWD: usize = 8;
const START: usize = 0;

/// Runs in a room.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven {
    /// The room.
    pub room: Room,
    /// Name and path of each run.
    pub runs: Vec<(String, Trace)>,
    /// Marked places, cm, and what is read there under the pointer.
    pub marked: Vec<(DVec2, String)>,
    /// What the marks are, in the legend.
    pub marked_name: String,
}

impl Driven {
    /// Draws the map.
    pub fn draw(&self) -> Figure {
        let size = self.room.size_px(DVec2::new(CHART_PX - 2.0 * MARGIN_PX, MOST_HEIGHT_PX));
        let line = BLUE.line(1.25).opacity(if self.runs.len() > CROWD { 0.5 } else { 0.8 });
        Figure::draw(CHART_PX - 2.0 * MARGIN_PX, size.y, &self.entries(), |svg, space| {
            let plane = self.room.plane(space.split_across(size.x).0);
            let place = |at: DVec2| plane.place(at.x, at.y);
            plane.draw_axes(svg);
            svg.clipped(plane.area, |svg| {
                self.room.draw(svg, &plane);
                for (_, trace) in &self.runs {
                    for piece in trace.points_cm.split(|p| !is_drawable(*p)).filter(|piece| piece.len() > 1) {
                        svg.line(&piece.iter().map(|p| place(*p)).collect::<Vec<DVec2>>(), line);
                    }
                }
                for (name, trace) in &self.runs {
                    let start = trace.points_cm.iter().find(|p| is_drawable(**p));
                    start.into_iter().for_each(|at| svg.titled(name, |svg| mark(svg, place(*at), START, BLUE)));
                }
                for (at, title) in self.marked.iter().filter(|(at, _)| is_drawable(*at)) {
                    svg.titled(title, |svg| bead(svg, place(*at), VERMILION));
                }
            });
        })
    }

    fn entries(&self) -> Vec<Entry> {
        let mut entries = vec![
            Entry::new("path of a run", |svg, at| svg.line(&legend::stroke(at), BLUE.line(1.25))),
            Entry::new("its start", |svg, at| mark(svg, at, START, BLUE)),
        ];
        if !self.marked.is_empty() {
            entries.push(Entry::new(self.marked_name.clone(), |svg, at| bead(svg, at, VERMILION)));
        }
        if self.room.scene.target_cm.is_some() {
            entries.push(Entry::new("target", |svg, at| svg.circle(at, 7.0, GREEN.line(1.5))));
        }
        entries
    }
}
