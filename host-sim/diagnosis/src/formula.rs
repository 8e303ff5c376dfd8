//! What no named effect explains, as a formula: a sparse sum of simple terms in the circumstances of a step, which holds on
//! runs that it was not sought on.
//!
//! A formula becomes an [own effect](mindgap_models::effects::own), fitted together with the effects beneath it and judged as they
//! are; so it can be written as a file, competes with other hypotheses, and shrinks a gap whose cause has no name. It is
//! sought step by step: ways between distant poses, which several steps make, are left out of the search.

mod library;
mod pursuit;

use serde::Serialize;

use super::channel::Channel;
use super::compare::Comparison;
use super::fit::{FitContext, Fitted};
use super::gain::Gain;
use library::Term;
use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_foundations::statistics::summary::{QUARTILE, median};
use mindgap_foundations::statistics::{bootstrap, rounding};
use mindgap_learning::evaluation::observations::{FEWEST_BLOCKS, Observation, Observations};
use mindgap_learning::evaluation::predictions::{facing, increment, residual};
use mindgap_models::effects::own::definition::{Change, Definition, ParameterDefinition};
use mindgap_models::effects::own::variables::{Circumstances, Stage};
use mindgap_models::effects::{Candidate, own};
use pursuit::{Response, Sum, pursue};

/// A formula that holds.
pub struct Formula {
    /// The channel that it explains.
    pub channel: Channel,
    /// What is added to what is predicted, cm or radians a step; its variables are those of docs/own-effects.md.
    pub text: String,
    /// The same as an own effect.
    pub definition: Definition,
    /// The effects beneath it and the formula as the last, fitted together.
    pub fitted: Fitted,
    /// What it gains beyond the effects beneath it on each block of the runs that it was sought on, nats.
    pub gains: Vec<f64>,
    /// The same on the runs held out, where there are any.
    pub gains_held_out: Option<Vec<f64>>,
}

/// A formula as an answer states it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statement {
    /// The channel that it explains.
    pub channel: Channel,
    /// What is added to what is predicted, cm or radians a step.
    pub text: String,
    /// The share of the gap that it explains.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
    /// 95 % interval of that share, by bootstrap over blocks of runs.
    #[serde(serialize_with = "rounding::interval")]
    pub ci95: [f64; 2],
}

/// As many folds as there are blocks of rows at least, so that none is empty.
const FOLDS: usize = FEWEST_BLOCKS;
/// Fewer rows make no formula: ten for each factor that it is chosen from.
const FEWEST_ROWS: usize = 160;
/// A row that is farther off pulls no more than this, in standard deviations: a jump of the tracker or a wrong reading says
/// nothing about a law.
const FARTHEST: f64 = 4.0;
/// A reading that is farther off is of something else, and says nothing about readings.
const FAR_OFF_CM: f64 = 25.0;
/// Channels in which a formula is sought.
const CHANNELS: [Channel; 4] = [Channel::Forward, Channel::Lateral, Channel::Turn, Channel::EchoValue];

/// The formula that gains most of what the chosen effects leave unexplained, if one holds: its gain passes the gate of
/// remainders on runs that it was not fitted on, and the runs held out confirm it.
pub fn search(found: &Comparison, context: &FitContext, hold_out: Option<&Observations>) -> Option<Formula> {
    let left = |channel: &Channel| found.beyond_chosen.iter().any(|r| r.channel() == *channel && r.counts());
    let formulas =
        CHANNELS.into_iter().filter(left).filter_map(|channel| of(channel, &found.chosen, context, hold_out));
    formulas.max_by(|a, b| a.gains.iter().sum::<f64>().total_cmp(&b.gains.iter().sum()))
}

impl Formula {
    /// The share that it explains of what could be gained on the confirming runs, `reducible` nats by block.
    pub fn stated(&self, reducible: &[f64], seed: u64) -> Statement {
        let gains = self.gains_held_out.as_ref().unwrap_or(&self.gains);
        let share = |gain: f64, reducible: f64| (gain > 0.0).then(|| gain / reducible.max(gain));
        Statement {
            channel: self.channel,
            text: self.text.clone(),
            share: share(gains.iter().sum(), reducible.iter().sum()).unwrap_or(0.0),
            ci95: bootstrap::interval(gains, reducible, seed, share),
        }
    }
}

