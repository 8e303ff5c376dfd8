//! An own effect as files hold it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A hypothesis that a user states: named parameters, and expressions for what they change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// By which it is named in an answer.
    pub id: String,
    /// What it supposes, in a sentence.
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
    /// Its name in expressions and answers.
    pub name: String,
    /// Its unit; empty for a share, a factor or a probability.
    #[serde(default)]
    pub unit: String,
    /// With this value it changes nothing.
    pub nominal: f64,
    /// Least and largest value that is possible.
    pub bounds: [f64; 2],
    /// Standard deviation of the normal prior about the nominal value; every value is as likely without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prior_sd: Option<f64>,
    /// Where fits start; a tenth of the way to either bound without.
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
    /// Way forward in the step, cm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forward_cm: Option<String>,
    /// Way to the left in the step, cm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral_cm: Option<String>,
    /// Turn to the left in the step, radians.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn_rad: Option<String>,
    /// The reading, cm: a factor on `echo_cm` and a length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub echo_cm: Option<String>,
    /// Loss of log-odds that a ray comes back.
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
