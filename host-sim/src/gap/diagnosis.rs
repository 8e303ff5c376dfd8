//! The diagnosis as it is written and read.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::admission;
use super::calibration::Calibration;
use super::channel::Channel;
use super::confirmation;
use super::contexts::{self, Part};
use super::excitation::untestable;
use super::experiment::{self, Experiment};
use super::explanation::{Explanation, Signs};
use super::search::{Fitted, Given};
use super::shape::{self, Bin, Shape};
use super::shrink;
use super::verdict::Verdict;
use crate::effects::applied::AppliedEffect;
use crate::evaluation::final_position::FinalPositions;
use crate::evaluation::observations::Observations;
use crate::evaluation::paths::{self, PathGap};
use crate::logs::Logs;
use crate::problem::Result;
use crate::simulator::Simulator;
use crate::simulator::baseline::Baseline;

/// What `mindgap diagnose --json` writes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// Version of this form.
    pub schema: u32,
    /// The answer in one word.
    pub verdict: Verdict,
    /// The effects, most certain first; empty unless the verdict is known.
    pub effects: Vec<EffectFound>,
    /// Where the gap lies.
    pub r#where: Vec<Place>,
    /// How far it shrinks; null where there is no gap to shrink.
    pub shrink: Option<Shrink>,
    /// Where a controller's runs end; null unless the logs are said to be those of a controller.
    pub endings: Option<FinalPositions>,
    /// What to log next to tell more.
    pub next_experiment: Option<String>,
    /// How the unexplained part follows circumstances, channel by channel.
    pub unexplained: Vec<Unexplained>,
    /// Effects that these logs could not show: untestable, not absent.
    pub untestable: Vec<String>,
    /// What else limits this diagnosis.
    pub notes: Vec<String>,
}

/// How the unexplained part of a channel follows the circumstance on which it depends most.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unexplained {
    /// The channel.
    pub channel: Channel,
    /// The circumstance.
    pub depends_on: String,
    /// The unit of what is off.
    pub unit: String,
    /// A table from low to high.
    pub shape: Vec<ShapeBin>,
}

/// A range of the circumstance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShapeBin {
    /// Least value.
    pub from: f64,
    /// Largest value.
    pub to: f64,
    /// Logged minus predicted, mean.
    pub off: f64,
    /// Standard error of that.
    pub error: f64,
}

/// An effect that explains the gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectFound {
    /// Its name.
    pub id: String,
    /// How certain it is.
    pub probability: f64,
    /// How strong it is.
    pub parameters: Map<String, Value>,
    /// Effects that these logs cannot tell from it.
    pub ambiguous_with: Vec<String>,
}

/// A part of the gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// What is off.
    pub channel: Channel,
    /// Under which circumstances.
    pub context: String,
    /// How far, nats a step.
    pub gap: f64,
    /// 95 % interval of it.
    pub ci95: [f64; 2],
    /// Which share of the channel's gap this is.
    pub share: f64,
}

/// How far the gap shrinks, nats a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shrink {
    /// The gap of the simulator as it is.
    pub before: f64,
    /// With the effects added.
    pub after: f64,
    /// What cannot be reduced by anything that follows circumstances.
    pub floor: f64,
    /// The share of the reducible gap that is closed.
    pub reducible_closed: f64,
    /// 95 % interval of it.
    pub ci95: [f64; 2],
    /// What comes next.
    pub runner_up: Option<RunnerUp>,
    /// The same channel by channel, where there is something to close.
    pub channels: Vec<ChannelShrink>,
    /// Paths that the simulator drives open-loop from a logged pose.
    pub paths: Vec<PathShrink>,
}

/// How far the gap of a channel shrinks, nats a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelShrink {
    /// The channel.
    pub channel: Channel,
    /// The gap of the simulator as it is.
    pub before: f64,
    /// With the effects added.
    pub after: f64,
    /// The share of the reducible gap that is closed.
    pub reducible_closed: f64,
    /// 95 % interval of it.
    pub ci95: [f64; 2],
}

/// Median distance between the ends of predicted and logged paths, cm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathShrink {
    /// Length of the paths.
    pub steps: usize,
    /// With the simulator as it is.
    pub before_cm: f64,
    /// With the effects added.
    pub after_cm: f64,
    /// What scatter alone makes of it.
    pub floor_cm: f64,
}

