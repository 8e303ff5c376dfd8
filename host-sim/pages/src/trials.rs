//! The page of a loop: what was expected of each controller and what the robot did, and what each run taught.

use glam::DVec2;
use maud::{Markup, html};
use serde::Serialize;

use super::document::{Document, Script, Section, chart, open_table};
use super::room::Room;
use super::words::{self, number, percent, percent_within};
use mindgap_applications::adapt::Gap;
use mindgap_applications::closed_loop::state::{State, Trial, Verdict};
use mindgap_foundations::error::Result;
use mindgap_learning::evolve::chance::Chance;
use mindgap_logs::Scene;
use mindgap_models::effects::CATALOGUE;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::simulator::rollout::REACHED_CM;

/// What a page is made of.
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

/// What the charts draw.
#[derive(Serialize)]
pub struct Charts {
    room: Room,
    chances: Vec<Chances>,
    maps: Vec<Map>,
    gaps: Vec<Gaps>,
}

/// Paths that were expected of a controller, and the robot's.
#[derive(Serialize)]
pub struct Map {
    /// In simulation.
    pub expected: Vec<Vec<[f64; 2]>>,
    /// On the robot.
    pub driven: Vec<Vec<[f64; 2]>>,
}

/// The chance of a trial's controller before and after it was driven, with its range; and how it went.
#[derive(Serialize)]
struct Chances {
    trial: usize,
    kind: &'static str,
    chance: f64,
    ci95: [f64; 2],
    reached: Option<bool>,
}

/// What the steps of a channel were off by, trial by trial.
#[derive(Serialize)]
struct Gaps {
    name: &'static str,
    unit: &'static str,
    rows: Vec<GapRow>,
}

#[derive(Serialize)]
struct GapRow {
    trial: usize,
    before: f64,
    after: f64,
}

/// A channel, its unit, and what its steps were off by before and after.
type Channel = (&'static str, &'static str, fn(&Gap) -> [f64; 2]);

const CHANNELS: [Channel; 3] = [
    ("forward motion", "cm", |gap| gap.forward_cm),
    ("sideways motion", "cm", |gap| gap.lateral_cm),
    ("turn", "degrees", |gap| gap.turn_deg),
];
/// As many maps are in a page.
const MOST_MAPS: usize = 24;

/// How maps are read.
pub const LINES: &str = "Thin lines are what was expected, thick ones are the robot; the ring is the target. Where they part, \
                         the simulator did not know something.";
const TURNS_HEADER: [&str; 5] =
    ["trial", "chance before (95 % of robots)", "on the robot", "chance after", "effects found"];

/// The page, whole in one file.
///
/// # Errors
/// When a number in it has no form in JSON.
pub fn page(subject: &Subject) -> Result<String> {
    let Subject { state, scene, names: [sim, room], start, .. } = subject;
    let mut sections = sections(state, 0);
    sections.push(Section { id: "next", title: "What to do next", body: next(state) });
    sections.push(Section { id: "compared", title: "What was run", body: source(subject) });
    Document {
        kind: "Loop on the robot",
        headline: &headline(state),
        subject: &format!("{sim}, {room}, start {start}"),
        lead: html! { p { (lead(state)) } },
        sections,
        scripts: &[Script::Trials],
    }
    .html(&charts(scene, state, Vec::new()))
}

/// What the charts of a loop draw, with maps `before` its own.
pub fn charts(scene: &Scene, state: &State, before: Vec<Map>) -> Charts {
    let trials = &state.trials;
    let maps: Vec<Map> = before.into_iter().chain(shown(trials.len()).into_iter().map(|i| map(&trials[i]))).collect();
    let places = maps.iter().flat_map(|map| map.expected.iter().chain(&map.driven).flatten());
    let room = Room::new(scene, REACHED_CM, places.copied().map(DVec2::from));
    Charts { room, chances: trials.iter().flat_map(chances).collect(), maps, gaps: gaps(trials) }
}

/// The parts of a page that tell of a loop, whose first map has this number.
pub fn sections(state: &State, first_map: usize) -> Vec<Section> {
    let trials = &state.trials;
    let gaps = gaps(trials);
    let mut sections = vec![Section { id: "turns", title: "Turn by turn", body: turns(state) }];
    if !trials.is_empty() {
        sections.push(Section { id: "paths", title: "Expected and driven", body: maps(trials, first_map) });
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
            "No six tuples were found that reach the target often enough; {after} the best has {chance}, and chance limits it."
        ),
        Verdict::TrialsExhausted => format!("No controller is confirmed {after}; the best has {chance}."),
        Verdict::Infeasible => "No controller was found that reaches the target on a robot that is possible.".into(),
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
            (chart("chances", 0, "Chance of each trial's controller before and after it was driven", html! {
                "The chance that the simulator gave each controller before it was driven, and gives it after the run, with "
                "the range of 95 % of the robots that were possible; on top whether the robot reached the target. A wide "
                "range says that the robot is not known well enough."
            }))
            (open_table(TURNS_HEADER, &rows))
        }
        @if !state.failures.is_empty() {
            h3 { "Drives that taught nothing" }
            ul { @for failure in &state.failures { li { "Trial " (failure.trial) ": " (failure.reason) } } }
        }
    }
}

