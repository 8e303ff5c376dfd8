//! Answers a challenge: learns each robot's simulator from its own logs and diagnoses every case.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;

use super::seal::Published;
use super::{Counter, Folder};
use crate::error::Result;
use crate::files;
use crate::gap::{Method, findings};
use crate::inspection::Inspection;
use crate::learn::train::{TABLE_ONE, Trainer, train};
use crate::logs::Logs;
use crate::simulator::Simulator;
use crate::simulator::baseline::Baseline;

/// Seed of the training.
const SEED: u64 = 1;

/// Diagnoses all cases and returns their number; `watch` is told how many are done, and of how many.
///
/// # Errors
/// When the folder is not a challenge, or when a diagnosis cannot be written.
pub fn answer(folder: &Path, watch: impl Fn(usize, usize) + Sync) -> Result<usize> {
    let folder = Folder(folder);
    let cases: Vec<Published> = files::read_csv(&folder.cases())?;
    let answers = folder.answers();
    files::make_folder(&answers)?;
    let mut simulators: BTreeMap<&str, Simulator> = BTreeMap::new();
    for case in &cases {
        if !simulators.contains_key(case.robot.as_str()) {
            let simulator = learn(&Logs::read(&folder.robot(&case.robot), |_| {})?)?;
            simulator.write(&folder.simulator(&case.robot))?;
            simulators.insert(&case.robot, simulator);
        }
    }
    let counter = Counter::new(cases.len(), watch);
    cases.par_iter().try_for_each(|case| {
        let logs = Logs::read(&folder.case(&case.case), |_| {})?;
        let baseline = Baseline::learned(&simulators[case.robot.as_str()])?;
        let found = findings(baseline, &Inspection::of(logs), Method::default())?;
        files::write_json(&folder.answer(&case.case), &found.diagnosis)?;
        files::write_json(&folder.added(&case.case), &found.applied)?;
        counter.one_more();
        Ok(())
    })?;
    Ok(cases.len())
}

/// Learns a robot's simulator from its own logs.
///
/// # Errors
/// When the logs support no network.
pub fn learn(logs: &Logs) -> Result<Simulator> {
    train(logs, &Trainer::Fast, &TABLE_ONE, SEED, |_| {})
}
