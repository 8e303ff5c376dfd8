//! The answer for a fleet as data, and as it is written.

use std::collections::BTreeMap;

use serde::Serialize;

use super::common::{Common, common};
use super::frequency::{Frequency, frequencies};
use super::groups::groups;
use super::outliers::{Outlier, outliers};
use super::spread::{Spread, Told};
use super::tally::{Refused, Tally};
use crate::gap::verdict::Verdict;
use crate::statistics::rounding;

/// Version of the JSON.
const SCHEMA: u32 = 1;

/// What `mindgap diagnose --fleet` finds; docs/formats.md has the JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Fleet {
    schema: u32,
    /// Robots that were diagnosed.
    pub diagnosed: usize,
    /// How many of them have which answer.
    pub verdicts: BTreeMap<&'static str, usize>,
    /// The sizes of their gaps, nats a step; none where no robot has one.
    pub gap_nats: Option<Told>,
    /// The effects that were named, the most frequent first.
    pub effects: Vec<Frequency>,
    /// What nearly all robots have alike: the simulator's fault.
    pub common: Vec<Common>,
    /// Robots whose gaps are made of the same things, the largest group first.
    pub groups: Vec<Group>,
    /// Robots that stand out, the furthest first.
    pub stands_out: Vec<Outlier>,
    /// Robots that could not be diagnosed.
    pub refused: Vec<Refused>,
    /// What else lies beside the robots' folders.
    pub left_out: Vec<String>,
    /// The robots as a page lists them.
    #[serde(skip)]
    pub robots: Vec<Row>,
}

/// Robots whose gaps are made of the same things.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// Mean shares of their gaps, the largest first.
    pub budget: Vec<Share>,
    /// Median size of their gaps, nats a step.
    #[serde(serialize_with = "rounding::optional")]
    pub gap_nats: Option<f64>,
    /// Their names.
    pub robots: Vec<String>,
}

/// A part of a gap.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Its id.
    pub id: &'static str,
    /// Its share.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
}

/// A robot in a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Its answer.
    pub verdict: Verdict,
    /// The size of its gap, nats a step.
    pub gap_nats: Option<f64>,
    /// What its gap is made of, the largest part first.
    pub budget: Vec<Share>,
    /// Its group, from 1.
    pub group: usize,
}

/// Shares below this are not listed.
const WORTH_TELLING: f64 = 0.005;

impl Fleet {
    /// The answer for robots that were diagnosed.
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
            schema: SCHEMA,
            diagnosed: tally.names.len(),
            verdicts,
            gap_nats: gap(&mut (0..tally.names.len())).map(|spread| spread.told()),
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

    /// All robots, diagnosed or not.
    pub fn count(&self) -> usize {
        self.diagnosed + self.refused.len()
    }
}