fn of(channel: Channel, beneath: &Fitted, context: &FitContext, hold_out: Option<&Observations>) -> Option<Formula> {
    let rows = rows(channel, beneath, context);
    if rows.len() < FEWEST_ROWS {
        return None;
    }
    let (stage, key) = match channel {
        Channel::Forward => (Stage::Motion, "forward_cm"),
        Channel::Lateral => (Stage::Motion, "lateral_cm"),
        Channel::Turn => (Stage::Motion, "turn_rad"),
        Channel::EchoRate | Channel::EchoValue => (Stage::Reading, "echo_cm"),
    };
    let circumstances: Vec<Circumstances> =
        rows.iter().map(|row| circumstances(stage, beneath, row.0, context)).collect();
    let terms = library::terms(stage, &circumstances);
    let spread = median(rows.iter().map(|row| row.1.abs())) / QUARTILE;
    let least_scatter = match (channel.motion_axis(), &context.baseline.motion) {
        (Some(axis), Some(drive)) => drive.scatter()[axis],
        _ => spread,
    };
    let bound = FARTHEST * f64::max(spread, least_scatter);
    let values: Vec<f64> = rows.iter().map(|row| row.1.clamp(-bound, bound)).collect();
    let folds: Vec<usize> = rows.iter().map(|row| row.0.block % FOLDS).collect();
    let response = Response { values: &values, folds: &folds, least_scatter };
    let sum = pursue(&terms, &response, &context.calibration)?;
    let definition = definition(channel, key, &terms, &sum);
    let effect = own::effect(&definition).ok()?;
    let fitted = beneath.with(Candidate { effect: effect.id, variant: effect.variants.first()? }, context);
    let gains = fitted.gains_over(beneath);
    let is_at_bound = !fitted.at_bound(fitted.ids().len() - 1).is_empty();
    if !Gain::of_free_form(&gains).passes(context.calibration.remainder_nats + sum.price) || is_at_bound {
        return None;
    }
    let judged = |rows: &Observations| {
        let [with, without] = [&fitted, beneath].map(|fit| fit.judged_on(rows, context).total());
        rows.by_block(&with.iter().zip(without).map(|(a, b)| a - b).collect::<Vec<f64>>())
    };
    let gains_held_out = hold_out.map(judged);
    if gains_held_out.as_ref().is_some_and(|g| g.iter().sum::<f64>() < context.calibration.judgement.strong_nats) {
        return None;
    }
    let text = text(&terms, &sum.places, fitted.values_of(fitted.hypothesis.candidates.len() - 1));
    Some(Formula { channel, text, definition, fitted, gains, gains_held_out })
}

/// The rows that say something of a channel, each with what was logged minus what is predicted, cm or radians.
fn rows<'a>(channel: Channel, beneath: &Fitted, context: &FitContext<'a>) -> Vec<(&'a Observation, f64)> {
    let effects = beneath.effects();
    let rows = context.observations.rows.iter();
    match (channel.motion_axis(), &context.baseline.motion, &context.baseline.sonar) {
        (Some(axis), Some(drive), _) => {
            let steps = rows.filter(|row| row.then.is_empty());
            steps.filter_map(|row| Some((row, residual(&effects, drive, row)?[axis]))).collect()
        }
        (None, _, Some(_)) => {
            let off_cm =
                |row: &Observation| facing(&effects, context.observations, row)?.outcomes().off_cm(row.echo_cm);
            let known = rows.filter_map(|row| Some((row, off_cm(row)?)));
            known.filter(|(_, off_cm)| off_cm.abs() < FAR_OFF_CM).collect()
        }
        _ => Vec::new(),
    }
}

fn circumstances<'a>(stage: Stage, beneath: &Fitted, row: &'a Observation, context: &FitContext) -> Circumstances<'a> {
    match &context.baseline.motion {
        Some(drive) if stage == Stage::Motion => {
            Circumstances::of_step(&row.context, increment(&beneath.effects(), drive, row))
        }
        _ => Circumstances::of_row(&row.context, row.echo_cm.unwrap_or(0.0)),
    }
}

/// The own effect that adds a sum of terms to what is predicted.
fn definition(channel: Channel, key: &'static str, terms: &[Term], sum: &Sum) -> Definition {
    let unit = if channel == Channel::Turn { "rad" } else { "cm" };
    let name = |place: usize| format!("k{}", place + 1);
    let parameter = |(place, (term, value)): (usize, (&usize, &f64))| {
        // Ten times what was found and more is beyond doubt.
        let bound = libm::pow(10.0, libm::floor(libm::log10(value.abs())) + 2.0);
        ParameterDefinition {
            name: name(place),
            unit: per(unit, &terms[*term].units),
            nominal: 0.0,
            bounds: [-bound, bound],
            prior_sd: None,
            guesses: vec![three_digits(*value)],
        }
    };
    let added: String = sum
        .places
        .iter()
        .enumerate()
        .map(|(place, term)| format!(" + {} * {}", name(place), terms[*term].text))
        .collect();
    let text = Some(format!("{key}{added}"));
    Definition {
        id: format!("formula_{}", channel.name()),
        description: format!("What no named effect explains of {}.", channel.name()),
        parameters: sum.places.iter().zip(&sum.coefficients).enumerate().map(parameter).collect(),
        change: match channel {
            Channel::Forward => Change { forward_cm: text, ..Change::default() },
            Channel::Lateral => Change { lateral_cm: text, ..Change::default() },
            Channel::Turn => Change { turn_rad: text, ..Change::default() },
            Channel::EchoRate | Channel::EchoValue => Change { echo_cm: text, ..Change::default() },
        },
    }
}

/// A unit divided by those of a term.
fn per(unit: &str, units: &[&str]) -> String {
    let mut below = units.to_vec();
    let shared = below.iter().position(|other| *other == unit);
    let above = shared.map_or(unit, |place| {
        below.remove(place);
        "1"
    });
    match below.as_slice() {
        [] => if shared.is_some() { "" } else { unit }.into(),
        [one] if !one.contains('/') => format!("{above}/{one}"),
        several => format!("{above}/({})", several.join(" ")),
    }
}

/// A sum in words: "-2.8 * abs(turn_rad) + 0.1 * forward_cm".
fn text(terms: &[Term], places: &[usize], coefficients: &[f64]) -> String {
    let mut text = String::new();
    for (place, value) in places.iter().zip(coefficients) {
        let sign = match (text.is_empty(), *value < 0.0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        text += &format!("{sign}{} * {}", three_digits(value.abs()), terms[*place].text);
    }
    text
}

#[cfg(test)]
mod tests;
