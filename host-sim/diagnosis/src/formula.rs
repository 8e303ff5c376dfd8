//! A formula for what no named effect explains: a sparse sum of simple terms in the covariates of a step, confirmed on held-out
//! runs.
//!
//! A formula becomes a [custom effect](mindgap_models::effects::own), fitted together with the other effects and scored as they are. So it
//! can be written to a file, competes with other hypotheses, and closes a gap whose cause has no name. Segments of several steps
//! are left out of the search.

mod library;
mod pursuit;

use schemars::JsonSchema;
use serde::Serialize;

use super::confirm::Confirmed;
use super::explanation::Explanation;
use super::fit::{FitContext, Fitted};
use super::gain::Gain;
use super::sample::HoldOut;
use library::Term;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_foundations::statistics::summary::{QUARTILE, median};
use mindgap_foundations::statistics::{bootstrap, rounding};
use mindgap_learning::evaluation::observations::{FEWEST_BLOCKS, Observation};
use mindgap_learning::evaluation::predictions::{facing, increment, residual};
use mindgap_models::effects::own::definition::{Change, Definition, ParameterDefinition};
use mindgap_models::effects::own::variables::{Circumstances, Stage};
use mindgap_models::effects::{Candidate, own};
use pursuit::{Response, Sum, pursue};

/// A confirmed formula.
pub struct Formula {
    /// The channel that it explains.
    pub channel: Channel,
    /// What it adds to the prediction, cm or rad per step. Its variables are those of docs/reference/own-effects.md.
    pub text: String,
    /// The same as a custom effect.
    pub definition: Definition,
    /// The chosen effects and the formula as the last, fitted together.
    pub fitted: Fitted,
    /// Its cross-validated gain over the chosen effects per block, nats.
    pub gains: Vec<f64>,
    /// Its gain per block on held-out rows, if there are any.
    pub gains_held_out: Option<Vec<f64>>,
}

/// A formula in a diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Statement {
    /// The channel that it explains.
    pub channel: Channel,
    /// What it adds to the prediction, cm or rad per step.
    pub text: String,
    /// Its share of the gap.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
    /// 95 % interval of the share, by bootstrap over blocks.
    #[serde(serialize_with = "rounding::interval")]
    pub ci95: [f64; 2],
}

/// Number of folds: no more than the number of blocks, so that none is empty.
const FOLDS: usize = FEWEST_BLOCKS;
/// Least number of rows: ten for each factor that can be chosen.
const FEWEST_ROWS: usize = 160;
/// Residuals are clipped at this many standard deviations: a jump of the tracker or a wrong reading follows no formula.
const FARTHEST: f64 = 4.0;
/// Readings with larger residuals are echoes of something else and are left out.
const FAR_OFF_CM: f64 = 25.0;
/// Channels that can have a formula.
const CHANNELS: [Channel; 4] = [Channel::Forward, Channel::Lateral, Channel::Turn, Channel::EchoValue];

/// Returns the formula with the largest gain over the chosen effects, if one holds: its cross-validated gain passes the gate of
/// remainders, and held-out rows confirm it.
pub fn search(found: &Confirmed, context: &FitContext, hold_out: Option<&HoldOut>) -> Option<Formula> {
    let is_unexplained = |channel: &Channel| found.beyond_chosen.iter().any(|r| r.channel() == *channel && r.counts());
    let formulas =
        CHANNELS.into_iter().filter(is_unexplained).filter_map(|channel| of(channel, &found.chosen, context, hold_out));
    formulas.max_by(|a, b| a.gains.iter().sum::<f64>().total_cmp(&b.gains.iter().sum()))
}

