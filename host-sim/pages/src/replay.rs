//! Replay: runs on a map of the room, moment by moment.

use std::collections::BTreeMap;

use glam::DVec2;
use maud::{Markup, html};
use serde::Serialize;

use super::document::{Script, chart};
use super::words::tenths;
use mindgap_figures::report::over_time::over_time;
use mindgap_figures::report::room::Room;
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evaluation::replay::Moment;
use mindgap_logs::Robot;

/// Runs to replay.
#[derive(Serialize)]
pub struct Replay {
    /// The runs.
    runs: Vec<ReplayedRun>,
    /// Who drives in them; the others are compared with the first.
    kinds: Vec<Kind>,
    robot: Body,
    /// The room in which they drive.
    #[serde(skip)]
    room: Room,
    /// Number of all runs, of which these are some.
    #[serde(skip)]
    of: usize,
}

/// A robot, real or simulated.
#[derive(Clone, Copy, Serialize)]
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

/// The user's own simulator, as it was recorded.
pub const RECORDED: Kind = Kind { id: "recorded", name: "the simulator, as recorded" };

/// One run, row by row.
#[derive(Serialize)]
pub struct ReplayedRun {
    /// Its name.
    pub name: String,
    /// Time of each row.
    pub t_s: Vec<f64>,
    /// Remark on each row.
    pub remarks: Vec<String>,
    /// The track of each robot, by its kind's id.
    pub tracks: BTreeMap<&'static str, Track>,
}

/// Positions (cm), headings (degrees) and readings (cm), row by row.
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

/// Most rows per page: it stays under two megabytes with them.
const MOST_ROWS: usize = 6000;
/// Most runs to choose from.
const MOST_RUNS: usize = 100;
const SCRIPT: &str = include_str!("../assets/page/replay.js");

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

/// Chooses runs to show from their numbers of rows, all or evenly spread ones, each with the number of rows to show.
pub fn sampled(rows: &[usize]) -> Vec<(usize, usize)> {
    let spread = |count: usize| (0..count).map(move |i| i * rows.len() / count);
    let fits = |count: &usize| spread(*count).map(|run| rows[run]).sum::<usize>() <= MOST_ROWS;
    let count = (1..=rows.len().min(MOST_RUNS)).rev().find(fits).unwrap_or(rows.len().min(1));
    spread(count).map(|run| (run, rows[run].min(MOST_ROWS))).collect()
}

impl Track {
    fn echoes_cm(&self) -> impl Iterator<Item = f64> {
        self.echo.iter().copied().flatten()
    }

    /// Distances from another track at the rows that both have, cm.
    fn apart_cm(&self, other: &Track) -> impl Iterator<Item = f64> {
        let along = |own: &'_ [Option<f64>], theirs: &[Option<f64>]| -> Vec<Option<f64>> {
            own.iter().zip(theirs).map(|(a, b)| Some((*a)? - (*b)?)).collect()
        };
        let (x, y) = (along(&self.x, &other.x), along(&self.y, &other.y));
        x.into_iter().zip(y).filter_map(|(x, y)| Some(libm::hypot(x?, y?)))
    }
}

impl Replay {
    /// Runs of a robot in a room, `of` all.
    pub fn new(robot: &Robot, room: Room, kinds: Vec<Kind>, runs: Vec<ReplayedRun>, of: usize) -> Self {
        let sensor = robot.ultrasonic.map_or([0.0; 3], |sensor| [sensor.x_cm, sensor.y_cm, sensor.yaw_deg]);
        let body = Body { radius_cm: robot.body_radius_cm, sensor };
        Replay { runs, kinds, robot: body, room, of }
    }

    /// Whether a robot of this kind drives in it.
    pub fn shows(&self, kind: &Kind) -> bool {
        self.kinds.iter().any(|shown| shown.id == kind.id)
    }

    /// The script that moves it.
    ///
    /// # Errors
    /// When a number in it has no form in JSON.
    pub fn script(&self) -> Result<Script> {
        Script::new(SCRIPT, self)
    }

