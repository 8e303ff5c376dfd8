//! Replay: runs on a map of the room, moment by moment.

use std::collections::BTreeMap;

use maud::{Markup, html};
use serde::Serialize;

use super::words::tenths;
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evaluation::replay::Moment;
use mindgap_logs::Robot;

/// What is replayed.
#[derive(Serialize)]
pub struct Replay {
    /// The runs.
    pub runs: Vec<ReplayedRun>,
    /// Who drives in them; the first is whom the others are compared with.
    pub kinds: &'static [Kind],
    robot: Body,
    /// Number of runs that there are.
    #[serde(skip)]
    pub of: usize,
}

/// Who drives.
#[derive(Serialize)]
pub struct Kind {
    /// Its name in style sheets and scripts.
    pub id: &'static str,
    /// Its name for people.
    pub name: &'static str,
}

/// The robot as it was logged.
pub const ROBOT: Kind = Kind { id: "robot", name: "the robot, as logged" };
/// The simulator as it is.
pub const SIMULATOR: Kind = Kind { id: "simulator", name: "the simulator" };
/// The simulator with effects.
pub const WITH_EFFECTS: Kind = Kind { id: "effects", name: "the simulator with the effects" };

/// One run, row by row.
#[derive(Serialize)]
pub struct ReplayedRun {
    /// Its name.
    pub name: String,
    /// Time of each row.
    pub t_s: Vec<f64>,
    /// What is told of each row.
    pub told: Vec<String>,
    /// Where each robot was, by its kind's id.
    pub tracks: BTreeMap<&'static str, Track>,
}

/// Places (cm), headings (degrees) and readings (cm), row by row.
#[derive(Serialize)]
pub struct Track {
    x: Vec<Option<f64>>,
    y: Vec<Option<f64>>,
    heading: Vec<Option<f64>>,
    echo: Vec<Option<f64>>,
}

#[derive(Serialize)]
struct Body {
    radius_cm: f64,
    sensor: [f64; 3],
}

/// As many rows are in a page: it stays under two megabytes with them.
const MOST_ROWS: usize = 6000;
/// As many runs are in a list.
const MOST_RUNS: usize = 100;

impl From<Vec<Moment>> for Track {
    fn from(moments: Vec<Moment>) -> Self {
        let pose = |of: fn(&Pose) -> f64| -> Vec<Option<f64>> {
            moments.iter().map(|m| m.pose.as_ref().map(|pose| tenths(of(pose)))).collect()
        };
        Track {
            x: pose(|p| p.position_cm.x),
            y: pose(|p| p.position_cm.y),
            heading: pose(|p| p.heading_rad.to_degrees()),
            echo: moments.iter().map(|m| m.echo_cm.map(tenths)).collect(),
        }
    }
}

/// Which of the runs with these numbers of rows are shown, and how many rows of each: all, or evenly spread ones.
pub fn sampled(rows: &[usize]) -> Vec<(usize, usize)> {
    let spread = |count: usize| (0..count).map(move |i| i * rows.len() / count);
    let fits = |count: &usize| spread(*count).map(|run| rows[run]).sum::<usize>() <= MOST_ROWS;
    let count = (1..=rows.len().min(MOST_RUNS)).rev().find(fits).unwrap_or(rows.len().min(1));
    spread(count).map(|run| (run, rows[run].min(MOST_ROWS))).collect()
}

impl Replay {
    /// Runs of a robot, `of` all.
    pub fn new(robot: &Robot, kinds: &'static [Kind], runs: Vec<ReplayedRun>, of: usize) -> Self {
        let sensor = robot.ultrasonic.map_or([0.0; 3], |sensor| [sensor.x_cm, sensor.y_cm, sensor.yaw_deg]);
        let body = Body { radius_cm: robot.body_radius_cm, sensor };
        Replay { runs, kinds, robot: body, of }
    }

    /// The map, its controls, and what is read from it.
    pub fn markup(&self) -> Markup {
        let (shown, compares) = (self.runs.len(), self.kinds.len() > 1);
        let tracks = || self.runs.iter().flat_map(|run| run.tracks.values());
        let reads = tracks().any(|track| track.echo.iter().any(Option::is_some));
        html! {
            @if shown < self.of {
                p.quiet { (shown) " of " (self.of) " runs, evenly spread, so that this page stays small." }
            }
            div.controls {
                label {
                    "Run"
                    select #run {
                        @for (i, run) in self.runs.iter().enumerate() { option value=(i) { (run.name) } }
                    }
                }
                @for kind in self.kinds {
                    label {
                        input type="checkbox" data-show=(kind.id) checked;
                        span.swatch.(kind.id) {} (kind.name)
                    }
                }
            }
            svg.stage #stage role="img" aria-label="The room from above; the table below says where everybody is." {}
            div.controls {
                button #play type="button" { "Play" }
                input #moment type="range" min="0" max="1" value="0" step="1" aria-label="Moment of the run";
            }
            p { output #clock for="moment run" {} }
            div.wide tabindex="0" role="region" aria-label="Where everybody is at this moment" {
                table {
                    thead {
                        tr {
                            th scope="col" { "who" } th.n scope="col" { "x, y (cm)" } th.n scope="col" { "heading" }
                            th.n scope="col" { "reading (cm)" }
                            @if compares { th.n scope="col" { "away (cm)" } }
                        }
                    }
                    tbody {
                        @for kind in self.kinds {
                            tr data-kind=(kind.id) {
                                th scope="row" { span.swatch.(kind.id) {} " " (kind.name) }
                                @for field in ["place", "heading", "echo"] { td.n data-field=(field) {} }
                                @if compares { td.n data-field="off" {} }
                            }
                        }
                    }
                }
            }
            @if reads {
                figure {
                    div.chart data-chart="readings" role="img" aria-label="Readings over the time of the run" {}
                    figcaption { "What the sensor reads; where there is no dot there is no reading, or none is expected." }
                }
            }
            @if compares {
                figure {
                    div.chart data-chart="apart" role="img" aria-label="Distance from the robot over time" {}
                    figcaption { "How far the simulated robots are from the real one." }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_runs_are_shown_whole_and_many_are_sampled() {
        assert_eq!(sampled(&[60; 24]).len(), 24);
        assert_eq!(sampled(&[]), []);
        let many = sampled(&[61; 10_000]);
        assert!(
            many.len() <= MOST_RUNS && many.len() * 61 <= MOST_ROWS && many.len() > MOST_RUNS / 2,
            "{}",
            many.len()
        );
        assert!(many.last().is_some_and(|(run, _)| *run > 9_000), "evenly spread over all");
        assert_eq!(sampled(&[50_000, 10]), [(0, MOST_ROWS)], "one long run is cut");
    }
}
