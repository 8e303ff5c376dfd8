//! What the rest of the two sonar channels follows.

use super::basis::Circumstances;
use super::nearby::Spot;
use super::{Law, ResidualFit, Rows, Steps, Surface};
use crate::channel::Channel;
use crate::fit::{FitContext, Fitted, MOST_ITERATIONS, TOLERANCE_NATS};
use mindgap_foundations::statistics::maximise::{Bounds, climb};
use mindgap_foundations::statistics::summary::{QUARTILE, median};
use mindgap_learning::evaluation::observations::{Observation, Observations};
use mindgap_learning::evaluation::predictions::{Faced, facing};
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::sonar::Perturbation;
use mindgap_models::sonar::model::FAR_CM;

/// How readings spread about where they are predicted, beyond the simulator.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Further scatter, cm.
    scatter_cm: f64,
    /// Chance of a random short reading.
    short: f64,
    /// Chance of a random reading from beyond what the axis meets.
    long: f64,
}

/// What the sensor said at each row, and what it should have.
pub struct Heard<'a> {
    rows: Vec<Reading<'a>>,
}

struct Reading<'a> {
    /// None where the sensor is not judged.
    faced: Option<Faced<'a>>,
    echo_cm: Option<f64>,
    weight: [f64; 2],
}

/// Bounds and start of scatter, short and long: the widest that a beam and a room leave any sense to, and near none.
const BOUNDS: [Bounds; 3] = [Bounds::new(0.0, 10.0), Bounds::new(0.0, 0.5), Bounds::new(0.0, 0.5)];
const START: [f64; 3] = [0.3, 0.002, 0.002];
/// The scatter of what is given in whole centimetres is never less: √(1/12) cm.
const LEAST_SCATTER_CM: f64 = 0.29;
/// The unit of log-odds of the rays' return: what a yes or no tells of them, largest where each of the nine rays comes
/// back once in ten times, is 0.52 a squared log-odds, and about one a squared unit.
const LOG_ODDS: f64 = 1.4;
/// Derivatives are taken over this many of these units: far below one, far above rounding.
const DIFFERENCE: f64 = 0.01;

/// Whether there is an echo.
pub fn rate(beneath: &Fitted, context: &FitContext) -> ResidualFit {
    let heard = Heard::of(&beneath.effects(), context.baseline, context.observations);
    let response = |i: usize, prediction: f64| prediction + heard.rows[i].score(prediction);
    let covariates = covariates(context.observations);
    let rows = Rows::of(&covariates, |i| heard.rows[i].faced.is_some(), place(context.observations));
    let (surface, predictions) = rows.evenly(LOG_ODDS, response);
    let held_out = heard.rates(&predictions);
    fitted(Channel::EchoRate, beneath, held_out, surface, predictions, Law::EchoRate)
}

/// What is read, and how it spreads.
pub fn value(beneath: &Fitted, context: &FitContext) -> ResidualFit {
    let heard = Heard::of(&beneath.effects(), context.baseline, context.observations);
    let (surface, predictions) = heard.offsets(context.observations);
    let terms = |at: &[f64]| heard.values(&predictions, &Spread::from(at));
    let found = climb(&BOUNDS, &START, MOST_ITERATIONS, TOLERANCE_NATS, terms).scored(&BOUNDS, terms);
    let held_out = (0..context.observations.blocks).flat_map(|block| {
        let rows = context.observations.of_block(block);
        let spread = Spread::from(&found.without(&BOUNDS, |row| rows.contains(&row)));
        let value = |i: usize| heard.rows[i].value(predictions[i], &spread);
        rows.map(value).collect::<Vec<f64>>()
    });
    let held_out = held_out.collect();
    fitted(Channel::EchoValue, beneath, held_out, surface, predictions, Law::EchoValue(Spread::from(&found.at)))
}

/// What is read, and no spread beyond the fit beneath.
pub fn moved(beneath: &Fitted, context: &FitContext) -> ResidualFit {
    let heard = Heard::of(&beneath.effects(), context.baseline, context.observations);
    let (surface, predictions) = heard.offsets(context.observations);
    let held_out = heard.values(&predictions, &Spread::NONE);
    fitted(Channel::EchoValue, beneath, held_out, surface, predictions, Law::EchoValue(Spread::NONE))
}

fn fitted(
    channel: Channel,
    beneath: &Fitted,
    held_out: Vec<f64>,
    surface: Surface,
    predictions: Vec<f64>,
    law: Law,
) -> ResidualFit {
    let without = beneath.log_likelihood.channel(channel);
    ResidualFit { channel, held_out, without, own_error: None, surface, predictions, law, effects: beneath.effects() }
}

/// The place of a row: what belongs to a place is judged by others.
fn place(rows: &Observations) -> impl Fn(usize) -> usize {
    |i| rows.rows[i].place
}

/// The covariates of every reading.
pub fn covariates(rows: &Observations) -> Vec<Steps> {
    rows.rows.iter().map(|row| vec![of_reading(&row.context)]).collect()
}

