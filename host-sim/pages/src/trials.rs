//! The page of a loop: the predicted and driven paths of each controller, and what each run taught the simulator.

mod reasons;

use maud::{Markup, html};

use super::document::{Document, Section, chart, open_table};
use super::words::{self, number, percent, percent_within};
use mindgap_applications::adapt::{Cause, Gap};
use mindgap_applications::closed_loop::drawing;
use mindgap_applications::closed_loop::state::{State, Trial, Verdict};
use mindgap_figures::report::curves::{Curve, CurveChart, Point};
use mindgap_figures::report::{self, Figure};
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evolve::success_probability::SuccessProbability;
use mindgap_logs::Scene;
use mindgap_models::effects::CATALOGUE;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::parameter::Setting;

/// The contents of a page.
pub struct Subject<'a> {
    /// What happened.
    pub state: &'a State,
    /// In this scene.
    pub scene: &'a Scene,
    /// Files of simulator and scene.
    pub names: [&'a str; 2],
    /// Start within the scene, from 1.
    pub start: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// Errors of a channel's steps: number of the trial, before and after it.
struct Gaps {
    name: &'static str,
    unit: &'static str,
    rows: Vec<(usize, [f64; 2])>,
}

/// A channel, its unit, and the errors of its steps before and after.
type Channel = (&'static str, &'static str, fn(&Gap) -> [f64; 2]);

const CHANNELS: [Channel; 3] = [
    ("forward motion", "cm", |gap| gap.forward_cm),
    ("sideways motion", "cm", |gap| gap.lateral_cm),
    ("turn", "degrees", |gap| gap.turn_deg),
];
/// Most maps per page.
const MOST_MAPS: usize = 24;

/// How to read a map.
pub const LINES: &str = "Dashed lines are the simulated paths, solid ones the robot's. Where they part, the simulator lacks \
                         something.";
const TURNS_HEADER: [&str; 5] =
    ["trial", "chance before (95 % of robots)", "on the robot", "chance after", "effects found"];

/// Returns the page, whole in one file.
pub fn page(subject: &Subject) -> String {
    let Subject { state, scene, names: [sim, room], start, .. } = subject;
    let mut sections = sections(state, scene, scene.starts[start - 1]);
    sections.push(Section { id: "next", title: "What to do next", body: next(state) });
    sections.push(Section { id: "compared", title: "What was run", body: source(subject) });
    Document {
        kind: "Loop on the robot",
        headline: &headline(state),
        subject: &format!("{sim}, {room}, start {start}"),
        lead: html! { p { (lead(state)) } },
        sections,
        script: None,
    }
    .html()
}

/// Returns the parts of a page about a loop from a start in a scene.
pub fn sections(state: &State, scene: &Scene, start: Pose) -> Vec<Section> {
    let trials = &state.trials;
    let gaps = gaps(trials);
    let mut sections = vec![Section { id: "turns", title: "Turn by turn", body: turns(state) }];
    if !trials.is_empty() {
        sections.push(Section { id: "paths", title: "Expected and driven", body: maps(trials, scene, start) });
    }
    if !gaps.is_empty() {
        sections.push(Section { id: "gap", title: "How far the simulator was off", body: off(&gaps) });
    }
    sections.push(Section { id: "effects", title: "What the runs say about the robot", body: effects(trials) });
    sections
}

/// All trials, or the first and the last ones.
fn shown(count: usize) -> Vec<usize> {
    let half = MOST_MAPS / 2;
    (0..count).filter(|place| count <= MOST_MAPS || *place < half || *place >= count - half).collect()
}

fn headline(state: &State) -> String {
    let runs = state.trials.iter().filter(|trial| trial.real.is_some()).count();
    let chance =
        state.chance.map_or_else(|| "an unknown chance".into(), |c| format!("a chance of {}", percent(c.success)));
    let after = match runs {
        1 => "after one run on the robot".into(),
        runs => format!("after {runs} runs on the robot"),
    };
    match state.verdict {
        Verdict::Works => {
            format!("The controller works {after}: it reached the target three times, and has {chance} in simulation.")
        }
        Verdict::TrialsExhausted if state.limit().is_some() => format!(
            "No controller was found that reaches the target often enough; {after} the best has {chance}, limited by noise alone."
        ),
        Verdict::TrialsExhausted => format!("No controller is confirmed {after}; the best has {chance}."),
        Verdict::Infeasible => "No controller was found that reaches the target on any possible robot.".into(),
        Verdict::Running => format!("The loop is under way {after}."),
    }
}

fn lead(state: &State) -> String {
    let reached = state.trials.iter().filter(|trial| trial.real.as_ref().is_some_and(|real| real.reached)).count();
    let driven = state.trials.iter().filter(|trial| trial.real.is_some()).count();
    let reached = if driven == 0 {
        String::new()
    } else {
        format!(" The robot reached the target in {reached} of {driven} runs.")
    };
    "Each turn evolves a controller in the simulator, drives it once on the robot, and lets the simulator learn from that \
     run."
    .to_owned()
        + &reached
}

fn turns(state: &State) -> Markup {
    let rows: Vec<[String; 5]> = state.trials.iter().map(row).collect();
    html! {
        @if rows.is_empty() {
            p { "No controller was driven." }
        } @else {
            (chart("chances", &success_probabilities(&state.trials), "Chance of each trial's controller before and after it was driven", html! {
                "The chance of success that the simulator predicts for each controller before it is driven, and after the run, "
                "with the range over 95 % of the possible robots. On top: ✓ the robot reached the target, ✗ it missed it. A wide "
                "range means that the robot is not known well enough."
            }))
            (open_table(TURNS_HEADER, &rows))
            @let reasons: Vec<(usize, String)> =
                state.trials.iter().filter_map(|trial| Some((trial.number, reasons::reason(trial)?))).collect();
            @if !reasons.is_empty() {
                h3 #why { "Why the chances changed" }
                ul { @for (trial, reason) in &reasons { li { "Trial " (trial) ": " (reason) } } }
            }
        }
        @if !state.failures.is_empty() {
            h3 { "Drives without a usable log" }
            ul { @for failure in &state.failures { li { "Trial " (failure.trial) ": " (failure.reason) } } }
        }
    }
}

fn row(trial: &Trial) -> [String; 5] {
    let chance = |chance: &SuccessProbability| percent_within(chance.success, chance.ci95);
    let real = trial.real.as_ref().map_or_else(
        || "not driven".into(),
        |real| {
            let how = if real.reached { "reached the target" } else { "missed it" };
            format!("{how}: {} after {} steps, {} cm off", real.ending, real.steps, number(real.distance_cm, 0))
        },
    );
    let names: Vec<String> = trial.effects.iter().map(|effect| found(effect, &trial.causes)).collect();
    [
        trial.number.to_string(),
        chance(&trial.predicted),
        real,
        trial.chance_after.as_ref().map_or_else(|| "–".into(), chance),
        if names.is_empty() {
            "–".into()
        } else {
            words::list(&names.iter().map(String::as_str).collect::<Vec<_>>())
        },
    ]
}

/// The name of an effect that was added, with its probability.
fn found(effect: &AppliedEffect, causes: &[Cause]) -> String {
    let name = words::name(&effect.effect, CATALOGUE);
    let cause = causes.iter().find(|cause| cause.id == effect.effect);
    cause.map_or_else(|| name.into(), |cause| format!("{name} ({})", percent(cause.probability)))
}

fn success_probabilities(trials: &[Trial]) -> Figure {
    let point = |trial: &Trial, chance: &SuccessProbability| Point {
        interval: chance.ci95.map(|end| 100.0 * end),
        ..Point::new(trial.number as f64, 100.0 * chance.success)
    };
    let after = |trial: &Trial| Some(point(trial, trial.chance_after.as_ref()?));
    let curves = vec![
        Curve { name: "before the run".into(), points: trials.iter().map(|t| point(t, &t.predicted)).collect() },
        Curve { name: "after the run".into(), points: trials.iter().filter_map(after).collect() },
    ];
    let remark = |trial: &Trial| {
        let mark = if trial.real.as_ref()?.reached { "✓" } else { "✗" };
        Some((trial.number as f64, mark.into()))
    };
    CurveChart {
        y_name: "chance of reaching the target (%)".into(),
        y_range: Some(0.0..100.0),
        apart: true,
        remarks: trials.iter().filter_map(remark).collect(),
        ..along_trials(trials.iter().map(|trial| trial.number), curves)
    }
    .draw()
}

/// A chart with trials along it.
fn along_trials(trials: impl Iterator<Item = usize>, curves: Vec<Curve>) -> CurveChart {
    CurveChart { x_name: "trial".into(), counts: trials.collect(), curves, ..CurveChart::default() }
}

fn maps(trials: &[Trial], scene: &Scene, start: Pose) -> Markup {
    let shown = shown(trials.len());
    html! {
        p { (LINES) }
        @if shown.len() < trials.len() {
            p.quiet { "The first and the last " (MOST_MAPS / 2) " of " (trials.len()) " trials." }
        }
        div.pairs {
            @for place in &shown {
                @let [trial, before, real, ..] = row(&trials[*place]);
                @let drawn = report::paths(&[drawing::panel(&trials[*place], scene, start)]);
                (chart("map", &drawn, &format!("Trial {trial}: expected paths and the robot's"), html! {
                    "Trial " (trial) ", expected " (before) ": " (real) "."
                }))
            }
        }
    }
}

/// Errors of each channel's steps; empty before two runs can be compared with each other.
fn gaps(trials: &[Trial]) -> Vec<Gaps> {
    let of_channel = |(name, unit, of): &Channel| {
        let row = |trial: &Trial| Some((trial.number, of(trial.gap.as_ref()?)));
        Gaps { name, unit, rows: trials.iter().filter_map(row).collect() }
    };
    CHANNELS.iter().map(of_channel).filter(|gaps| !gaps.rows.is_empty()).collect()
}

fn off(gaps: &[Gaps]) -> Markup {
    html! {
        p { "The error of a simulated step (root mean square) on runs that the simulator had not learned from, before and "
        "after it learned from the others. The error that remains is scatter, which no simulator predicts." }
        div.pairs {
            @for Gaps { name, unit, rows } in gaps {
                @let (trial, [before, after]) = rows[rows.len() - 1];
                (chart("gaps", &errors(unit, rows), &format!("Error of a step in {name}, before and after learning"), html! {
                    (name) ": after trial " (trial) " the error of a step is " (number(after, 2)) " " (unit) " instead of "
                    (number(before, 2)) "."
                }))
            }
        }
    }
}

fn errors(unit: &str, rows: &[(usize, [f64; 2])]) -> Figure {
    let curve = |name: &str, of: usize| Curve {
        name: name.into(),
        points: rows.iter().map(|(trial, ends)| Point::new(*trial as f64, ends[of])).collect(),
    };
    let curves = vec![curve("before learning", 0), curve("after learning", 1)];
    let y_name = format!("error of a step ({unit})");
    CurveChart { y_name, ..along_trials(rows.iter().map(|(trial, _)| *trial), curves) }.draw()
}

/// The effects found in all runs together.
fn effects(trials: &[Trial]) -> Markup {
    let last = trials.iter().rfind(|trial| trial.chance_after.is_some());
    html! {
        @match last.map(|trial| trial.effects.as_slice()) {
            None => p { "No run says anything about the robot yet." },
            Some([]) => p {
                "No named effect is in the runs. Where the robot differs from the simulator, command by command, the difference is "
                "learned as a bias with its own uncertainty."
            },
            Some(found) => @for effect in found { (card(effect, last.map_or(&[], |trial| &trial.causes))) },
        }
        @for unused in last.iter().flat_map(|trial| &trial.causes).filter(|cause| !cause.used) {
            p.quiet {
                "The diagnosis also named " (words::name(&unused.id, CATALOGUE)) " (" (percent(unused.probability)) "). It is not "
                "used: biases of single commands predict the runs better."
            }
        }
    }
}

fn rounded(setting: Setting) -> String {
    match setting {
        Setting::Number(value) => number(value, 3),
        Setting::Side(_) | Setting::ActsOn(_) => setting.to_string(),
    }
}

fn card(applied: &AppliedEffect, causes: &[Cause]) -> Markup {
    let cause = causes.iter().find(|cause| cause.id == applied.effect);
    let known = words::cause(&applied.effect, CATALOGUE);
    let values: Vec<String> =
        applied.parameters.iter().map(|(name, setting)| format!("{name} {}", rounded(*setting))).collect();
    html! {
        article.card aria-labelledby={ "effect-" (applied.effect) } {
            h3 #{ "effect-" (applied.effect) } {
                (words::name(&applied.effect, CATALOGUE)) " " small.quiet { code { (applied.effect) } }
            }
            dl {
                @if let Some(cause) = known { dt { "What it is" } dd { (cause.what) } }
                @if let Some(cause) = cause { dt { "How probable" } dd { (percent(cause.probability)) ". " (rivals(cause)) } }
                dt { "How strong" } dd { (words::list(&values.iter().map(String::as_str).collect::<Vec<_>>())) }
                @if let Some(cause) = known { dt { "How to check" } dd { (cause.check) } }
            }
        }
    }
}

