//! Answers a challenge: trains a simulator on each robot's logs and diagnoses every case.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::Folder;
use mindgap_diagnosis::{Method, findings};
use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::{self, Executor};
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_logs::Logs;
use mindgap_logs::inspection::Inspection;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::Baseline;

/// Seed of the training.
const SEED: u64 = 1;

/// Diagnoses all cases and returns their number. `watch` is called with the number of finished cases and the total.
///
/// # Errors
/// If the folder is not a challenge, or a diagnosis cannot be written.
pub fn answer(executor: &dyn Executor, folder: &Path, mut watch: impl FnMut(usize, usize)) -> Result<usize> {
    let folder = Folder(folder);
    let cases = folder.published()?;
    let robots: BTreeSet<&str> = cases.iter().map(|case| case.robot.as_str()).collect();
    let robots = Vec::from_iter(robots);
    let learned = executor::map(executor, robots.len(), |robot| {
        learn(executor, &Logs::read(&folder.robot(robots[robot]), |_| {})?)
    })?;
    let simulators: BTreeMap<&str, &Simulator> = robots.into_iter().zip(&learned).collect();
    let diagnose = |number: usize| {
        let case = &cases[number];
        let logs = Logs::read(&folder.case(&case.case), |_| {})?;
        let baseline = Baseline::at_posterior_mean(simulators[case.robot.as_str()])?;
        let found = findings(baseline, &Inspection::new(logs), Method::default())?;
        let [answer, added] = [folder.answer(&case.case), folder.added(&case.case)];
        Ok([files::json(&answer, &found.diagnosis)?, files::json(&added, &found.applied)?])
    };
    files::write_folder(
        &folder.answers(),
        |name| name.ends_with(".json"),
        |fresh| {
            for (robot, simulator) in &simulators {
                simulator.write(&at(fresh, &folder.simulator(robot)))?;
            }
            executor::in_order(executor, cases.len(), diagnose, |number, [answer, added]: [String; 2]| {
                let case = &cases[number].case;
                files::write(&at(fresh, &folder.answer(case)), answer)?;
                files::write(&at(fresh, &folder.added(case)), added)?;
                watch(number + 1, cases.len());
                Ok(())
            })
        },
    )?;
    Ok(cases.len())
}

/// Returns the path of a file in the staging folder.
fn at(fresh: &Path, file: &Path) -> PathBuf {
    fresh.join(file.file_name().unwrap_or_default())
}

/// Trains a robot's simulator on its logs.
///
/// # Errors
/// If the logs do not suffice for any network.
pub fn learn(executor: &dyn Executor, logs: &Logs) -> Result<Simulator> {
    train(executor, logs, &Trainer::Fast, &TABLE_ONE, SEED, &|_| {})
}