/// The next best explanation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunnerUp {
    /// Its effect, or effects.
    pub id: String,
    /// The share of the reducible gap that it closes.
    pub reducible_closed: f64,
}

/// A diagnosis, and what came of it beside the words.
pub struct Findings {
    /// What is written and told.
    pub diagnosis: Diagnosis,
    /// What to drive next.
    pub experiment: Option<Experiment>,
    /// The effects that explain the gap, as a simulator takes them; none unless the verdict is known.
    pub added: Vec<AppliedEffect>,
}

/// Diagnoses logs.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn diagnose(baseline: Baseline, logs: &Logs) -> Result<Diagnosis> {
    Ok(findings(baseline, logs)?.diagnosis)
}

/// Diagnoses logs and proposes what to drive next.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn findings(mut baseline: Baseline, logs: &Logs) -> Result<Findings> {
    let (evidence, kept_back, notes) = admitted(&mut baseline, logs)?;
    let given = Given::new(&baseline, &evidence, Calibration::shipped());
    let explanation = explain(&given, kept_back.as_ref());
    let verdict = explanation.verdict();
    let effects = if verdict == Verdict::Known { effects(&explanation, logs.robot.step_ms) } else { Vec::new() };
    let shrink = if verdict == Verdict::NoGap { None } else { shrunk(&explanation, &given, kept_back.as_ref()) };
    let experiment = if verdict == Verdict::Known { experiment::next(&explanation, &given) } else { None };
    let added = if verdict == Verdict::Known { explanation.chosen.added() } else { Vec::new() };
    let diagnosis = Diagnosis {
        schema: 1,
        verdict,
        effects,
        r#where: contexts::parts(&explanation, &evidence).into_iter().map(Place::from).collect(),
        shrink,
        endings: None,
        next_experiment: experiment.as_ref().map(in_words),
        unexplained: unexplained(&explanation, &given),
        untestable: untestable(&explanation.none, &given).into_iter().map(String::from).collect(),
        notes,
    };
    Ok(Findings { diagnosis, experiment, added })
}

/// The share of the reducible gap that effects close on logs, as they are, without a search; none where there is no gap.
///
/// # Errors
/// When the logs say nothing that the simulator could be compared with.
pub fn closed(simulator: &Simulator, added: &[AppliedEffect], logs: &Logs) -> Result<Option<f64>> {
    let mut baseline = Baseline::learned(simulator)?;
    let (evidence, kept_back, _) = admitted(&mut baseline, logs)?;
    let given = Given::new(&baseline, &evidence, Calibration::shipped());
    let shrink = shrink::shrink(&Explanation::by(added, &given), &given, kept_back.as_ref().unwrap_or(&evidence));
    Ok(shrink.map(|shrink| shrink.whole.closed))
}

/// The first signs of a gap in logs.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn first_signs(mut baseline: Baseline, logs: &Logs) -> Result<Signs> {
    let (evidence, ..) = admitted(&mut baseline, logs)?;
    Ok(Signs::of(&Given::new(&baseline, &evidence, Calibration::shipped())))
}

/// What explains logs by given thresholds.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn explained(mut baseline: Baseline, logs: &Logs, calibration: Calibration) -> Result<Explanation> {
    let (evidence, kept_back, _) = admitted(&mut baseline, logs)?;
    Ok(explain(&Given::new(&baseline, &evidence, calibration), kept_back.as_ref()))
}

/// What explains the gap and holds on the runs kept back.
fn explain(given: &Given, kept_back: Option<&Observations>) -> Explanation {
    let explanation = Explanation::find(given);
    match kept_back {
        Some(kept_back) => explanation.confirmed(given, kept_back),
        None => explanation,
    }
}

/// The evidence to seek effects on, that which is kept back, and what has to be said about it.
fn admitted(baseline: &mut Baseline, logs: &Logs) -> Result<(Observations, Option<Observations>, Vec<String>)> {
    let fan_width = baseline.sonar.as_ref().map_or(1.0, |sonar| sonar.fan_width);
    let parts = confirmation::parts(logs);
    let evidence = Observations::of(&parts.found_on, fan_width);
    let notes = admission::admit(baseline, &evidence, logs)?;
    let kept_back = parts.kept_back.map(|logs| Observations::of(&logs, fan_width));
    Ok((evidence.expect(baseline.motion.as_ref()), kept_back, notes))
}

