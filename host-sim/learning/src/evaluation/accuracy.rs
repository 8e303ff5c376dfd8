//! How well a simulator's networks do on logs: the paper's figure 2 in numbers, and what a probability asks beyond.

use mindgap_core::network::Network;
use serde::Serialize;

use super::predictions::{Predictions, predict};
use super::sensor_models::{SensorModels, sensor_models};
use crate::learn::dataset::{Dataset, Datasets};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::statistics::agreement::{self as statistics, ReliabilityBin, TrendLine};
use mindgap_logs::Logs;
use mindgap_models::simulator::{Learned, Simulator};

/// What `mindgap evaluate --json` writes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// Version of this form.
    pub schema: u32,
    /// The networks that both the simulator and the logs have.
    pub networks: Networks,
    /// The same with the sizes of the paper's Table I, for a simulator of other sizes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_one: Option<Networks>,
    /// The models of the sensor, where the logs have readings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_models: Option<SensorModels>,
}

/// Accuracy of each network.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Networks {
    /// Turn, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turn: Option<Value>,
    /// Way forward, cm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forward: Option<Value>,
    /// Way to the left, cm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lateral: Option<Value>,
    /// Whether there is an echo.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub echo_probability: Option<Probability>,
    /// The reading, cm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub echo_value: Option<Value>,
}

/// Accuracy of a network that predicts a value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// Coefficient of determination; null when all logged values are equal.
    pub r2: Option<f64>,
    /// Mean squared error, in the square of the value's unit.
    pub mse: f64,
    /// Mean absolute error of the reading.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mae_cm: Option<f64>,
    /// Predicted over expected.
    pub trend: Option<TrendLine>,
    /// Samples.
    pub n: usize,
    /// Expected and predicted, sample by sample.
    #[serde(skip)]
    pub points: Vec<[f64; 2]>,
}

/// Accuracy of a network that predicts a probability.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probability {
    /// Coefficient of determination against 0 and 1; null when all outcomes are equal.
    pub r2: Option<f64>,
    /// Brier score: the mean squared error.
    pub brier: f64,
    /// Mean negative log likelihood, probabilities held within 0.001..0.999.
    pub log_loss: f64,
    /// Area under the ROC curve; null when all outcomes are equal.
    pub auc: Option<f64>,
    /// Predicted over expected.
    pub trend: Option<TrendLine>,
    /// Samples.
    pub n: usize,
    /// Predicted against observed.
    pub reliability: Vec<ReliabilityBin>,
    /// Expected and predicted, sample by sample.
    #[serde(skip)]
    pub points: Vec<[f64; 2]>,
}

/// Judges a simulator, with the effects that were added to it if there are any, on logs, best on such as it was not trained on.
/// `watch` is told how much of it is done, of how much.
///
/// # Errors
/// When the simulator and the logs have no network in common.
pub fn evaluate(simulator: &Simulator, logs: &Logs, watch: impl Fn(usize, usize) + Sync) -> Result<Evaluation> {
    let networks = judge(simulator, logs)?;
    if networks == Networks::default() {
        return Err(Error::new("these logs hold no sample for any network of this simulator"));
    }
    let table_one = simulator.table_one.as_ref().map(|simulator| judge(simulator, logs)).transpose()?;
    Ok(Evaluation { schema: 1, networks, table_one, sensor_models: sensor_models(simulator, logs, watch) })
}

fn judge(simulator: &Simulator, logs: &Logs) -> Result<Networks> {
    let samples = if simulator.added.is_empty() { of_networks(simulator, logs) } else { predict(simulator, logs)? };
    let value = |points: Vec<[f64; 2]>| (!points.is_empty()).then(|| Value::of(points));
    let mut echo_value = value(samples.echo_value);
    if let Some(value) = &mut echo_value {
        let [expected, predicted] = columns(&value.points);
        value.mae_cm = Some(statistics::mae(&expected, &predicted));
    }
    let chances = samples.echo_probability;
    Ok(Networks {
        turn: value(samples.turn),
        forward: value(samples.forward),
        lateral: value(samples.lateral),
        echo_probability: (!chances.is_empty()).then(|| Probability::of(chances)),
        echo_value,
    })
}

impl Value {
    fn of(points: Vec<[f64; 2]>) -> Self {
        let [expected, predicted] = columns(&points);
        Value {
            r2: statistics::r2(&expected, &predicted),
            mse: statistics::mse(&expected, &predicted),
            mae_cm: None,
            trend: statistics::trend_line(&expected, &predicted),
            n: points.len(),
            points,
        }
    }
}

impl Probability {
    fn of(points: Vec<[f64; 2]>) -> Self {
        let [outcomes, predicted] = columns(&points);
        Probability {
            r2: statistics::r2(&outcomes, &predicted),
            brier: statistics::mse(&outcomes, &predicted),
            log_loss: statistics::log_loss(&outcomes, &predicted),
            auc: statistics::auc(&outcomes, &predicted),
            trend: statistics::trend_line(&outcomes, &predicted),
            n: points.len(),
            reliability: statistics::reliability(&outcomes, &predicted),
            points,
        }
    }
}

/// What the networks alone predict of logs.
fn of_networks(simulator: &Simulator, logs: &Logs) -> Predictions {
    let data = Datasets::from_logs(logs);
    Predictions {
        forward: answers(&simulator.forward, &data.forward),
        lateral: answers(&simulator.lateral, &data.lateral),
        turn: answers(&simulator.turn, &data.turn),
        echo_probability: answers(&simulator.echo_probability, &data.echo_probability),
        echo_value: answers(&simulator.echo_value, &data.echo_value),
    }
}

/// Expected and predicted for each sample; none without a network.
fn answers<const N: usize>(learned: &Option<Learned<N>>, data: &Dataset<N>) -> Vec<[f64; 2]> {
    let ask = |network: &Network<f32, N>| {
        let samples = data.inputs.iter().zip(&data.targets);
        samples.map(|(x, t)| [f64::from(*t), f64::from(network.evaluate(*x))]).collect()
    };
    learned.as_ref().map_or_else(Vec::new, |learned| ask(&learned.network))
}

fn columns(points: &[[f64; 2]]) -> [Vec<f64>; 2] {
    [0, 1].map(|i| points.iter().map(|p| p[i]).collect())
}
