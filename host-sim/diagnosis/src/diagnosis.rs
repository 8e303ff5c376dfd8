//! The diagnosis as data, in the form of diagnosis.json.

use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use super::account::GapReduction;
use super::budget::Part;
use super::confirm::unconfirmed::Unconfirmed;
use super::excitation::Detectable;
use super::explain::profile::ResidualProfile;
use super::explain::strata::Stratum;
use super::formula::Statement;
use super::outliers::Outliers;
use super::propose::Experiment;
use super::scope::Scope;
use super::sessions::SessionFindings;
use super::verdict::{NamedEffect, Verdict};
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_learning::evaluation::final_position::FinalPositionErrors;
use mindgap_logs::inspection::Finding;

/// What `mindgap diagnose` finds; docs/reference/json.md describes the JSON.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Diagnosis {
    /// Version of the JSON.
    pub schema: SchemaNumber<1>,
    /// The answer in one word.
    pub verdict: Verdict,
    /// The parts of the gap; none if there is no gap.
    pub budget: Vec<Part>,
    /// The named effects, most probable first; none unless the gap is known or partly known.
    pub effects: Vec<NamedEffect>,
    /// Where the gap lies.
    #[serde(rename = "where")]
    pub strata: Vec<Stratum>,
    /// How far the gap shrinks with the effects, if held-out rows show a reducible gap. In JSON it is always an object.
    #[serde(rename = "shrink", serialize_with = "or_none")]
    #[schemars(with = "GapReduction")]
    pub reduction: Option<GapReduction>,
    /// Errors of final positions, if the logs are runs of a given controller.
    #[serde(rename = "endings")]
    pub final_positions: Option<FinalPositionErrors>,
    /// What to drive next, if causes are confused.
    #[serde(rename = "next_experiment", serialize_with = "as_sentence")]
    #[schemars(with = "Option<String>")]
    pub experiment: Option<Experiment>,
    /// The best simple expression for what no effect explains, if one holds.
    pub formula: Option<Statement>,
    /// What the unexplained part depends on, by channel.
    #[serde(rename = "unexplained")]
    pub profiles: Vec<ResidualProfile>,
    /// The channels that were compared and those that were not.
    #[serde(flatten)]
    pub scope: Scope,
    /// Defects of the logs.
    pub data: Vec<Finding>,
    /// The smallest strength that these logs would show, of each effect that is not named.
    pub detectable: Vec<Detectable>,
    /// The effects that were found on fitted rows and not confirmed on held-out ones.
    pub unconfirmed: Vec<Unconfirmed>,
    /// Rows with residuals larger than noise explains, by channel.
    pub outliers: Vec<Outliers>,
    /// Effects that these logs could not show: untestable, not absent.
    pub untestable: Vec<&'static str>,
    /// Other limits of this diagnosis, one sentence each.
    pub notes: Vec<String>,
    /// What differs between sessions, where there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sessions: Vec<SessionFindings>,
}

fn as_sentence<S: Serializer>(experiment: &Option<Experiment>, to: S) -> Result<S::Ok, S::Error> {
    experiment.as_ref().map(Experiment::sentence).serialize(to)
}

fn or_none<S: Serializer>(reduction: &Option<GapReduction>, to: S) -> Result<S::Ok, S::Error> {
    reduction.as_ref().unwrap_or(&GapReduction::NONE).serialize(to)
}
