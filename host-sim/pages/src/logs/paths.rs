//! Where the robot drove: the paths of runs in their room.

use glam::DVec2;
use maud::html;

use super::drawn::{Drawn, MARKED, chosen, spread};
use crate::document::{Section, chart};
use mindgap_figures::report::driven::Driven;
use mindgap_figures::report::paths::Trace;
use mindgap_figures::report::room::Room;
use mindgap_logs::Logs;
use mindgap_models::simulator::rollout::REACHED_CM;

/// Runs that are drawn.
const MOST_RUNS: usize = 40;
/// Points that are drawn of all paths.
const MOST_POINTS: usize = 16_000;
/// Rows that are marked.
const MOST_MARKS: usize = 300;

/// The section.
pub fn section(runs: &[Drawn], corrected: &Logs) -> Section {
    let places = || corrected.runs.iter().flat_map(|run| run.rows.iter().filter_map(|row| row.pose));
    if places().next().is_none() {
        let body =
            html! { p { "The tracker never saw the robot in these logs, so there is nothing to show on a map." } };
        return Section { id: "paths", title: "Where the robot drove", body };
    }
    let shown = chosen(runs, MOST_RUNS);
    let rows: usize = shown.iter().map(|drawn| drawn.run.rows.len()).sum();
    let every = rows.div_ceil(MOST_POINTS).max(1);
    let marks: Vec<(DVec2, String)> = shown.iter().flat_map(|drawn| drawn.marks()).collect();
    let marked = spread(&marks, marks.len().min(MOST_MARKS));
    let shown_marks = marked.len();
    let drawn = Driven {
        room: Room::new(&corrected.scene, REACHED_CM, places().map(|pose| pose.position_cm)),
        runs: shown.iter().map(|drawn| (drawn.name(), trace(drawn, every))).collect(),
        marked,
        marked_name: MARKED.into(),
    };
    let said = format!("Paths of {} runs on a map of the room, with {shown_marks} marked places.", shown.len());
    let body = html! {
        (chart("driven", &drawn.draw(), &said, html! {
            (how_many(shown.len(), runs.len())) " A line is broken where the tracker lost the robot."
            @if every > 1 { " Every " (every) "th row is drawn." }
            @if !marks.is_empty() {
                " Dots mark rows with a defect, at the place that was logged"
                @if shown_marks < marks.len() { ": " (shown_marks) " of " (marks.len()) }
                "."
            }
        }))
    };
    Section { id: "paths", title: "Where the robot drove", body }
}

/// Says how many of all runs are drawn.
pub fn how_many(shown: usize, all: usize) -> String {
    match (shown, all) {
        (1, 1) => "The only run.".into(),
        (shown, all) if shown == all => format!("All {all} runs."),
        (shown, all) => {
            format!("{shown} of {all} runs: some with defects, if there are any, the others evenly spread.")
        }
    }
}

/// The path of a run by every nth row; a lost robot is a point that is not finite.
fn trace(drawn: &Drawn, every: usize) -> Trace {
    let rows = drawn.run.rows.iter().step_by(every);
    Trace { points_cm: rows.map(|row| row.pose.map_or(DVec2::NAN, |pose| pose.position_cm)).collect(), crashed: false }
}
