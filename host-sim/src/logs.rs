//! Robot logs: the only interface between reality and simulator (docs/formats.md, "A folder of logs").
//!
//! A folder holds a [`Robot`] (`robot.toml`), a [`Scene`] (`scene.toml`) and one [`Run`] a file (`run-*.csv`). Networks
//! learn from the [`samples`] extracted from it.

pub mod readings;
mod resample;
pub mod robot;
pub mod run;
pub mod samples;
pub mod scene;
pub mod world_script;

use std::fs;
use std::path::Path;

pub use robot::{Robot, Ultrasonic};
pub use run::{Row, Run};
pub use scene::Scene;

use crate::error::{Error, Result};
use crate::files;

/// Largest relative deviation of the median step time from `step_ms`.
const STEP_TOLERANCE: f64 = 0.2;

/// A robot, the scene it drove in, and its runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Logs {
    /// The robot as measured by its builder.
    pub robot: Robot,
    /// Where the runs took place.
    pub scene: Scene,
    /// The runs, by file name.
    pub runs: Vec<Run>,
}

impl Logs {
    /// Reads a folder. `warn` receives one line for each oddity that does not prevent reading.
    ///
    /// # Errors
    /// When a file cannot be read or parsed, when there is no run, or as [`check_step`](Self::check_step).
    pub fn read(folder: &Path, mut warn: impl FnMut(String)) -> Result<Self> {
        let robot = Robot::read(&folder.join("robot.toml"))?;
        let scene = Scene::read(&folder.join("scene.toml"))?;
        let listing = fs::read_dir(folder).map_err(|e| Error::in_file(folder, format!("cannot be read: {e}")))?;
        let mut names: Vec<String> = listing
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| is_run_file(name))
            .collect();
        names.sort();
        if names.is_empty() {
            return Err(Error::in_file(folder, "has no run-*.csv"));
        }
        let runs = names.iter().map(|name| Run::read(&folder.join(name), &mut warn)).collect::<Result<Vec<_>>>()?;
        let logs = Logs { robot, scene, runs };
        logs.check_step(folder)?;
        Ok(logs)
    }

    /// Writes a folder atomically; an existing folder of logs is replaced.
    ///
    /// # Errors
    /// When the folder cannot be written or holds other files.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let ours = |name: &str| is_run_file(name) || name == "robot.toml" || name == "scene.toml";
        files::write_folder(folder, ours, |fresh| {
            self.robot.write(&fresh.join("robot.toml"))?;
            self.scene.write(&fresh.join("scene.toml"))?;
            self.runs.iter().try_for_each(|run| run.write(&fresh.join(format!("{}.csv", run.name))))
        })
    }

    /// Checks that rows are about `step_ms` apart; an error names `folder`.
    ///
    /// # Errors
    /// When the median step time deviates from `step_ms` by more than a fifth.
    pub fn check_step(&self, folder: &Path) -> Result<()> {
        let mut steps_ms: Vec<f64> =
            self.runs.iter().flat_map(|run| run.rows.windows(2).map(|w| w[1].t_ms - w[0].t_ms)).collect();
        steps_ms.sort_by(f64::total_cmp);
        let middle_ms = steps_ms[steps_ms.len() / 2];
        if (middle_ms / self.robot.step_ms - 1.0).abs() > STEP_TOLERANCE {
            let mut what =
                format!("rows are {middle_ms} ms apart, but robot.toml has step_ms = {}", self.robot.step_ms);
            if (1000.0 * middle_ms / self.robot.step_ms - 1.0).abs() <= STEP_TOLERANCE {
                what += ": t_ms seems to be in seconds; write milliseconds";
            }
            return Err(Error::in_file(folder, what));
        }
        Ok(())
    }
}

fn is_run_file(name: &str) -> bool {
    name.starts_with("run-") && name.ends_with(".csv")
}
