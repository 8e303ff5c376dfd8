//! Accuracy of a simulator's networks on logs: the paper's figure 2 in numbers, and proper scores of the echo probability.

use std::collections::BTreeMap;

use mindgap_core::network::Network;
use schemars::JsonSchema;
use serde::Serialize;

use super::predictions::{Predictions, predict};
use super::sensor_models::{SensorModels, sensor_models};
use crate::learn::dataset::{Dataset, Datasets};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_foundations::statistics::agreement::{self as statistics, ReliabilityBin, TrendLine};
use mindgap_logs::Logs;
use mindgap_logs::heard::Heard;
use mindgap_models::simulator::further_sensor::Matched;
use mindgap_models::simulator::{Learned, Missing, Simulator};

/// The output of `mindgap evaluate --json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Evaluation {
    /// Version of the JSON.
    pub schema: SchemaNumber<1>,
    /// Accuracy of the networks that the simulator has and the logs have samples for.
    pub networks: Networks,
    /// Accuracy of networks of the sizes in the paper's Table I, if the simulator's have other sizes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_one: Option<Networks>,
    /// Likelihoods of the sensor models, if the logs have readings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_models: Option<SensorModels>,
}

/// Accuracy of each network.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Networks {
    /// Turn, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turn: Option<Value>,
    /// Forward motion, cm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forward: Option<Value>,
    /// Motion to the left, cm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lateral: Option<Value>,
    /// Whether there is an echo.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub echo_probability: Option<Probability>,
    /// The reading, cm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub echo_value: Option<Value>,
    /// The last two of named range sensors, as `echo_probability_NAME` and `echo_value_NAME`.
    #[serde(flatten)]
    pub named: BTreeMap<String, OfSensor>,
}

/// Accuracy of a network of a named range sensor.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum OfSensor {
    /// Whether there is an echo.
    Probability(Probability),
    /// The reading, cm.
    Value(Value),
}

/// Accuracy of a network that predicts a value.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Value {
    /// Coefficient of determination, or null if all logged values are equal.
    pub r2: Option<f64>,
    /// Mean squared error, in squared units of the value.
    pub mse: f64,
    /// Mean absolute error of the reading.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mae_cm: Option<f64>,
    /// Regression line of predicted on logged values.
    pub trend: Option<TrendLine>,
    /// Number of samples.
    pub n: usize,
    /// Logged and predicted value of each sample.
    #[serde(skip)]
    pub points: Vec<[f64; 2]>,
}

/// Accuracy of a network that predicts a probability.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Probability {
    /// Coefficient of determination of the outcomes 0 and 1, or null if all are equal.
    pub r2: Option<f64>,
    /// Brier score, the mean squared error.
    pub brier: f64,
    /// Mean negative log-likelihood, with probabilities clamped to 0.001..0.999.
    pub log_loss: f64,
    /// Area under the ROC curve, or null if all outcomes are equal.
    pub auc: Option<f64>,
    /// Regression line of predicted on logged values.
    pub trend: Option<TrendLine>,
    /// Number of samples.
    pub n: usize,
    /// Observed frequency per bin of predicted probability.
    pub reliability: Vec<ReliabilityBin>,
    /// Logged and predicted value of each sample.
    #[serde(skip)]
    pub points: Vec<[f64; 2]>,
}

/// Evaluates a simulator, with any effects added to it, on logs that it was preferably not trained on. `watch` receives the
/// work done and the total.
///
/// # Errors
/// If the logs have no sample for any network of the simulator.
pub fn evaluate(simulator: &Simulator, logs: &Logs, watch: impl Fn(usize, usize) + Sync) -> Result<Evaluation> {
    let networks = networks(simulator, logs)?;
    if networks == Networks::default() {
        return Err(Error::new("these logs hold no sample for any network of this simulator"));
    }
    let table_one = simulator.table_one.as_ref().map(|simulator| self::networks(simulator, logs)).transpose()?;
    Ok(Evaluation { schema: SchemaNumber, networks, table_one, sensor_models: sensor_models(simulator, logs, watch) })
}

