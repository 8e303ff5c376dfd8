//! What is kept of one robot's diagnosis.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::gap::request::Answered;
use crate::gap::verdict::NamedEffect;
use crate::gap::verdict::Verdict;

/// A robot of a fleet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// The answer in one word.
    pub verdict: Verdict,
    /// Number of its runs.
    pub runs: usize,
    /// Number of their rows.
    pub rows: usize,
    /// The gap that could be reduced, nats a step; none where there is none.
    pub gap_nats: Option<f64>,
    /// The share of it that the named effects close.
    pub closed: Option<f64>,
    /// What the gap is made of: ids with their shares and 95 % intervals of them.
    pub budget: Vec<(String, f64, [f64; 2])>,
    /// The effects that are named.
    pub effects: Vec<Cause>,
    /// Effects that its logs could not show.
    pub untestable: Vec<String>,
}

/// An effect that is named in a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    /// Its id.
    pub id: String,
    /// How probable it is.
    pub probability: f64,
    /// Its form and parameters, as a simulator takes them; none of scatter, which is no effect that could be added.
    pub strength: Option<(String, BTreeMap<String, f64>)>,
}

impl Robot {
    /// Of what was found in a robot's logs.
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
            verdict: diagnosis.verdict,
            runs: logs.runs.len(),
            rows: logs.rows(),
            gap_nats: diagnosis.reduction.as_ref().map(|reduction| reduction.whole.before),
            closed: diagnosis.reduction.as_ref().map(|reduction| reduction.whole.reducible_closed),
            budget: diagnosis.budget.iter().map(|part| (part.id.clone(), part.share, part.ci95)).collect(),
            effects: diagnosis.effects.iter().map(cause).collect(),
            untestable: diagnosis.untestable.iter().map(|id| (*id).into()).collect(),
        }
    }
}
