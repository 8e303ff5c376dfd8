//! Generates a challenge: robots with logs to learn a simulator from, and cases that may have effects.

use std::path::Path;

use rand::Rng;

use super::Folder;
use super::cases::{self, Setting};
use super::seal::{Published, Sealed};
use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::{self, Executor};
use mindgap_logs::LogFiles;

/// Writes a challenge of `count` cases to a folder. `watch` is called with the number of finished cases and the total.
///
/// # Errors
/// If the folder cannot be written or a case cannot be recorded.
pub fn make(
    executor: &dyn Executor,
    folder: &Path,
    count: usize,
    seed: u64,
    setting: Setting,
    mut watch: impl FnMut(usize, usize),
) -> Result<()> {
    let ours = |name: &str| ["robots", "cases", "cases.csv", "sealed.json", "answers"].contains(&name);
    files::write_folder(folder, ours, |fresh| {
        fill(executor, &Folder(fresh), count, seed, setting, |done| watch(done, count))
    })
}

fn fill(
    executor: &dyn Executor,
    folder: &Folder,
    count: usize,
    seed: u64,
    setting: Setting,
    mut watch: impl FnMut(usize),
) -> Result<()> {
    let robots = cases::robots(seed, setting)?;
    for (robot, logs) in robots.iter().enumerate() {
        logs.write(&folder.robot(&robot.to_string()))?;
    }
    let effects = cases::effects(count, seed, setting.outside);
    let make = |number: usize| {
        let mut made = cases::case(number, &effects[number], &robots, setting, seed)?;
        let sealed = Sealed {
            case: format!("{number:03}"),
            effects: made.effects.iter().map(ToString::to_string).collect(),
            driving: made.driving.name.into(),
            fresh_seed: made.rng.next_u64(),
            salt: format!("{:016x}", made.rng.next_u64()),
        };
        Ok((made.logs.to_files(), made.robot, sealed))
    };
    let (mut sealed, mut published) = (Vec::with_capacity(count), Vec::with_capacity(count));
    executor::in_order(executor, count, make, |number, (logs, robot, case): (LogFiles, usize, Sealed)| {
        logs.write(&folder.case(&case.case))?;
        published.push(Published { case: case.case.clone(), robot: robot.to_string(), commitment: case.commitment() });
        sealed.push(case);
        watch(number + 1);
        Ok(())
    })?;
    files::write_json(&folder.sealed(), &sealed)?;
    files::write_csv(&folder.cases(), &published)
}