/// Evaluates a simulator as [`evaluate`] does, on logs as each of the robot's range sensors heard them, the first sensor first.
/// `warn` receives a line for each sensor that cannot be evaluated.
///
/// # Errors
/// As [`evaluate`], or when the first sensors of simulator and logs differ.
pub fn evaluate_sensors(
    simulator: &Simulator,
    heard: &[Heard],
    watch: impl Fn(usize, usize) + Sync,
    mut warn: impl FnMut(String),
) -> Result<Evaluation> {
    let further = simulator.matched(heard)?;
    let mut evaluation = evaluate(simulator, &heard[0].logs, watch)?;
    if let Some(first) = &simulator.sensor {
        let own = evaluation.networks.clone();
        evaluation.networks.name(first, own);
    }
    for Matched { sensor, compared } in further {
        match compared {
            Ok(compared) => {
                let (own, logs) = *compared;
                evaluation.networks.name(&sensor, networks(&own, logs)?);
                if let (Some(tables), Some(own)) = (&mut evaluation.table_one, &own.table_one) {
                    tables.name(&sensor, networks(&own.asking(&sensor)?, logs)?);
                }
            }
            Err(why) => warn(format!("range sensor {sensor} is not evaluated: {why}")),
        }
    }
    Ok(evaluation)
}

impl Networks {
    /// Returns the readings of the first range sensor, unless they are also there under its name.
    pub fn unnamed_value(&self) -> Option<&Value> {
        let is_named =
            |value: &Value| self.named.values().any(|of| matches!(of, OfSensor::Value(named) if named == value));
        self.echo_value.as_ref().filter(|value| !is_named(value))
    }

    /// Returns the same of whether there is an echo.
    pub fn unnamed_probability(&self) -> Option<&Probability> {
        let is_named = |own: &Probability| {
            self.named.values().any(|of| matches!(of, OfSensor::Probability(named) if named == own))
        };
        self.echo_probability.as_ref().filter(|own| !is_named(own))
    }

    /// Returns the readings of named range sensors, with the networks' names.
    pub fn named_values(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.named.iter().filter_map(|(name, of)| match of {
            OfSensor::Value(value) => Some((name.as_str(), value)),
            OfSensor::Probability(_) => None,
        })
    }

    /// Takes the networks of a range sensor under its name.
    fn name(&mut self, sensor: &str, of: Networks) {
        let key = |network: &str| Missing::network_of(network, sensor);
        let probability = of.echo_probability.map(|p| (key("echo_probability"), OfSensor::Probability(p)));
        let value = of.echo_value.map(|v| (key("echo_value"), OfSensor::Value(v)));
        self.named.extend(probability.into_iter().chain(value));
    }
}

fn networks(simulator: &Simulator, logs: &Logs) -> Result<Networks> {
    let samples =
        if simulator.chain().is_empty() { network_predictions(simulator, logs) } else { predict(simulator, logs)? };
    let value = |points: Vec<[f64; 2]>| (!points.is_empty()).then(|| Value::of(points));
    let mut echo_value = value(samples.echo_value);
    if let Some(value) = &mut echo_value {
        let [expected, predicted] = columns(&value.points);
        value.mae_cm = Some(statistics::mae(&expected, &predicted));
    }
    let echoes = samples.echo_probability;
    Ok(Networks {
        turn: value(samples.turn),
        forward: value(samples.forward),
        lateral: value(samples.lateral),
        echo_probability: (!echoes.is_empty()).then(|| Probability::of(echoes)),
        echo_value,
        named: BTreeMap::new(),
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

/// Returns what the networks alone predict of logs.
fn network_predictions(simulator: &Simulator, logs: &Logs) -> Predictions {
    let data = Datasets::from_logs(logs);
    Predictions {
        forward: points(&simulator.forward, &data.forward),
        lateral: points(&simulator.lateral, &data.lateral),
        turn: points(&simulator.turn, &data.turn),
        echo_probability: points(&simulator.echo_probability, &data.echo_probability),
        echo_value: points(&simulator.echo_value, &data.echo_value),
    }
}

/// Returns the logged and predicted value of each sample, or nothing without a network.
fn points<const N: usize>(learned: &Option<Learned<N>>, data: &Dataset<N>) -> Vec<[f64; 2]> {
    let points = |network: &Network<f32, N>| {
        let samples = data.inputs.iter().zip(&data.targets);
        samples.map(|(x, t)| [f64::from(*t), f64::from(network.evaluate(*x))]).collect()
    };
    learned.as_ref().map_or_else(Vec::new, |learned| points(&learned.network))
}

fn columns(points: &[[f64; 2]]) -> [Vec<f64>; 2] {
    [0, 1].map(|i| points.iter().map(|p| p[i]).collect())
}
