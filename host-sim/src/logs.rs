//! Robot logs: the only road between reality and simulator (contracts: a folder of logs).
//!
//! A folder holds [`Robot`] (`robot.toml`), [`Scene`] (`scene.toml`) and one [`Run`] a file (`run-*.csv`); what a
//! network learns from are its [`samples`].

pub mod readings;
pub mod robot;
pub mod run;
pub mod samples;
pub mod scene;

use std::fs;
use std::path::Path;

pub use robot::{Robot, Ultrasonic};
pub use run::{Row, Run};
pub use scene::Scene;

use crate::files;
use crate::problem::{Problem, Result};

/// How far the middle of a folder's step times may be from `step_ms`.
const STEP_TOLERANCE: f64 = 0.2;

/// A robot, the scene it drove in, and what it logged.
#[derive(Clone, Debug, PartialEq)]
pub struct Logs {
    /// The builder's own measurements of the robot.
    pub robot: Robot,
    /// Where the runs took place.
    pub scene: Scene,
    /// The runs, by file name.
    pub runs: Vec<Run>,
}

impl Logs {
    /// Reads a folder. Anything odd that does not stop the reading is told to `warn`, one line each.
    ///
    /// # Errors
    /// When a file is missing or broken, when there is no run, or when the runs' step is not the robot's.
    pub fn read(folder: &Path, mut warn: impl FnMut(String)) -> Result<Self> {
        let robot = Robot::read(&folder.join("robot.toml"))?;
        let scene = Scene::read(&folder.join("scene.toml"))?;
        let listing = fs::read_dir(folder).map_err(|e| Problem::in_file(folder, format!("cannot be read: {e}")))?;
        let mut names: Vec<String> = listing
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| is_run_file(name))
            .collect();
        names.sort();
        if names.is_empty() {
            return Err(Problem::in_file(folder, "has no run-*.csv"));
        }
        let runs = names.iter().map(|name| Run::read(&folder.join(name), &mut warn)).collect::<Result<Vec<_>>>()?;
        let logs = Logs { robot, scene, runs };
        logs.check_step(folder)?;
        Ok(logs)
    }

    /// Writes a folder, whole or not at all; an older folder of logs there is replaced.
    ///
    /// # Errors
    /// When the folder cannot be written or holds files that are no logs.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let ours = |name: &str| is_run_file(name) || name == "robot.toml" || name == "scene.toml";
        files::write_folder(folder, ours, |fresh| {
            self.robot.write(&fresh.join("robot.toml"))?;
            self.scene.write(&fresh.join("scene.toml"))?;
            self.runs.iter().try_for_each(|run| run.write(&fresh.join(format!("{}.csv", run.name))))
        })
    }

    /// Whether rows are about `step_ms` apart; a problem is laid to `folder`.
    ///
    /// # Errors
    /// When the middle of all step times is too far from the robot's.
    pub fn check_step(&self, folder: &Path) -> Result<()> {
        let mut steps_ms: Vec<f64> =
            self.runs.iter().flat_map(|run| run.rows.windows(2).map(|w| w[1].t_ms - w[0].t_ms)).collect();
        steps_ms.sort_by(f64::total_cmp);
        let middle_ms = steps_ms[steps_ms.len() / 2];
        if (middle_ms / self.robot.step_ms - 1.0).abs() > STEP_TOLERANCE {
            let what = format!("rows are {middle_ms} ms apart, but robot.toml has step_ms = {}", self.robot.step_ms);
            return Err(Problem::in_file(folder, what));
        }
        Ok(())
    }
}

fn is_run_file(name: &str) -> bool {
    name.starts_with("run-") && name.ends_with(".csv")
}
