//! `mindgap train`

use std::path::Path;

use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Serial;
use mindgap_learning::learn::train::{NETWORKS, Progress, TABLE_ONE, Trainer, train_sensors};

use crate::report::{Answer, Report, Reporter, read_logs};

/// Seed of the training, as that of the subcommand.
const SEED: u64 = 1;
/// Name of the simulator file.
const FILE: &str = "simulator.json";

/// Trains a simulator on a folder of logs.
///
/// # Errors
/// When the logs cannot be used.
pub fn answer(folder: &Path, report: Reporter) -> Result<Answer> {
    let warn = |found| report(Report::Warning(format!("{}: {found}", folder.display())));
    let heard = read_logs(folder, report)?.usable_by_sensor(warn).map_err(|error| error.or_in_file(folder))?;
    let watch = |Progress { network, .. }| {
        let place = NETWORKS.iter().position(|name| *name == network).unwrap_or(NETWORKS.len());
        report(Report::Progress(place as f64 / (NETWORKS.len() + 1) as f64, format!("training {network}")));
    };
    let simulator = train_sensors(&Serial, &heard, &Trainer::Fast, &TABLE_ONE, SEED, &watch)?;
    simulator.missing.iter().for_each(|missing| report(Report::Warning(missing.to_string())));
    let text = files::json(Path::new(FILE), &simulator)?;
    Ok(Answer { files: Some([(FILE.into(), text)].into_iter().collect()), ..Answer::default() })
}
