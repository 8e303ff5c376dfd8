//! The page of a controller's simulated runs: where they end, what the controller does, and the runs to be watched.

use std::collections::BTreeMap;

use glam::DVec2;
use maud::{Markup, html};
use mindgap_core::controller::{Controller, TUPLES, When};
use serde::Serialize;

use super::document::{Document, Script, Section, chart, open_table};
use super::replay::{Kind, Replay, ReplayedRun, sampled};
use super::room::Room;
use super::words::{number, percent, tenths};
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::median;
use mindgap_learning::evaluation::replay::Moment;
use mindgap_logs::{Robot, Scene, Termination};
use mindgap_models::simulator::rollout_report::{PathPoint, Rollout, RolloutReport};

/// What a page is made of.
pub struct Subject<'a> {
    /// The runs.
    pub rollouts: &'a RolloutReport,
    /// Of this controller,
    pub controller: &'a Controller,
    /// with this robot,
    pub robot: &'a Robot,
    /// in this scene.
    pub scene: &'a Scene,
    /// Files of simulator, controller and scene.
    pub names: [&'a str; 3],
    /// Start within the scene, from 1.
    pub start: usize,
    /// Seed of the draws.
    pub seed: u64,
}

#[derive(Serialize)]
struct Data<'a> {
    room: Room,
    paths: Vec<Path>,
    turns: Vec<Turn>,
    replay: &'a Replay,
}

#[derive(Serialize)]
struct Path {
    run: usize,
    ending: String,
    x: Vec<f64>,
    y: Vec<f64>,
}

/// A tuple's turn in a run, in steps.
#[derive(Serialize)]
struct Turn {
    run: usize,
    tuple: usize,
    from: usize,
    to: usize,
}

const TUPLES_HEADER: [&str; 5] = ["tuple", "left, right", "until a reading is", "begins at step (range)", "runs"];
const DRIVEN: Kind = Kind { id: "simulator", name: "the simulated robot" };

/// The page, whole in one file.
///
/// # Errors
/// When a number in it has no form in JSON.
pub fn page(subject: &Subject) -> Result<String> {
    let Subject { rollouts, scene, names: [sim, controller, room], .. } = subject;
    let lengths: Vec<usize> = rollouts.runs.iter().map(|run| run.path.len()).collect();
    let shown: Vec<usize> = sampled(&lengths).into_iter().map(|(run, _)| run).collect();
    let replay = replay(subject, &shown);
    let places = rollouts.runs.iter().flat_map(|run| run.path.iter().map(|p| DVec2::new(p.x_cm, p.y_cm)));
    let data = Data {
        room: Room::new(scene, rollouts.reached_within_cm, places),
        paths: shown.iter().map(|run| path(*run, &rollouts.runs[*run])).collect(),
        turns: shown.iter().flat_map(|run| turns(*run, &rollouts.runs[*run])).collect(),
        replay: &replay,
    };
    Document {
        kind: "Simulation",
        headline: &headline(rollouts),
        subject: &format!("{controller} in {sim}, {room}, start {}", subject.start),
        lead: html! {
            p { "Each run is of another robot that the simulator's logs leave possible, with the noise of its motors and its sensor." }
        },
        sections: vec![
            Section { id: "paths", title: "Where the runs end", body: paths(rollouts, shown.len()) },
            Section { id: "tuples", title: "What the controller does", body: tuples(subject) },
            Section { id: "replay", title: "Replay", body: replay.markup() },
            Section { id: "compared", title: "What was run", body: source(subject) },
        ],
        scripts: &[Script::Simulation, Script::Replay],
    }
    .html(&data)
}

fn headline(rollouts: &RolloutReport) -> String {
    let (runs, crashed) = (rollouts.runs.len(), ended(rollouts, Termination::Crashed));
    let crashes =
        if crashed == 0 { "none crashes".into() } else { format!("{} crash", percent(crashed as f64 / runs as f64)) };
    match rollouts.success {
        Some(success) => format!("{} of {runs} simulated runs reach the target; {crashes}.", percent(success)),
        None => format!("Of {runs} simulated runs {crashes}; the scene has no target."),
    }
}

fn ended(rollouts: &RolloutReport, how: Termination) -> usize {
    rollouts.runs.iter().filter(|run| run.termination == how).count()
}

fn paths(rollouts: &RolloutReport, shown: usize) -> Markup {
    let told = [
        (Termination::Finished, "the sixth tuple's test held and the robot stopped"),
        (
            Termination::TimedOut,
            "the robot was still driving when the steps that it may take were used up, and was stopped",
        ),
        (Termination::Crashed, "the robot touched a wall or an obstacle"),
    ];
    let rows: Vec<[String; 3]> = told
        .into_iter()
        .filter(|(how, _)| ended(rollouts, *how) > 0)
        .map(|(how, meaning)| [how.to_string(), ended(rollouts, how).to_string(), meaning.into()])
        .collect();
    html! {
        (open_table(["ending", "runs", "what it means"], &rows))
        @if rollouts.success.is_some() {
            p.quiet {
                "A run reaches the target when it ends within " (number(rollouts.reached_within_cm, 0))
                " cm of it without a crash, however it ends: one that times out there has reached it too."
            }
        }
        (chart("runs", 0, &headline(rollouts), html! {
            "All paths from the start; the ring is the target. "
            @if shown < rollouts.runs.len() { (shown) " of " (rollouts.runs.len()) " runs, evenly spread, are drawn." }
        }))
    }
}

