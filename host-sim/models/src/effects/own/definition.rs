//! An own effect as files hold it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A hypothesis that a user states: named parameters, and expressions for what they change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// Id by which a diagnosis names it.
    pub id: String,
    /// What it assumes, in one sentence.
    pub description: String,
    /// What is fitted.
    #[serde(rename = "parameter", default)]
    pub parameters: Vec<ParameterDefinition>,
    /// What it changes.
    pub change: Change,
}

/// A number that is fitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParameterDefinition {
    /// Its name in expressions and in a diagnosis.
    pub name: String,
    /// Its unit; empty for a share, a factor or a probability.
    #[serde(default)]
    pub unit: String,
    /// With this value it changes nothing.
    pub nominal: f64,
    /// Smallest and largest possible value.
    pub bounds: [f64; 2],
    /// Standard deviation of the normal prior about the nominal value; without it the prior is flat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prior_sd: Option<f64>,
    /// Starting values of fits; by default a tenth of the way to either bound.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub guesses: Vec<f64>,
}

/// An expression for the new value of each thing that changes; what is not there stays as it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Command of the left motor, -100 to 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left: Option<String>,
    /// Command of the right motor, -100 to 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub right: Option<String>,
    /// Expression for the forward motion in the step, cm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forward_cm: Option<String>,
    /// Expression for the motion to the left in the step, cm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral_cm: Option<String>,
    /// Expression for the turn to the left in the step, radians.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn_rad: Option<String>,
    /// Expression for the reading, cm: a factor on `echo_cm`, plus a length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub echo_cm: Option<String>,
    /// Expression for the loss in the log-odds that a ray returns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub echo_loss: Option<String>,
}

impl Change {
    /// What is changed, each with its expression.
    pub fn entries(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let Change { left, right, forward_cm, lateral_cm, turn_rad, echo_cm, echo_loss } = self;
        let all = [
            ("left", left),
            ("right", right),
            ("forward_cm", forward_cm),
            ("lateral_cm", lateral_cm),
            ("turn_rad", turn_rad),
            ("echo_cm", echo_cm),
            ("echo_loss", echo_loss),
        ];
        all.into_iter().filter_map(|(key, text)| Some((key, text.as_deref()?)))
    }
}