fn rivals(cause: &Cause) -> String {
    let names: Vec<&str> = cause.ambiguous_with.iter().map(|id| words::name(id, CATALOGUE)).collect();
    match names.is_empty() {
        true => "No other effect explains these runs as well.".into(),
        false => format!("These runs cannot distinguish it from {}.", words::list(&names)),
    }
}

fn next(state: &State) -> Markup {
    let named = state.trials.last().is_some_and(|trial| !trial.effects.is_empty());
    html! {
        ol {
            @match state.verdict {
                Verdict::Works => li {
                    "Make a program of the controller: " code { "mindgap export controller.toml --format nxc --out drive.nxc" } "."
                },
                Verdict::TrialsExhausted => @match state.limit() {
                    Some(success) => li {
                        "Make it easier: a start nearer to the target, or a wider way. Even with a perfectly known robot, the best "
                        "of these controllers would reach the target in " (percent(success)) " of its runs: more trials will hardly help."
                    },
                    None => li {
                        "The same call with more " code { "--trials" } " continues from here: each run reduces the uncertainty about "
                        "the robot."
                    },
                },
                Verdict::Infeasible => li {
                    "Make it easier: a start nearer to the target, or more " code { "--max-steps" } ". If even that fails, "
                    "log the robot while it drives at random, and train the simulator again."
                },
                Verdict::Running => li { "The same call continues from here." },
            }
            @if named {
                li { "Check on the robot what " a href="#effects" { "its runs say" } ": a repaired robot needs no learning." }
            }
        }
    }
}

fn source(subject: &Subject) -> Markup {
    let Subject { state, names: [sim, scene], start, seed, .. } = subject;
    html! {
        dl {
            dt { "Simulator before the loop" } dd { (sim) }
            dt { "Scene" } dd { (scene) ", start " (start) }
            dt { "Trials" } dd { (state.trials.len()) ", seed " (seed) }
            dt { "In the loop's folder" }
            dd {
                code { "controller.toml" } ", " code { "simulator.json" } " after all runs, a log and a controller "
                "for each trial, and all figures of this page in " code { "loop.json" }
            }
        }
    }
}