fn tuples(subject: &Subject) -> Markup {
    let Subject { controller, rollouts, .. } = subject;
    let begins = |tuple: usize| -> Vec<f64> {
        let begin = |run: &Rollout| run.path.iter().position(|p| p.tuple == tuple);
        rollouts.runs.iter().filter_map(begin).map(|step| step as f64).collect()
    };
    let rows: Vec<[String; 5]> = (0..TUPLES)
        .map(|i| {
            let (tuple, begins) = (&controller.tuples[i], begins(i + 1));
            let side = if tuple.when == When::Larger { "above" } else { "below" };
            let begin = match begins.as_slice() {
                [] => "–".into(),
                all => {
                    let (low, high) = all.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), s| (l.min(*s), h.max(*s)));
                    format!("{:.0} ({low:.0} to {high:.0})", median(all.iter().copied()))
                }
            };
            [
                format!("{}", i + 1),
                format!("{},\u{a0}{}", number(f64::from(tuple.left), 0), number(f64::from(tuple.right), 0)),
                format!("{side} {}\u{a0}cm", tuple.threshold_cm),
                begin,
                begins.len().to_string(),
            ]
        })
        .collect();
    html! {
        p { "The robot holds a tuple's commands until a reading is on the stated side of its threshold, then takes "
        "the next." }
        (open_table(TUPLES_HEADER, &rows))
        p.quiet { "The step is the median over the runs in which the tuple is reached; the last column counts them." }
        (chart("turns", 0, "Which tuple each run holds, step by step", html! {
            "Which tuple each run holds, step by step: a row is a run."
        }))
    }
}

fn path(run: usize, rollout: &Rollout) -> Path {
    let along = |of: fn(&PathPoint) -> f64| rollout.path.iter().map(|p| tenths(of(p))).collect();
    Path { run: run + 1, ending: rollout.termination.to_string(), x: along(|p| p.x_cm), y: along(|p| p.y_cm) }
}

fn turns(run: usize, rollout: &Rollout) -> Vec<Turn> {
    let mut from = 0;
    // At its last point a run is over.
    let driven = rollout.path.split_last().map_or(&[][..], |(_, driven)| driven);
    let held = driven.chunk_by(|a, b| a.tuple == b.tuple).map(|points| {
        let turn = Turn { run: run + 1, tuple: points[0].tuple, from, to: from + points.len() };
        from += points.len();
        turn
    });
    held.filter(|turn| turn.tuple <= TUPLES).collect()
}

fn replay(subject: &Subject, shown: &[usize]) -> Replay {
    let Subject { rollouts, controller, robot, .. } = subject;
    let run = |place: &usize| {
        let rollout = &rollouts.runs[*place];
        let moment = |p: &PathPoint| Moment {
            pose: Some(Pose::new(p.x_cm, p.y_cm, p.heading_deg.to_radians())),
            echo_cm: p.echo_cm.map(f64::from),
        };
        let told = |p: &PathPoint| match controller.tuples.get(p.tuple - 1) {
            Some(tuple) => {
                let [left, right] = [tuple.left, tuple.right].map(|command| number(f64::from(command), 0));
                format!("tuple {}: commands {left}, {right}", p.tuple)
            }
            None => "finished".into(),
        };
        ReplayedRun {
            name: format!("run {}: {}", place + 1, rollout.termination),
            t_s: (0..rollout.path.len()).map(|step| step as f64 * f64::from(controller.step_ms) / 1000.0).collect(),
            told: rollout.path.iter().map(told).collect(),
            tracks: BTreeMap::from([(DRIVEN.id, rollout.path.iter().map(moment).collect::<Vec<_>>().into())]),
        }
    };
    Replay::new(robot, &[DRIVEN], shown.iter().map(run).collect(), rollouts.runs.len())
}

fn source(subject: &Subject) -> Markup {
    let Subject { rollouts, controller, names: [sim, file, scene], start, seed, .. } = subject;
    html! {
        dl {
            dt { "Controller" }
            dd { (file) ", a step every " (controller.step_ms) " ms, " (controller.max_steps) " steps at most" }
            dt { "Simulator" } dd { (sim) }
            dt { "Scene" } dd { (scene) ", start " (start) }
            dt { "Runs" } dd { (rollouts.runs.len()) ", seed " (seed) }
        }
    }
}
