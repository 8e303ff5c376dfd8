//! The page of a controller's simulated runs: where they end, what the controller does, and a replay of the runs.

use std::collections::BTreeMap;

use glam::DVec2;
use maud::{Markup, html};
use mindgap_core::controller::{Controller, TUPLES, When};

use super::document::{Document, Section, chart, open_table};
use super::replay::{Kind, Replay, ReplayedRun, sampled};
use super::words::{number, percent};
use mindgap_figures::pictures::simulated;
use mindgap_figures::report::Figure;
use mindgap_figures::report::paths::{Ending, endings};
use mindgap_figures::report::room::Room;
use mindgap_figures::report::segments::{Row, Segment, SegmentChart};
use mindgap_figures::report::style::Colour;
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::median;
use mindgap_learning::evaluation::replay::Moment;
use mindgap_logs::{Robot, Scene, Termination};
use mindgap_models::simulator::rollout_report::{PathPoint, Rollout, RolloutReport};

/// The contents of a page.
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

/// Ways in which a run ends, and what each means.
const ENDINGS: [(Termination, &str); 3] = [
    (Termination::TimedOut, "the robot was still driving when it had used up its steps, and was stopped"),
    (Termination::Crashed, "the robot touched a wall or an obstacle"),
    (Termination::Finished, "the sixth tuple's test held and the robot stopped"),
];
const TUPLES_HEADER: [&str; 5] = ["tuple", "left, right", "until a reading is", "starts at step (range)", "runs"];
const DRIVEN: Kind = Kind { id: "simulator", name: "the simulated robot" };

/// Returns the page, whole in one file.
///
/// # Errors
/// When a number in it has no form in JSON.
pub fn page(subject: &Subject) -> Result<String> {
    let Subject { rollouts, names: [sim, controller, room], .. } = subject;
    let lengths: Vec<usize> = rollouts.runs.iter().map(|run| run.path.len()).collect();
    let shown: Vec<usize> = sampled(&lengths).into_iter().map(|(run, _)| run).collect();
    let replay = replay(subject, &shown);
    Ok(Document {
        kind: "Simulation",
        headline: &headline(rollouts),
        subject: &format!("{controller} in {sim}, {room}, start {}", subject.start),
        lead: html! {
            p { "Each run has another robot that is possible by the simulator's logs, with noise of its motors and its sensor." }
        },
        sections: vec![
            Section { id: "paths", title: "Where the runs end", body: paths(subject, &shown) },
            Section { id: "tuples", title: "What the controller does", body: tuples(subject, &shown) },
            Section { id: "replay", title: "Replay", body: replay.markup() },
            Section { id: "compared", title: "What was run", body: source(subject) },
        ],
        script: Some(replay.script()?),
    }
    .html())
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

fn paths(subject: &Subject, shown: &[usize]) -> Markup {
    let rollouts = subject.rollouts;
    let rows: Vec<[String; 3]> = ENDINGS
        .into_iter()
        .rev()
        .filter(|(how, _)| ended(rollouts, *how) > 0)
        .map(|(how, meaning)| [how.to_string(), ended(rollouts, how).to_string(), meaning.into()])
        .collect();
    html! {
        (open_table(["ending", "runs", "what it means"], &rows))
        @if rollouts.success.is_some() {
            p.quiet {
                "A run reaches the target when it ends within " (number(rollouts.reached_within_cm, 0))
                " cm of it without a crash, even if it timed out there."
            }
        }
        (chart("runs", &drawn_paths(subject, shown), &headline(rollouts), html! {
            "All paths from the start. "
            @if shown.len() < rollouts.runs.len() {
                (shown.len()) " of " (rollouts.runs.len()) " runs, evenly spread, are drawn."
            }
        }))
    }
}

fn drawn_paths(subject: &Subject, shown: &[usize]) -> Figure {
    let Subject { rollouts, scene, start, .. } = subject;
    let ended = |(how, _): (Termination, &str)| Ending {
        name: how.to_string(),
        runs: shown
            .iter()
            .filter(|run| rollouts.runs[**run].termination == how)
            .map(|run| (run + 1, simulated(&rollouts.runs[*run])))
            .collect(),
    };
    endings(scene, scene.starts[start - 1], rollouts.reached_within_cm, &ENDINGS.map(ended))
}

fn tuples(subject: &Subject, shown: &[usize]) -> Markup {
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
        p.quiet { "The step is the median over the runs that reach the tuple; the last column counts those runs." }
        (chart("turns", &drawn_tuples(rollouts, shown), "Which tuple each run holds, step by step", html! {
            "Which tuple each run holds, step by step: one row per run."
        }))
    }
}

fn drawn_tuples(rollouts: &RolloutReport, shown: &[usize]) -> Figure {
    let rows: Vec<Row> =
        shown.iter().map(|run| Row { name: (run + 1).to_string(), segments: held(&rollouts.runs[*run]) }).collect();
    let most = rows.iter().flat_map(|row| &row.segments).map(|held| held.to).fold(0.0, f64::max);
    // The darkest colours of the scale are lost on a dark page.
    let kind = |tuple: usize| (format!("tuple {}", tuple + 1), Colour::viridis(0.25 + 0.14 * tuple as f64));
    let kinds = (0..TUPLES).map(kind).collect();
    SegmentChart { axis: "step".into(), range: 0.0..most, names_px: 32.0, row_px: 16.0, kinds, rows }.draw()
}

/// The tuples of a run one after the other, in steps.
fn held(rollout: &Rollout) -> Vec<Segment> {
    let mut from = 0;
    // At its last point a run is over.
    let driven = rollout.path.split_last().map_or(&[][..], |(_, driven)| driven);
    let turns = driven.chunk_by(|a, b| a.tuple == b.tuple).map(|points| {
        let (tuple, to) = (points[0].tuple, from + points.len());
        let title = format!("tuple {tuple}, steps {from} to {to}");
        let segment = Segment { from: from as f64, to: to as f64, kind: tuple - 1, title };
        from = to;
        segment
    });
    turns.filter(|segment| segment.kind < TUPLES).collect()
}

fn replay(subject: &Subject, shown: &[usize]) -> Replay {
    let Subject { rollouts, controller, robot, scene, .. } = subject;
    let places = rollouts.runs.iter().flat_map(|run| run.path.iter().map(|p| DVec2::new(p.x_cm, p.y_cm)));
    let room = Room::new(scene, rollouts.reached_within_cm, places);
    let run = |place: &usize| {
        let rollout = &rollouts.runs[*place];
        let moment = |p: &PathPoint| Moment {
            pose: Some(Pose::new(p.x_cm, p.y_cm, p.heading_deg.to_radians())),
            echo_cm: p.echo_cm.map(f64::from),
        };
        let remark = |p: &PathPoint| match controller.tuples.get(p.tuple - 1) {
            Some(tuple) => {
                let [left, right] = [tuple.left, tuple.right].map(|command| number(f64::from(command), 0));
                format!("tuple {}: commands {left}, {right}", p.tuple)
            }
            None => "finished".into(),
        };
        ReplayedRun {
            name: format!("run {}: {}", place + 1, rollout.termination),
            t_s: (0..rollout.path.len()).map(|step| step as f64 * f64::from(controller.step_ms) / 1000.0).collect(),
            remarks: rollout.path.iter().map(remark).collect(),
            tracks: BTreeMap::from([(DRIVEN.id, rollout.path.iter().map(moment).collect::<Vec<_>>().into())]),
        }
    };
    Replay::new(robot, room, vec![DRIVEN], shown.iter().map(run).collect(), rollouts.runs.len())
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