    /// The map, its controls, the table of the moment and the charts over time.
    pub fn markup(&self) -> Markup {
        let (shown, compares) = (self.runs.len(), self.kinds.len() > 1);
        let most_s = self.runs.iter().filter_map(|run| run.t_s.last().copied()).fold(0.0, f64::max);
        let most_read_cm = self.tracks().flat_map(|(_, track)| track.echoes_cm()).fold(0.0, f64::max);
        let most_apart_cm = self.tracks().flat_map(|(first, track)| track.apart_cm(first)).fold(0.0, f64::max);
        html! {
            noscript { p.bad { "The replay needs scripts. Everything else on this page is here without them." } }
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
                @for kind in &self.kinds {
                    label {
                        input type="checkbox" data-show=(kind.id) checked;
                        span.swatch.(kind.id) {} (kind.name)
                    }
                }
            }
            (self.stage())
            div.controls {
                button #play type="button" { "Play" }
                input #moment type="range" min="0" max="1" value="0" step="1" aria-label="Moment of the run";
            }
            p { output #clock for="moment run" {} }
            div.wide tabindex="0" role="region" aria-label="Positions at this moment" {
                table {
                    thead {
                        tr {
                            th scope="col" { "robot" } th.n scope="col" { "x, y (cm)" } th.n scope="col" { "heading" }
                            th.n scope="col" { "reading (cm)" }
                            @if compares { th.n scope="col" { "distance (cm)" } }
                        }
                    }
                    tbody {
                        @for kind in &self.kinds {
                            tr data-kind=(kind.id) {
                                th scope="row" { span.swatch.(kind.id) {} " " (kind.name) }
                                @for field in ["place", "heading", "echo"] { td.n data-field=(field) {} }
                                @if compares { td.n data-field="off" {} }
                            }
                        }
                    }
                }
            }
            @if most_read_cm > 0.0 {
                (chart("readings", &over_time(most_s, "reading (cm)", most_read_cm), "Readings over the time of the run",
                    html! { "Readings of the sensor. Where there is no dot there is no reading, or none is expected." }))
            }
            @if most_apart_cm > 0.0 {
                (chart("apart", &over_time(most_s, "distance (cm)", most_apart_cm), "Distance from the robot over time",
                    html! { "Distance of the simulated robots from the real one." }))
            }
        }
    }

    /// Each track with the one that it is compared with.
    fn tracks(&self) -> impl Iterator<Item = (&Track, &Track)> {
        self.runs.iter().flat_map(|run| {
            let first = &run.tracks[self.kinds[0].id];
            run.tracks.values().map(move |track| (first, track))
        })
    }

    /// The room, in cm with `y` downwards.
    fn stage(&self) -> Markup {
        let ([low, high], scene) = (self.room.framed().map(|at| DVec2::new(at.x, -at.y)), &self.room.scene);
        let view_box = [low.x, high.y, high.x - low.x, low.y - high.y].map(|cm| tenths(cm).to_string()).join(" ");
        let corners = |a: DVec2, b: DVec2| [a.x, -a.y, b.x, -b.y].map(tenths);
        html! {
            svg.stage #stage viewBox=(view_box) role="img" aria-label="The room from above; the table below has all positions." {
                @for obstacle in &scene.obstacles {
                    @let [x, bottom, right, y] = corners(obstacle.low_cm, obstacle.high_cm);
                    rect.obstacle x=(x) y=(y) width=(tenths(right - x)) height=(tenths(bottom - y)) {}
                }
                @for wall in scene.sides() {
                    @let [x1, y1, x2, y2] = corners(wall.from_cm, wall.to_cm);
                    line.wall x1=(x1) y1=(y1) x2=(x2) y2=(y2) {}
                }
                @if let Some(target) = scene.target_cm {
                    circle.target cx=(tenths(target.x)) cy=(tenths(-target.y)) r=(self.room.target_radius_cm) {}
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
