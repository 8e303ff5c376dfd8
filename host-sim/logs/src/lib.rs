//! Robot logs: the only interface between reality and simulator (docs/formats.md, "A folder of logs").
//!
//! A folder holds a [`Robot`] (`robot.toml`), a [`Scene`] (`scene.toml`) and one [`Run`] a file (`run-*.csv`). Networks
//! learn from the [`samples`] extracted from it.

mod columns;
pub mod inspection;
pub mod readings;
mod resample;
pub mod robot;
mod row;
pub mod rows;
pub mod run;
pub mod samples;
pub mod scene;
pub mod tables;
pub mod world_script;

use std::fs;
use std::path::Path;

pub use robot::{Robot, Ultrasonic};
pub use row::Row;
pub use rows::Rows;
pub use run::Run;
pub use scene::Scene;
use serde::{Deserialize, Serialize};

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

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

/// The files of a folder of logs: name and text of each.
#[derive(Serialize, Deserialize)]
pub struct Texts(Vec<(String, String)>);

impl Texts {
    /// Writes the folder, as [`Logs::write`].
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let ours = |name: &str| is_run_file(name) || name == "robot.toml" || name == "scene.toml";
        let Texts(files) = self;
        files::write_folder(folder, ours, |fresh| {
            files.iter().try_for_each(|(name, text)| files::write(&fresh.join(name), text))
        })
    }
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
        let required = robot.required_columns();
        let mut oddities = Oddities::default();
        let read = |name: &String| {
            let path = folder.join(name);
            Run::read_with(&path, required, |oddity| oddities.add(&path, &oddity))
        };
        let runs = names.iter().map(read).collect::<Result<Vec<_>>>()?;
        oddities.tell(&mut warn);
        Logs { robot, scene, runs }.checked(folder, warn)
    }

    /// The logs without what they cannot have; messages name `folder`.
    fn checked(mut self, folder: &Path, mut warn: impl FnMut(String)) -> Result<Self> {
        let has_sensor = !self.robot.ultrasonic.is_none();
        let count = if has_sensor { 0 } else { self.runs.iter_mut().map(without_readings).sum() };
        if count > 0 {
            let robot = folder.join("robot.toml");
            warn(format!("{}: has no [ultrasonic]: {count} readings are left out", robot.display()));
        }
        self.check_step(folder)?;
        Ok(self)
    }

    /// Writes a folder; logs that are in it already are replaced, and other files stay.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        self.to_texts().write(folder)
    }

    /// The texts of the folder's files.
    pub fn to_texts(&self) -> Texts {
        let runs = self.runs.iter().map(|run| (format!("{}.csv", run.name), run.to_text()));
        let others = [("robot.toml".into(), self.robot.to_text()), ("scene.toml".into(), self.scene.to_text())];
        Texts(others.into_iter().chain(runs).collect())
    }

    /// The number of rows of all runs.
    pub fn rows(&self) -> usize {
        self.runs.iter().map(|run| run.rows.len()).sum()
    }

    /// Checks that rows are about `step_ms` apart; an error names `folder`.
    ///
    /// # Errors
    /// When the median step time deviates from `step_ms` by more than a fifth.
    pub fn check_step(&self, folder: &Path) -> Result<()> {
        let mut steps_ms: Vec<f64> =
            self.runs.iter().flat_map(|run| run.rows.pairs().map(|w| w[1].t_ms - w[0].t_ms)).collect();
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

/// Leaves out a run's readings, and says how many.
fn without_readings(run: &mut Run) -> usize {
    let count = run.rows.iter().filter(|row| row.echo_cm.is_some()).count();
    run.rows.edit_each(|row| row.echo_cm = None);
    count
}

/// What is odd in files, each told once with the first file that has it.
#[derive(Default)]
struct Oddities(Vec<(String, String, usize)>);

impl Oddities {
    fn add(&mut self, path: &Path, oddity: &str) {
        // What is left of it is the same in all files.
        let same = oddity.strip_prefix(&path.display().to_string()).unwrap_or(oddity);
        match self.0.iter_mut().find(|(known, ..)| known == same) {
            Some((.., files)) => *files += 1,
            None => self.0.push((same.to_owned(), oddity.to_owned(), 1)),
        }
    }

    fn tell(self, warn: &mut impl FnMut(String)) {
        for (_, first, files) in self.0 {
            warn(if files == 1 { first } else { format!("{first} (and so in {files} files)") });
        }
    }
}

fn is_run_file(name: &str) -> bool {
    name.starts_with("run-") && name.ends_with(".csv")
}
