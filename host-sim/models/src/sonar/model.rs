//! The parameters of a sensor.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Number of weights that make up a ray's log-odds.
pub const STRENGTHS: usize = 10;
/// Distance beyond which neither log-odds nor scatter change, cm: beyond any sensor's range.
pub const FAR_CM: f64 = 300.0;
/// Probability of a random answer: no model is certain. It bounds what one reading can say against a hypothesis (six
/// nats for or against an echo, eleven for a place).
pub const P_RAND: f64 = 0.006;
/// Constant and ghost readings scatter by this scale, cm: they are logged in whole centimetres, and the paper's is
/// "roughly" constant (section VIII).
pub const CONSTANT_SCATTER_CM: f64 = 0.8;
/// Least length over which short and long readings are uniform, cm, even if the wall on the axis is near an end of the
/// range: it bounds their density.
const LEAST_INTERVAL_CM: f64 = 10.0;

/// The parameters of a sensor, fitted to its training logs. The names in files are the serde names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SonarModel {
    /// Weights of the ray features: the log-odds that a ray returns.
    pub strength: [f64; STRENGTHS],
    /// Log-odds that a ray loses by a specular reflection; absent if mirrored rays never return.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirror_loss: Option<f64>,
    /// Reading minus distance: a constant, a share of the distance, and per 45 degrees of incidence; cm.
    pub bias: [f64; 3],
    /// Logarithm of the scatter's scale in cm: a constant, per metre, per 45 degrees.
    pub log_scatter: [f64; 3],
    /// Probability of the constant reading in place of an echo, and its value in cm.
    pub constant: [f64; 2],
    /// Probability of the constant reading in place of none.
    #[serde(rename = "constant_for_none")]
    pub p_constant_given_none: f64,
    /// Probability of a random short reading.
    #[serde(rename = "short")]
    pub p_short: f64,
    /// Probability that an echo is dropped.
    #[serde(rename = "lost")]
    pub p_dropout: f64,
    /// Width of the beam relative to that of a usual sensor.
    pub fan_width: f64,
    /// Smallest and largest reading, cm.
    pub range_cm: [f64; 2],
}

impl SonarModel {
    /// Returns whether the parameters are those of a possible sensor.
    pub fn is_sound(&self) -> bool {
        let SonarModel { strength, mirror_loss, bias, log_scatter, constant: [p_constant, constant_cm], .. } = self;
        let SonarModel { p_constant_given_none, p_short, p_dropout, fan_width, range_cm: [low_cm, high_cm], .. } = self;
        let numbers = strength.iter().chain(mirror_loss).chain(bias).chain(log_scatter);
        let numbers = numbers.chain([constant_cm, fan_width, low_cm, high_cm]);
        let mut probabilities = [p_constant, p_constant_given_none, p_short, p_dropout].into_iter();
        numbers.into_iter().all(|number| number.is_finite())
            && probabilities.all(|p| (0.0..=1.0).contains(p))
            && *fan_width > 0.0
            && low_cm < high_cm
    }
}

/// Width of an ideal ray relative to a usual beam.
const RAY_WIDTH: f64 = 0.05;
/// Log-odds that an ideal ray returns: practically certain.
const CERTAIN: f64 = 6.0;

impl SonarModel {
    /// Returns the textbook's ideal ray with a dropout probability and scatter, cm.
    pub fn ideal_ray(scatter_cm: f64, p_dropout: f64, range_cm: [f64; 2]) -> Self {
        let mut strength = [0.0; STRENGTHS];
        strength[0] = CERTAIN;
        SonarModel {
            strength,
            mirror_loss: None,
            bias: [0.0; 3],
            log_scatter: [libm::log(scatter_cm), 0.0, 0.0],
            constant: [0.0, range_cm[0]],
            p_constant_given_none: 0.0,
            p_short: 0.0,
            p_dropout,
            fan_width: RAY_WIDTH,
            range_cm,
        }
    }

    /// Returns the bounds of the distance that separates short readings from long ones, cm.
    pub fn reach_bounds_cm(&self) -> [f64; 2] {
        reach_bounds_cm(self.range_cm)
    }
}

/// Returns the bounds of the distance that separates short readings from long ones within a range of readings, cm.
pub fn reach_bounds_cm([low, high]: [f64; 2]) -> [f64; 2] {
    let least = LEAST_INTERVAL_CM.min(0.5 * (high - low));
    [low + least, high - least]
}
