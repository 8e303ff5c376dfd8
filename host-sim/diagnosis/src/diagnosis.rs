//! The answer as data, and as it is written.

use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

use super::account::{Account, GapReduction};
use super::budget::Part;
use super::explain::NamedEffect;
use super::explain::profile::ResidualProfile;
use super::explain::strata::Stratum;
use super::formula::Statement;
use super::propose::Experiment;
use super::scope::Scope;
use mindgap_learning::evaluation::final_position::FinalPositionErrors;
use mindgap_logs::inspection::Finding;

/// What `mindgap diagnose` finds; docs/formats.md has the JSON.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// What was wrong with the logs before anything was compared.
    pub data: Vec<Finding>,
    /// What the answer speaks of.
    pub scope: Scope,
    /// The answer.
    pub answer: Answer,
    /// The best simple expression for what no effect explains, where one holds.
    pub formula: Option<Statement>,
    /// Where the gap lies.
    pub strata: Vec<Stratum>,
    /// Where a controller's runs end, if the logs are said to be those of a controller.
    pub final_positions: Option<FinalPositionErrors>,
    /// Effects that these logs could not show: untestable, not absent.
    pub untestable: Vec<&'static str>,
    /// What else limits this diagnosis.
    pub notes: Vec<String>,
}

/// What an answer holds.
#[derive(Clone, Debug)]
pub enum Answer {
    /// The logs agree with the simulator within its own error.
    NoGap,
    /// Effects of the catalogue explain the gap, or steps do nothing but scatter more.
    Known {
        /// The effects, the most probable first.
        effects: Vec<NamedEffect>,
        /// How far they close it.
        account: Account,
        /// What to drive next, where causes are confused.
        experiment: Option<Experiment>,
    },
    /// Effects explain a part of the gap.
    PartlyKnown {
        /// The effects, the most probable first.
        effects: Vec<NamedEffect>,
        /// How far they close it.
        account: Account,
        /// What to drive next, where causes are confused.
        experiment: Option<Experiment>,
        /// How what is unexplained follows covariates, channel by channel.
        profiles: Vec<ResidualProfile>,
    },
    /// There is a gap and no effect explains it.
    Unknown {
        /// How far the effects close it that came nearest.
        account: Account,
        /// How what is unexplained follows covariates, channel by channel.
        profiles: Vec<ResidualProfile>,
    },
}

impl Answer {
    /// What the gap is made of, and how far it shrinks; none where there is none.
    pub fn account(&self) -> Option<&Account> {
        match self {
            Answer::NoGap => None,
            Answer::Known { account, .. } | Answer::PartlyKnown { account, .. } | Answer::Unknown { account, .. } => {
                Some(account)
            }
        }
    }
}

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// See [`Answer::NoGap`].
    NoGap,
    /// See [`Answer::Known`].
    Known,
    /// See [`Answer::PartlyKnown`].
    PartlyKnown,
    /// See [`Answer::Unknown`].
    Unknown,
}

impl Verdict {
    /// As it is written.
    pub fn id(self) -> &'static str {
        match self {
            Verdict::NoGap => "no_gap",
            Verdict::Known => "known",
            Verdict::PartlyKnown => "partly_known",
            Verdict::Unknown => "unknown",
        }
    }
}

impl Diagnosis {
    /// The answer in one word.
    pub fn verdict(&self) -> Verdict {
        match self.answer {
            Answer::NoGap => Verdict::NoGap,
            Answer::Known { .. } => Verdict::Known,
            Answer::PartlyKnown { .. } => Verdict::PartlyKnown,
            Answer::Unknown { .. } => Verdict::Unknown,
        }
    }

    /// The effects that are named, the most probable first.
    pub fn effects(&self) -> &[NamedEffect] {
        match &self.answer {
            Answer::Known { effects, .. } | Answer::PartlyKnown { effects, .. } => effects,
            Answer::NoGap | Answer::Unknown { .. } => &[],
        }
    }

    /// How far the gap shrinks.
    pub fn reduction(&self) -> Option<&GapReduction> {
        self.answer.account().and_then(|account| account.reduction.as_ref())
    }

    /// What the gap is made of; nothing where there is none.
    pub fn budget(&self) -> &[Part] {
        self.answer.account().map_or(&[], |account| &account.budget)
    }

    /// How what is unexplained follows covariates.
    pub fn profiles(&self) -> &[ResidualProfile] {
        match &self.answer {
            Answer::PartlyKnown { profiles, .. } | Answer::Unknown { profiles, .. } => profiles,
            Answer::NoGap | Answer::Known { .. } => &[],
        }
    }

    /// What to drive next.
    pub fn experiment(&self) -> Option<&Experiment> {
        match &self.answer {
            Answer::Known { experiment, .. } | Answer::PartlyKnown { experiment, .. } => experiment.as_ref(),
            Answer::NoGap | Answer::Unknown { .. } => None,
        }
    }
}

/// Version of the JSON.
const SCHEMA: u32 = 1;

impl Serialize for Diagnosis {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut fields = to.serialize_struct("Diagnosis", 14)?;
        fields.serialize_field("schema", &SCHEMA)?;
        fields.serialize_field("verdict", &self.verdict())?;
        fields.serialize_field("budget", self.budget())?;
        fields.serialize_field("effects", self.effects())?;
        fields.serialize_field("where", &self.strata)?;
        fields.serialize_field("shrink", &self.reduction())?;
        fields.serialize_field("endings", &self.final_positions)?;
        fields.serialize_field("next_experiment", &self.experiment().map(Experiment::sentence))?;
        fields.serialize_field("formula", &self.formula)?;
        fields.serialize_field("unexplained", self.profiles())?;
        fields.serialize_field("compared", &self.scope.compared)?;
        fields.serialize_field("not_compared", &self.scope.not_compared)?;
        fields.serialize_field("data", &self.data)?;
        fields.serialize_field("untestable", &self.untestable)?;
        fields.serialize_field("notes", &self.notes)?;
        fields.end()
    }
}
