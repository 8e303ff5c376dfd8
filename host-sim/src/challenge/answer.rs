//! Answers a challenge: learns each robot's simulator from its own logs and diagnoses every case.

use std::fs;
use std::path::Path;

use super::Folder;
use super::seal::Published;
use crate::files;
use crate::gap::baseline::Baseline;
use crate::gap::diagnose;
use crate::learn::train::{TABLE_ONE, Trainer, train};
use crate::logs::Logs;
use crate::problem::{Problem, Result};
use crate::simulator::Simulator;

/// Seeds the training.
const SEED: u64 = 1;

/// Diagnoses all cases; `watch` is told how many are done.
///
/// # Errors
/// When the folder is no challenge, or when an answer cannot be written.
pub fn answer(folder: &Path, mut watch: impl FnMut(usize)) -> Result<usize> {
    let folder = Folder(folder);
    let cases: Vec<Published> = files::read_csv(&folder.cases())?;
    let mut simulators: Vec<(String, Simulator)> = Vec::new();
    let answers = folder.answer("").parent().map(Path::to_path_buf).unwrap_or_default();
    fs::create_dir_all(&answers).map_err(|e| Problem::in_file(&answers, format!("cannot be made: {e}")))?;
    for (done, case) in cases.iter().enumerate() {
        if !simulators.iter().any(|(robot, _)| *robot == case.robot) {
            let logs = Logs::read(&folder.robot(&case.robot), |_| {})?;
            simulators.push((case.robot.clone(), train(&logs, &Trainer::Fast, &TABLE_ONE, SEED, |_| {})?));
        }
        for (_, simulator) in simulators.iter().filter(|(robot, _)| *robot == case.robot) {
            let logs = Logs::read(&folder.case(&case.case), |_| {})?;
            let diagnosis = diagnose(Baseline::learned(simulator)?, &logs)?;
            files::write_json(&folder.answer(&case.case), &diagnosis)?;
        }
        watch(done + 1);
    }
    Ok(cases.len())
}
