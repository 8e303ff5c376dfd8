//! The regressions of the two sonar channels.

use super::basis::Covariates;
use super::kernel::Spot;
use super::{Design, Likelihood, Regression, Steps, Surface};
use crate::fit::{FitContext, Fitted, MOST_ITERATIONS, TOLERANCE_NATS};
use crate::sample::Sample;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::maximise::{Bounds, climb};
use mindgap_foundations::statistics::summary::{QUARTILE, median};
use mindgap_learning::evaluation::observations::Observation;
use mindgap_learning::evaluation::predictions::{Faced, facing};
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::sonar::Perturbation;
use mindgap_models::sonar::model::FAR_CM;

/// Noise of readings in addition to the simulator's.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Standard deviation, cm.
    noise_cm: f64,
    /// Probability of a random short reading.
    short: f64,
    /// Probability of a random reading from beyond what the axis meets.
    long: f64,
}

/// The readings of all rows, with what the sensor faces.
pub struct Readings<'a> {
    rows: Vec<Reading<'a>>,
}

struct Reading<'a> {
    /// `None` if the sensor is not compared.
    faced: Option<Faced<'a>>,
    echo_cm: Option<f64>,
    weight: [f64; 2],
}

/// Bounds of noise, short and long readings: the widest that make sense for a beam in a room.
const BOUNDS: [Bounds; 3] = [Bounds::new(0.0, 10.0), Bounds::new(0.0, 0.5), Bounds::new(0.0, 0.5)];
/// Start of their fit, close to none.
const START: [f64; 3] = [0.3, 0.002, 0.002];
/// Standard deviation of rounding to centimetres, √(1/12) cm: readings never have less noise.
const LEAST_NOISE_CM: f64 = 0.29;
/// Unit of the log-odds of an echo. The information of a yes or no about them is largest if each of the nine rays returns one
/// time in ten: 0.52 per squared log-odds, about one per squared unit.
const LOG_ODDS: f64 = 1.4;
/// Step of numerical derivatives in these units: far below one, far above rounding.
const DIFFERENCE: f64 = 0.01;

/// Fits the residual of the echo rate.
pub fn rate(underneath: Fitted, context: &FitContext) -> Regression {
    let readings = Readings::of(&underneath.effects(), context.rows);
    let response = |i: usize, prediction: f64| prediction + readings.rows[i].score(prediction);
    let covariates = covariates(context.rows);
    let design = Design::of(&covariates, |i| readings.rows[i].faced.is_some(), place(context.rows));
    let fitted = design.uniform_surface(LOG_ODDS, response);
    let column = readings.rates(&fitted.1);
    regression(Channel::EchoRate, underneath, column, fitted, Likelihood::EchoRate)
}

/// Fits the residual of the readings: a shift, and additional noise.
pub fn value(underneath: Fitted, context: &FitContext) -> Regression {
    let readings = Readings::of(&underneath.effects(), context.rows);
    let fitted = readings.shift(context.rows);
    let terms = |at: &[f64]| readings.values(&fitted.1, &Spread::from(at));
    let found = climb(&BOUNDS, &START, MOST_ITERATIONS, TOLERANCE_NATS, terms).into_maximum(&BOUNDS, terms);
    let of_block = |block: usize| {
        let rows = context.rows.of_block(block);
        let spread = Spread::from(&found.without(&BOUNDS, |row| rows.contains(&row)));
        rows.map(|i| readings.rows[i].value(fitted.1[i], &spread)).collect::<Vec<f64>>()
    };
    let column = (0..context.rows.blocks).flat_map(of_block).collect();
    regression(Channel::EchoValue, underneath, column, fitted, Likelihood::EchoValue(Spread::from(&found.at)))
}

/// Fits a shift of the readings, without additional noise.
pub fn shift(underneath: Fitted, context: &FitContext) -> Regression {
    let readings = Readings::of(&underneath.effects(), context.rows);
    let fitted = readings.shift(context.rows);
    let column = readings.values(&fitted.1, &Spread::NONE);
    regression(Channel::EchoValue, underneath, column, fitted, Likelihood::EchoValue(Spread::NONE))
}

fn regression(
    channel: Channel,
    underneath: Fitted,
    column: Vec<f64>,
    (surface, predictions): (Surface, Vec<f64>),
    likelihood: Likelihood,
) -> Regression {
    let cross_validated = underneath.scores.clone().with(channel, &column);
    Regression { channel, epistemic_error: None, underneath, cross_validated, surface, predictions, likelihood }
}

/// Groups rows by place: what belongs to a place is predicted by others.
fn place(sample: &Sample) -> impl Fn(usize) -> usize {
    |i| sample.rows[i].place
}

/// Returns the covariates of every reading.
pub fn covariates(sample: &Sample) -> Vec<Steps> {
    sample.rows.iter().map(|row| vec![reading_covariates(&row.context)]).collect()
}

