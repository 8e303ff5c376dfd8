//! The results for a fleet as data and JSON.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::common::{Common, common};
use super::frequency::{Frequency, frequencies};
use super::groups::groups;
use super::outliers::{Outlier, outliers};
use super::spread::{RoundedSpread, Spread};
use super::tally::{Refused, Tally};
use mindgap_diagnosis::verdict::Verdict;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_foundations::statistics::rounding;

/// Results of `mindgap diagnose --fleet`; docs/reference/json.md describes the JSON.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Fleet {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// Number of diagnosed robots.
    pub diagnosed: usize,
    /// Number of robots per verdict.
    pub verdicts: BTreeMap<&'static str, usize>,
    /// Distribution of the gap, nats per step; null if no robot has a gap.
    pub gap_nats: Option<RoundedSpread>,
    /// Named effects, most frequent first.
    pub effects: Vec<Frequency>,
    /// Effects shared by nearly all robots, which are errors of the simulator.
    pub common: Vec<Common>,
    /// Groups of robots with similar gaps, largest first.
    pub groups: Vec<Group>,
    /// Outliers, most extreme first.
    pub stands_out: Vec<Outlier>,
    /// Robots that could not be diagnosed.
    pub refused: Vec<Refused>,
    /// Files in the folder that belong to no robot.
    pub left_out: Vec<String>,
    /// Robots as listed on the page.
    #[serde(skip)]
    pub robots: Vec<Row>,
}

/// A group of robots with similar gaps.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Group {
    /// Mean shares of the gap, largest first.
    pub budget: Vec<Share>,
    /// Median gap, nats per step.
    #[serde(serialize_with = "rounding::optional")]
    pub gap_nats: Option<f64>,
    /// Names of the robots.
    pub robots: Vec<String>,
}

/// One part of a gap.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Share {
    /// Its id.
    pub id: &'static str,
    /// Its share.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
}

/// A row of the list of robots.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Verdict.
    pub verdict: Verdict,
    /// Gap, nats per step.
    pub gap_nats: Option<f64>,
    /// Parts of the gap, largest first.
    pub budget: Vec<Share>,
    /// Number of the group, from 1.
    pub group: usize,
}

/// Smallest share that is listed.
const WORTH_TELLING: f64 = 0.005;

impl Fleet {
    /// Computes the results from the tally of all robots.
    pub fn of(tally: Tally, left_out: Vec<String>, seed: u64) -> Self {
        let groups = groups(&tally, seed);
        let mut verdicts = BTreeMap::new();
        tally.verdicts.iter().for_each(|verdict| *verdicts.entry(verdict.id()).or_insert(0) += 1);
        let shares = |budget: Vec<f64>| {
            let parts = tally.parts.iter().zip(budget).map(|(id, share)| Share { id, share });
            let mut shares: Vec<Share> = parts.filter(|part| part.share >= WORTH_TELLING).collect();
            shares.sort_by(|a, b| b.share.total_cmp(&a.share));
            shares
        };
        let gap = |members: &mut dyn Iterator<Item = usize>| {
            Spread::of(members.filter_map(|member| tally.gaps_nats[member]).collect())
        };
        let mut robots: Vec<Row> = (0..tally.names.len())
            .map(|place| Row {
                name: tally.names[place].clone(),
                verdict: tally.verdicts[place],
                gap_nats: tally.gaps_nats[place],
                budget: shares(tally.budgets[place].iter().map(|share| f64::from(*share)).collect()),
                group: 0,
            })
            .collect();
        for (number, group) in groups.iter().enumerate() {
            group.members.iter().for_each(|member| robots[*member].group = number + 1);
        }
        Fleet {
            schema: SchemaNumber,
            diagnosed: tally.names.len(),
            verdicts,
            gap_nats: gap(&mut (0..tally.names.len())).map(|spread| spread.rounded()),
            effects: frequencies(&tally),
            common: common(&tally),
            groups: groups
                .iter()
                .map(|group| Group {
                    budget: shares(group.budget.clone()),
                    gap_nats: gap(&mut group.members.iter().copied()).map(|spread| spread.median),
                    robots: group.members.iter().map(|member| tally.names[*member].clone()).collect(),
                })
                .collect(),
            stands_out: outliers(&tally),
            refused: tally.refused,
            left_out,
            robots,
        }
    }

    /// Returns the number of robots, diagnosed or not.
    pub fn count(&self) -> usize {
        self.diagnosed + self.refused.len()
    }
}