impl Formula {
    /// States the formula with its share of the gap; `reducible` is the reducible gap per block, in nats.
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

fn of(channel: Channel, underneath: &Fitted, context: &FitContext, hold_out: Option<&HoldOut>) -> Option<Formula> {
    let rows = rows(channel, underneath, context);
    if rows.len() < FEWEST_ROWS {
        return None;
    }
    let (stage, key) = match channel {
        Channel::Forward => (Stage::Motion, "forward_cm"),
        Channel::Lateral => (Stage::Motion, "lateral_cm"),
        Channel::Turn => (Stage::Motion, "turn_rad"),
        _ => (Stage::Reading, "echo_cm"),
    };
    let variables: Vec<Circumstances> = rows.iter().map(|row| variables(stage, underneath, row.0, context)).collect();
    let terms = library::terms(stage, &variables);
    let spread = median(rows.iter().map(|row| row.1.abs())) / QUARTILE;
    let least_noise = match (channel.motion_axis(), &context.baseline().motion) {
        (Some(axis), Some(drive)) => drive.scatter().into_array()[axis],
        _ => spread,
    };
    let bound = FARTHEST * f64::max(spread, least_noise);
    let values: Vec<f64> = rows.iter().map(|row| row.1.clamp(-bound, bound)).collect();
    let folds: Vec<usize> = rows.iter().map(|row| row.0.block % FOLDS).collect();
    let response = Response { values: &values, folds: &folds, least_noise };
    let sum = pursue(&terms, &response, &context.calibration)?;
    let definition = definition(channel, key, &terms, &sum);
    let effect = own::effect(&definition).ok()?;
    let fitted = underneath.with(Candidate { effect: effect.id, variant: effect.variants.first()? }, context);
    let gains = fitted.gains_over(underneath);
    let is_at_bound = !fitted.at_bound(fitted.ids().len() - 1).is_empty();
    if !Gain::of_free_form(&gains).passes(context.calibration.remainder_nats + sum.penalty) || is_at_bound {
        return None;
    }
    let gains_held_out = hold_out.map(|rows| fitted.held_out_gains_over(underneath, rows));
    if gains_held_out.as_ref().is_some_and(|g| g.iter().sum::<f64>() < context.calibration.judgement.strong_nats) {
        return None;
    }
    let text = text(&terms, &sum.terms, fitted.values_of(fitted.hypothesis.candidates.len() - 1));
    Some(Formula { channel, text, definition, fitted, gains, gains_held_out })
}

/// Returns the rows that a channel can use, with logged minus predicted values, cm or rad.
fn rows<'a>(channel: Channel, underneath: &Fitted, context: &FitContext<'a>) -> Vec<(&'a Observation, f64)> {
    let effects = underneath.effects();
    let rows = context.rows.rows.iter();
    match (channel.motion_axis(), &context.baseline().motion, &context.baseline().sonar) {
        (Some(axis), Some(drive), _) => {
            let steps = rows.filter(|row| row.following_steps.is_empty());
            steps.filter_map(|row| Some((row, residual(&effects, drive, row)?[axis]))).collect()
        }
        (None, _, Some(_)) => {
            let residual_cm = |row| facing(&effects, context.rows, row)?.outcomes().off_cm(row.echo_cm);
            let known = rows.filter_map(|row| Some((row, residual_cm(row)?)));
            known.filter(|(_, residual_cm)| residual_cm.abs() < FAR_OFF_CM).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns the variables of a formula at a row.
fn variables<'a>(stage: Stage, underneath: &Fitted, row: &'a Observation, context: &FitContext) -> Circumstances<'a> {
    match &context.baseline().motion {
        Some(drive) if stage == Stage::Motion => {
            Circumstances::of_step(&row.context, increment(&underneath.effects(), drive, row))
        }
        _ => Circumstances::of_row(&row.context, row.echo_cm.unwrap_or(0.0)),
    }
}

/// Returns the custom effect that adds a sum of terms to the prediction.
fn definition(channel: Channel, key: &'static str, terms: &[Term], sum: &Sum) -> Definition {
    let unit = if channel == Channel::Turn { "rad" } else { "cm" };
    let name = |index: usize| format!("k{}", index + 1);
    let parameter = |(index, (term, value)): (usize, (&usize, &f64))| {
        // Ten times the fitted value or more is implausible.
        let bound = libm::pow(10.0, libm::floor(libm::log10(value.abs())) + 2.0);
        ParameterDefinition {
            name: name(index),
            unit: per(unit, &terms[*term].units),
            nominal: 0.0,
            bounds: [-bound, bound],
            prior_sd: None,
            guesses: vec![three_digits(*value)],
        }
    };
    let added: String = sum
        .terms
        .iter()
        .enumerate()
        .map(|(index, term)| format!(" + {} * {}", name(index), terms[*term].text))
        .collect();
    let text = Some(format!("{key}{added}"));
    Definition {
        id: format!("formula_{}", channel.name()),
        description: format!("Unexplained part of {}.", channel.name()),
        parameters: sum.terms.iter().zip(&sum.coefficients).enumerate().map(parameter).collect(),
        change: match channel {
            Channel::Forward => Change { forward_cm: text, ..Change::default() },
            Channel::Lateral => Change { lateral_cm: text, ..Change::default() },
            Channel::Turn => Change { turn_rad: text, ..Change::default() },
            _ => Change { echo_cm: text, ..Change::default() },
        },
    }
}

/// Divides a unit by those of a term.
fn per(unit: &str, units: &[&str]) -> String {
    let mut denominator = units.to_vec();
    let shared = denominator.iter().position(|other| *other == unit);
    let numerator = shared.map_or(unit, |index| {
        denominator.remove(index);
        "1"
    });
    match denominator.as_slice() {
        [] => if shared.is_some() { "" } else { unit }.into(),
        [one] if !one.contains('/') => format!("{numerator}/{one}"),
        several => format!("{numerator}/({})", several.join(" ")),
    }
}

/// Writes a sum as "-2.8 * abs(turn_rad) + 0.1 * forward_cm".
fn text(terms: &[Term], chosen: &[usize], coefficients: &[f64]) -> String {
    let mut text = String::new();
    for (term, value) in chosen.iter().zip(coefficients) {
        let sign = match (text.is_empty(), *value < 0.0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        text += &format!("{sign}{} * {}", three_digits(value.abs()), terms[*term].text);
    }
    text
}

#[cfg(test)]
mod tests;