fn row(trial: &Trial) -> [String; 5] {
    let chance = |chance: &Chance| percent_within(chance.success, chance.ci95);
    let real = trial.real.as_ref().map_or_else(
        || "not driven".into(),
        |real| {
            let how = if real.reached { "reached the target" } else { "missed it" };
            format!("{how}: {} after {} steps, {} cm off", real.ending, real.steps, number(real.distance_cm, 0))
        },
    );
    let names: Vec<&str> = trial.effects.iter().map(|effect| words::name(&effect.effect, CATALOGUE)).collect();
    [
        trial.number.to_string(),
        chance(&trial.predicted),
        real,
        trial.chance_after.as_ref().map_or_else(|| "–".into(), chance),
        if names.is_empty() { "–".into() } else { words::list(&names) },
    ]
}

fn chances(trial: &Trial) -> Vec<Chances> {
    let reached = trial.real.as_ref().map(|real| real.reached);
    let of = |kind, chance: &Chance| Chances {
        trial: trial.number,
        kind,
        chance: chance.success,
        ci95: chance.ci95,
        reached,
    };
    let before = of("before the run", &trial.predicted);
    [before].into_iter().chain(trial.chance_after.iter().map(|chance| of("after the run", chance))).collect()
}

fn map(trial: &Trial) -> Map {
    Map {
        expected: trial.predicted_paths.iter().map(|path| path.path_cm.clone()).collect(),
        driven: trial.real.iter().map(|real| real.path_cm.clone()).collect(),
    }
}

fn maps(trials: &[Trial], first_map: usize) -> Markup {
    let shown = shown(trials.len());
    html! {
        p { (LINES) }
        @if shown.len() < trials.len() {
            p.quiet { "The first and the last " (MOST_MAPS / 2) " of " (trials.len()) " trials." }
        }
        div.pairs {
            @for (number, place) in (first_map..).zip(&shown) {
                @let [trial, before, real, ..] = row(&trials[*place]);
                (chart("map", number, &format!("Trial {trial}: expected paths and the robot's"), html! {
                    "Trial " (trial) ", expected " (before) ": " (real) "."
                }))
            }
        }
    }
}

/// Of each channel what its steps were off by; nothing before two runs can be held against each other.
fn gaps(trials: &[Trial]) -> Vec<Gaps> {
    let of_channel = |(name, unit, of): &Channel| {
        let row = |trial: &Trial| {
            let [before, after] = of(trial.gap.as_ref()?);
            Some(GapRow { trial: trial.number, before, after })
        };
        Gaps { name, unit, rows: trials.iter().filter_map(row).collect() }
    };
    CHANNELS.iter().map(of_channel).filter(|gaps| !gaps.rows.is_empty()).collect()
}

fn off(gaps: &[Gaps]) -> Markup {
    html! {
        p { "What a simulated step was off by (root mean square) on runs that the simulator had not learned from, before and "
        "after it learned from the others. What stays is scatter, which no simulator foretells." }
        div.pairs {
            @for (place, Gaps { name, unit, rows }) in gaps.iter().enumerate() {
                @let last = &rows[rows.len() - 1];
                (chart("gaps", place, &format!("What a step was off by in {name}, before and after learning"), html! {
                    (name) ": after trial " (last.trial) " a step is off by " (number(last.after, 2)) " " (unit)
                    " in place of " (number(last.before, 2)) "."
                }))
            }
        }
    }
}

/// The effects that all runs together say of the robot.
fn effects(trials: &[Trial]) -> Markup {
    let last = trials.iter().rfind(|trial| trial.chance_after.is_some());
    html! {
        @match last.map(|trial| trial.effects.as_slice()) {
            None => p { "No run has told anything of the robot yet." },
            Some([]) => p {
                "No named effect is in the runs: what the robot does otherwise than the simulator said, command by command, is "
                "learned as a bias with its own uncertainty."
            },
            Some(found) => @for effect in found { (cause(effect)) },
        }
    }
}

fn cause(applied: &AppliedEffect) -> Markup {
    let known = words::cause(&applied.effect, CATALOGUE);
    let values: Vec<String> =
        applied.parameters.iter().map(|(name, value)| format!("{name} {}", number(*value, 3))).collect();
    html! {
        article.card aria-labelledby={ "effect-" (applied.effect) } {
            h3 #{ "effect-" (applied.effect) } {
                (words::name(&applied.effect, CATALOGUE)) " " small.quiet { code { (applied.effect) } }
            }
            dl {
                @if let Some(cause) = known { dt { "What it is" } dd { (cause.what) } }
                dt { "How strong" } dd { (words::list(&values.iter().map(String::as_str).collect::<Vec<_>>())) }
                @if let Some(cause) = known { dt { "How to check" } dd { (cause.check) } }
            }
        }
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
                        "Make it easier: a start nearer to the target, or a wider way. If all were known of the robot the best of "
                        "these controllers would reach the target in " (percent(success)) " of its runs: more trials will hardly help."
                    },
                    None => li {
                        "The same call with more " code { "--trials" } " goes on from here: each run narrows what is not known of "
                        "the robot."
                    },
                },
                Verdict::Infeasible => li {
                    "Make it easier: a start nearer to the target, or more " code { "--max-steps" } ". Where even that fails, "
                    "log the robot while it drives at random, and train the simulator anew."
                },
                Verdict::Running => li { "The same call goes on from here." },
            }
            @if named {
                li { "Check on the robot what " a href="#effects" { "its runs say" } ": what is mended there needs no learning." }
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
                code { "controller.toml" } ", " code { "simulator.json" } " as it is after all runs, a log and a controller "
                "for each trial, and all that is on this page in " code { "loop.json" }
            }
        }
    }
}
