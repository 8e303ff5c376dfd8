//! The summary of one robot's diagnosis.

use serde::{Deserialize, Serialize};

use mindgap_diagnosis::request::Answered;
use mindgap_diagnosis::verdict::{NamedEffect, Verdict};
use mindgap_models::effects::parameter::Settings;

/// The summary of a robot of a fleet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// Its dimensions.
    pub measures: mindgap_logs::Robot,
    /// Verdict.
    pub verdict: Verdict,
    /// Number of runs.
    pub runs: usize,
    /// Number of rows.
    pub rows: usize,
    /// Reducible gap, nats per step; `None` if there is no gap.
    pub gap_nats: Option<f64>,
    /// Share of the reducible gap that the named effects close.
    pub closed: Option<f64>,
    /// Parts of the gap: id, share and 95 % interval.
    pub budget: Vec<(String, f64, [f64; 2])>,
    /// Named effects.
    pub effects: Vec<Cause>,
    /// Effects that are not testable with its logs.
    pub untestable: Vec<String>,
}

/// An effect named for a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    /// Its id.
    pub id: String,
    /// Probability of the effect.
    pub probability: f64,
    /// Variant and parameters, as added to a simulator; `None` for scatter, which is not an effect.
    pub strength: Option<(String, Settings)>,
}

impl Robot {
    /// Summarises the diagnosis of a robot.
    pub fn of(Answered { findings, logs }: &Answered) -> Self {
        let diagnosis = &findings.diagnosis;
        let cause = |named: &NamedEffect| Cause {
            id: named.id.into(),
            probability: named.probability,
            strength: findings
                .applied
                .iter()
                .find(|applied| applied.effect == named.id)
                .map(|applied| (applied.variant.clone(), applied.parameters.clone())),
        };
        Robot {
            measures: logs.robot,
            verdict: diagnosis.verdict,
            runs: logs.runs.len(),
            rows: logs.rows(),
            gap_nats: diagnosis.reduction.as_ref().map(|reduction| reduction.whole.before),
            closed: diagnosis.reduction.as_ref().and_then(|reduction| reduction.whole.reducible_closed),
            budget: diagnosis.budget.iter().map(|part| (part.id.clone(), part.share, part.ci95)).collect(),
            effects: diagnosis.effects.iter().map(cause).collect(),
            untestable: diagnosis.untestable.iter().map(|id| (*id).into()).collect(),
        }
    }
}