fn in_words(experiment: &Experiment) -> String {
    let [one, other] = experiment.between;
    let Experiment { script, runs, nats_a_run, .. } = experiment;
    format!("To tell {one} from {other}: log {runs} run(s) of {script} (about {nats_a_run:.1} nats a run).")
}

/// Only an unknown cause is described by its shape.
fn unexplained(explanation: &Explanation, given: &Given) -> Vec<Unexplained> {
    if explanation.verdict() != Verdict::Unknown {
        return Vec::new();
    }
    let shapes = shape::shapes(explanation, given.baseline, given.evidence);
    shapes.into_iter().map(Unexplained::from).collect()
}

/// How far the gap shrinks on runs kept back, or on the others where none is.
fn shrunk(explanation: &Explanation, found: &Given, kept_back: Option<&Observations>) -> Option<Shrink> {
    let confirming = kept_back.unwrap_or(found.evidence);
    let shrink = shrink::shrink(explanation, found, confirming)?;
    let [before, after] = [&explanation.none, &explanation.chosen].map(Fitted::effects);
    let paths =
        found.baseline.motion.as_ref().map_or_else(Vec::new, |d| paths::open_loop(&before, &after, d, confirming));
    let channel = |(channel, part): (Channel, shrink::Part)| ChannelShrink {
        channel,
        before: rounded(part.before),
        after: rounded(part.after),
        reducible_closed: rounded(part.closed),
        ci95: part.ci95.map(rounded),
    };
    let runner_up = |(ids, closed): (Vec<&str>, f64)| RunnerUp { id: ids.join("+"), reducible_closed: rounded(closed) };
    Some(Shrink {
        before: rounded(shrink.whole.before),
        after: rounded(shrink.whole.after),
        floor: 0.0,
        reducible_closed: rounded(shrink.whole.closed),
        ci95: shrink.whole.ci95.map(rounded),
        runner_up: shrink.runner_up.map(runner_up),
        channels: shrink.channels.into_iter().map(channel).collect(),
        paths: paths.into_iter().map(PathShrink::from).collect(),
    })
}

fn effects(explanation: &Explanation, step_ms: f64) -> Vec<EffectFound> {
    let chosen = &explanation.chosen;
    let found = |named: super::verdict::Named| {
        let place = chosen.ids().iter().position(|id| *id == named.id).unwrap_or(0);
        let reported = (chosen.hypothesis.forms[place].report)(chosen.values_of(place), step_ms);
        EffectFound {
            id: named.id.into(),
            probability: rounded(named.probability),
            parameters: reported.into_iter().map(|(name, value)| (name.into(), value)).collect(),
            ambiguous_with: named.ambiguous_with.into_iter().map(String::from).collect(),
        }
    };
    explanation.named().into_iter().map(found).collect()
}

impl From<Part> for Place {
    fn from(p: Part) -> Self {
        let Part { channel, context, gap, ci95, share } = p;
        let context = context.into();
        Place { channel, context, gap: rounded(gap), ci95: ci95.map(rounded), share: rounded(share) }
    }
}

impl From<Shape> for Unexplained {
    fn from(s: Shape) -> Self {
        let bin = |b: Bin| {
            let [from, to, off, error] = [b.from, b.to, b.off, b.error].map(rounded);
            ShapeBin { from, to, off, error }
        };
        let (depends_on, unit) = (s.depends_on.into(), s.unit.into());
        Unexplained { channel: s.channel, depends_on, unit, shape: s.bins.into_iter().map(bin).collect() }
    }
}

impl From<PathGap> for PathShrink {
    fn from(p: PathGap) -> Self {
        let [before_cm, after_cm, floor_cm] = [p.before_cm, p.after_cm, p.floor_cm].map(rounded);
        PathShrink { steps: p.steps, before_cm, after_cm, floor_cm }
    }
}

/// Four decimals.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