/// Returns distance and incidence angle; the commands until the reading; heading; time; and the places of the robot and of what
/// it faces. Whether there was a reading before is left out: what belongs to a place repeats at the next row, when the robot is
/// still near it.
fn reading_covariates(step: &StepContext) -> Covariates {
    let [distance_cm, incidence_rad] = step.faced.unwrap_or([FAR_CM, 0.0]);
    let distance_cm = distance_cm.min(FAR_CM);
    let [_, [left, right], ..] = step.commands;
    let (position_cm, direction) = (step.pose.position_cm, step.pose.direction());
    let faced_cm = position_cm + direction * distance_cm;
    let values = vec![
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
    Covariates { values, spot: step.faced.map(|_| Spot::unweighted(faced_cm)) }
}

impl<'a> Readings<'a> {
    /// Pairs readings with what the sensor faces under these effects.
    pub fn of(effects: &EffectChain, sample: &'a Sample) -> Self {
        let is_compared = sample.baseline.sonar.is_some();
        let reading = |row: &'a Observation| {
            let faced = if is_compared { facing(effects, sample, row) } else { None };
            Reading { faced, echo_cm: row.echo_cm, weight: row.echo_weight }
        };
        Readings { rows: sample.rows.iter().map(reading).collect() }
    }

    /// Returns the log-likelihood of an echo or none at each row, with the log-odds of every ray shifted by the predictions.
    pub fn rates(&self, predictions: &[f64]) -> Vec<f64> {
        let rate = |(reading, prediction): (&Reading, &f64)| {
            let Some(none) = reading.none(*prediction) else { return 0.0 };
            reading.weight[0] * libm::log(if reading.echo_cm.is_some() { 1.0 - none } else { none })
        };
        self.rows.iter().zip(predictions).map(rate).collect()
    }

    /// Returns the log-likelihood of each reading, shifted by the predictions and with additional noise.
    pub fn values(&self, predictions: &[f64], spread: &Spread) -> Vec<f64> {
        self.rows.iter().zip(predictions).map(|(reading, cm)| reading.value(*cm, spread)).collect()
    }

    /// Fits the residual of the readings, cm.
    fn shift(&self, sample: &Sample) -> (Surface, Vec<f64>) {
        let residual = |reading: &Reading| reading.faced.as_ref()?.outcomes().off_cm(reading.echo_cm);
        let residuals: Vec<Option<f64>> = self.rows.iter().map(residual).collect();
        let noise_cm = (median(residuals.iter().flatten().map(|cm| cm.abs())) / QUARTILE).max(LEAST_NOISE_CM);
        // The response is bounded by the likelihood, to which a reading of something else is an outlier, and by the reading.
        let response = |i: usize, prediction: f64| {
            let value = |prediction: f64| self.rows[i].value(noise_cm * prediction, &Spread::NONE);
            let score = (value(prediction + DIFFERENCE) - value(prediction)) / DIFFERENCE;
            let most = (residuals[i].unwrap_or(0.0) / noise_cm - prediction).abs();
            prediction + score.clamp(-most, most)
        };
        let covariates = covariates(sample);
        Design::of(&covariates, |i| residuals[i].is_some(), place(sample)).uniform_surface(noise_cm, response)
    }
}

impl Reading<'_> {
    /// Returns the derivative of the log-likelihood of an echo or none by a prediction in units of [`LOG_ODDS`].
    fn score(&self, prediction: f64) -> f64 {
        let nones = [prediction, prediction + DIFFERENCE].map(|units| self.none(LOG_ODDS * units));
        let [Some(none), Some(shifted)] = nones else { return 0.0 };
        let slope = (none - shifted) / DIFFERENCE;
        if self.echo_cm.is_some() { slope / (1.0 - none) } else { -slope / none }
    }

    /// Returns the probability of no reading, with the log-odds of every echo shifted by a prediction.
    fn none(&self, prediction: f64) -> Option<f64> {
        let faced = self.faced.as_ref()?;
        let attenuation = faced.perturbation.attenuation - prediction;
        Some(faced.perturbed(&Perturbation { attenuation, ..faced.perturbation }).none)
    }

    /// Returns the log-likelihood of a reading if there is one, shifted by a prediction and with additional noise.
    fn value(&self, prediction_cm: f64, spread: &Spread) -> f64 {
        let (Some(faced), Some(_)) = (&self.faced, self.echo_cm) else { return 0.0 };
        let mut perturbation = faced.perturbation;
        perturbation.offset_cm += prediction_cm;
        perturbation.scatter_cm += spread.noise_cm;
        perturbation.p_short = 1.0 - (1.0 - perturbation.p_short) * (1.0 - spread.short);
        perturbation.p_long += spread.long;
        let outcomes = faced.perturbed(&perturbation);
        self.weight[1] * (outcomes.log_likelihood(self.echo_cm) - outcomes.log_detection(self.echo_cm))
    }
}

impl Spread {
    const NONE: Spread = Spread { noise_cm: 0.0, short: 0.0, long: 0.0 };

    fn from(values: &[f64]) -> Self {
        Spread { noise_cm: values[0], short: values[1], long: values[2] }
    }
}