/// Distance and incidence; the commands until the reading; heading; time; and the places of the robot and of what it
/// faces. Whether there was a reading before is no circumstance: what belongs to the place repeats a row later, when the
/// robot is still about there.
fn of_reading(step: &StepContext) -> Circumstances {
    let [distance_cm, incidence_rad] = step.faced.unwrap_or([FAR_CM, 0.0]);
    let distance_cm = distance_cm.min(FAR_CM);
    let [_, [left, right], ..] = step.commands;
    let (position_cm, direction) = (step.pose.position_cm, step.pose.direction());
    let faced_cm = position_cm + direction * distance_cm;
    let covariates = vec![
        distance_cm,
        incidence_rad,
        left,
        right,
        direction.x,
        direction.y,
        step.elapsed_min,
        position_cm.x,
        position_cm.y,
        faced_cm.x,
        faced_cm.y,
    ];
    Circumstances { covariates, spot: step.faced.map(|_| Spot::usual(faced_cm)) }
}

impl<'a> Heard<'a> {
    /// With effects.
    pub fn of(effects: &EffectChain, baseline: &Baseline, observations: &'a Observations) -> Self {
        let judged = baseline.sonar.is_some();
        let reading = |row: &'a Observation| {
            let faced = if judged { facing(effects, observations, row) } else { None };
            let Observation { echo_cm, echo_weight: weight, .. } = *row;
            Reading { faced, echo_cm, weight }
        };
        Heard { rows: observations.rows.iter().map(reading).collect() }
    }

    /// The log-likelihood of an echo or none at each row, the log-odds of every ray moved by the predictions.
    pub fn rates(&self, predictions: &[f64]) -> Vec<f64> {
        let rate = |(reading, prediction): (&Reading, &f64)| {
            let Some(none) = reading.none(*prediction) else { return 0.0 };
            reading.weight[0] * libm::log(if reading.echo_cm.is_some() { 1.0 - none } else { none })
        };
        self.rows.iter().zip(predictions).map(rate).collect()
    }

    /// The log-likelihood of each reading that there is, moved by the predictions and spread.
    pub fn values(&self, predictions: &[f64], spread: &Spread) -> Vec<f64> {
        self.rows.iter().zip(predictions).map(|(reading, cm)| reading.value(*cm, spread)).collect()
    }

    /// By how much readings are off, cm.
    fn offsets(&self, observations: &Observations) -> (Surface, Vec<f64>) {
        let off = |reading: &Reading| reading.faced.as_ref()?.outcomes().off_cm(reading.echo_cm);
        let off: Vec<Option<f64>> = self.rows.iter().map(off).collect();
        let scatter_cm = (median(off.iter().flatten().map(|off_cm| off_cm.abs())) / QUARTILE).max(LEAST_SCATTER_CM);
        // As far as the likelihood says, to which a reading from elsewhere than the echo is one of the others, and no farther
        // than to the reading.
        let response = |i: usize, prediction: f64| {
            let value = |prediction: f64| self.rows[i].value(scatter_cm * prediction, &Spread::NONE);
            let score = (value(prediction + DIFFERENCE) - value(prediction)) / DIFFERENCE;
            let most = (off[i].unwrap_or(0.0) / scatter_cm - prediction).abs();
            prediction + score.clamp(-most, most)
        };
        let covariates = covariates(observations);
        Rows::of(&covariates, |i| off[i].is_some(), place(observations)).evenly(scatter_cm, response)
    }
}

impl Reading<'_> {
    /// The derivative of the log-likelihood of an echo or none by a prediction in units.
    fn score(&self, prediction: f64) -> f64 {
        let nones = [prediction, prediction + DIFFERENCE].map(|units| self.none(LOG_ODDS * units));
        let [Some(none), Some(fewer)] = nones else { return 0.0 };
        let slope = (none - fewer) / DIFFERENCE;
        if self.echo_cm.is_some() { slope / (1.0 - none) } else { -slope / none }
    }

    /// The probability of no reading, the log-odds of every echo moved by a prediction.
    fn none(&self, prediction: f64) -> Option<f64> {
        let faced = self.faced.as_ref()?;
        let change = Perturbation { attenuation: faced.change.attenuation - prediction, ..faced.change };
        Some(faced.perturbed(&change).none)
    }

    /// The log-likelihood of a reading that there is, moved by a prediction and spread.
    fn value(&self, prediction_cm: f64, spread: &Spread) -> f64 {
        let (Some(faced), Some(_)) = (&self.faced, self.echo_cm) else { return 0.0 };
        let mut change = faced.change;
        change.offset_cm += prediction_cm;
        change.scatter_cm += spread.scatter_cm;
        change.p_short = 1.0 - (1.0 - change.p_short) * (1.0 - spread.short);
        change.p_long += spread.long;
        let outcomes = faced.perturbed(&change);
        self.weight[1] * (outcomes.log_likelihood(self.echo_cm) - outcomes.log_detection(self.echo_cm))
    }
}

impl Spread {
    const NONE: Spread = Spread { scatter_cm: 0.0, short: 0.0, long: 0.0 };

    fn from(values: &[f64]) -> Self {
        Spread { scatter_cm: values[0], short: values[1], long: values[2] }
    }
}
