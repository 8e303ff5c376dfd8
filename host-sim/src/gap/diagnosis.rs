//! The diagnosis as it is written and read.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::admission;
use super::baseline::Baseline;
use super::channel::Channel;
use super::contexts::{self, Part};
use super::evidence::Evidence;
use super::excitation::untestable;
use super::explanation::Explanation;
use super::search::Given;
use super::shrink::{self, shrink};
use super::verdict::Verdict;
use crate::logs::Logs;
use crate::problem::Result;

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
    /// What to log next to tell more.
    pub next_experiment: Option<String>,
    /// Effects that these logs could not show: untestable, not absent.
    pub untestable: Vec<String>,
    /// What else limits this diagnosis.
    pub notes: Vec<String>,
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
}

/// The next best explanation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunnerUp {
    /// Its effect, or effects.
    pub id: String,
    /// The share of the reducible gap that it closes.
    pub reducible_closed: f64,
}

/// Diagnoses logs.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn diagnose(mut baseline: Baseline, logs: &Logs) -> Result<Diagnosis> {
    let fan_width = baseline.sonar.as_ref().map_or(1.0, |sonar| sonar.fan_width);
    let evidence = Evidence::of(logs, fan_width);
    let notes = admission::admit(&mut baseline, &evidence, logs)?;
    let given = Given { baseline: &baseline, evidence: &evidence };
    let explanation = Explanation::find(&given);
    let verdict = explanation.verdict();
    let effects = if verdict == Verdict::Known { effects(&explanation, logs.robot.step_ms) } else { Vec::new() };
    let shrink = if verdict == Verdict::NoGap { None } else { shrink(&explanation, evidence.rows.len()) };
    Ok(Diagnosis {
        schema: 1,
        verdict,
        effects,
        r#where: contexts::parts(&explanation, &evidence).into_iter().map(Place::from).collect(),
        shrink: shrink.map(Shrink::from),
        next_experiment: None,
        untestable: untestable(&explanation.none, &given).into_iter().map(String::from).collect(),
        notes,
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

impl From<shrink::Shrink> for Shrink {
    fn from(s: shrink::Shrink) -> Self {
        Shrink {
            before: rounded(s.before),
            after: rounded(s.after),
            floor: 0.0,
            reducible_closed: rounded(s.closed),
            ci95: s.ci95.map(rounded),
            runner_up: s
                .runner_up
                .map(|(ids, closed)| RunnerUp { id: ids.join("+"), reducible_closed: rounded(closed) }),
        }
    }
}

/// Four decimals.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
