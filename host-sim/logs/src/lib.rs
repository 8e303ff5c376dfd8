//! Robot logs: the only interface between reality and simulator (docs/reference/formats.md, "A folder of logs").
//!
//! A folder contains a [`Robot`] (`robot.toml`), a [`Scene`] (`scene.toml`) and one [`Run`] per `run-*.csv`. Networks learn from
//! the [`samples`] extracted from it.

mod columns;
pub mod commands;
pub mod controller_file;
pub mod heard;
pub mod inspection;
mod mixed_rows;
pub mod range_sensor;
pub mod readings;
mod resample;
pub mod robot;
mod row;
pub mod rows;
pub mod run;
pub mod samples;
pub mod scene;
pub mod sessions;
pub mod tables;
mod termination;
mod ultrasonic;
pub mod without_names;
pub mod world_script;

use std::path::Path;
use std::sync::Arc;

pub use commands::{CommandChange, CommandChanges};
pub use robot::Robot;
pub use row::Row;
pub use rows::Rows;
pub use run::Run;
pub use scene::Scene;
use serde::{Deserialize, Serialize};
pub use termination::Termination;
pub use ultrasonic::Ultrasonic;

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// Largest relative deviation of the median step time from `step_ms`.
const STEP_TOLERANCE: f64 = 0.2;

/// Rows differ from the means of a run's commands by less than this: times in whole milliseconds move the mean of a full
/// reversal by half a percent at 400 ms, at both ends of a row.
const MEANS_WITHIN: f64 = 2.0;

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

/// The files of a log folder, as name and text.
#[derive(Serialize, Deserialize)]
pub struct LogFiles(Vec<(String, String)>);

impl FromIterator<(String, String)> for LogFiles {
    fn from_iter<I: IntoIterator<Item = (String, String)>>(files: I) -> Self {
        LogFiles(files.into_iter().collect())
    }
}

impl LogFiles {
    /// Writes the folder; see [`Logs::write`].
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let LogFiles(files) = self;
        files::write_folder(folder, is_own_file, |new_folder| {
            files.iter().try_for_each(|(name, text)| files::write(&new_folder.join(name), text))
        })
    }
}

impl Logs {
    /// Reads a folder. `warn` receives one line for each irregularity that does not prevent reading.
    ///
    /// # Errors
    /// When a file cannot be read or parsed, when there is no run, or when [`check_step`](Self::check_step) fails.
    pub fn read(folder: &Path, mut warn: impl FnMut(String)) -> Result<Self> {
        if files::source::is_file(folder) {
            let what = recording_to_import(folder).unwrap_or("are the arguments exchanged?".into());
            return Err(Error::in_file(folder, format!("is a file, not a folder of logs: {what}")));
        }
        let (robot, sensors) = Robot::read_all(&folder.join("robot.toml"))?;
        let scene = Scene::read(&folder.join("scene.toml"))?;
        let names = files::source::names(folder).map_err(|e| files::unreadable(folder, &e))?;
        let (names, others): (Vec<String>, Vec<String>) = names.into_iter().partition(|name| is_run_file(name));
        let similar: Vec<&str> = others.iter().map(String::as_str).filter(|name| is_like_run_file(name)).collect();
        let passed_over =
            || format!("passed over {}: runs are named run-NNN.csv, in lower case, unpacked", similar.join(", "));
        if names.is_empty() {
            let why = if similar.is_empty() { String::new() } else { format!("; {}", passed_over()) };
            return Err(Error::in_file(folder, format!("has no run-*.csv{why}")));
        }
        if !similar.is_empty() {
            warn(format!("{}: {}", folder.display(), passed_over()));
        }
        let required = robot.required_columns(&sensors);
        let sensors = Arc::new(sensors);
        let mut warnings = Warnings::default();
        let read = |name: &String| {
            let path = folder.join(name);
            Run::read_of(&path, required, &sensors, |warning| warnings.add(&path, &warning))
        };
        let (mut runs, have_echoes): (Vec<Run>, Vec<_>) =
            names.iter().map(read).collect::<Result<Vec<_>>>()?.into_iter().unzip();
        for name in &others {
            let Some(run) = commands::run_beside(name) else { continue };
            let path = folder.join(name);
            let driven = runs.iter_mut().find(|known| known.name == run);
            let driven = driven.ok_or_else(|| Error::in_file(&path, format!("there is no {run}.csv beside it")))?;
            read_commands(driven, &path, |warning| warnings.add(&path, &warning))?;
        }
        warnings.report(&mut warn);
        if !sensors.are_usual() {
            heard::silence_incomplete(&mut runs, &have_echoes, |what| warn(format!("{}: {what}", folder.display())));
        }
        Logs { robot, scene, runs }.checked(folder, warn)
    }

    /// Reads another run of the same robot.
    ///
    /// # Errors
    /// As [`Run::read`].
    pub fn read_further(&self, path: &Path) -> Result<Run> {
        let sensors = Arc::new(self.sensors());
        Run::read_of(path, self.robot.required_columns(&sensors), &sensors, |_| ()).map(|(run, _)| run)
    }

    /// Validates logs and drops readings of a robot without a sensor; messages name `folder`.
    fn checked(mut self, folder: &Path, mut warn: impl FnMut(String)) -> Result<Self> {
        let has_sensor = self.robot.ultrasonic.is_some();
        let count = if has_sensor { 0 } else { self.runs.iter_mut().map(remove_readings).sum() };
        if count > 0 {
            let robot = folder.join("robot.toml");
            warn(format!("{}: has no [ultrasonic]: {count} readings ignored", robot.display()));
        }
        self.check_step(folder)?;
        let placed = mixed_rows::take_apart(&mut self.runs, self.robot.step_ms);
        if placed > 0 {
            let what = "commands changed within rows, which hold means: the times of";
            warn(format!("{}: {what} {placed} changes follow from both wheels", folder.display()));
        }
        Ok(self)
    }

    /// Writes a folder, replacing logs already in it; other files stay.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        self.to_files().write(folder)
    }

    /// Returns the files of the folder.
    pub fn to_files(&self) -> LogFiles {
        let others = [
            ("robot.toml".into(), self.robot.to_text_with(&self.sensors())),
            ("scene.toml".into(), self.scene.to_text()),
        ];
        others.into_iter().chain(self.runs.iter().flat_map(Run::files)).collect()
    }

    /// Returns the number of rows of all runs.
    pub fn rows(&self) -> usize {
        self.runs.iter().map(|run| run.rows.len()).sum()
    }

    /// Checks that rows are about `step_ms` apart; the error names `folder`.
    ///
    /// # Errors
    /// When the median step time deviates from `step_ms` by more than a fifth.
    pub fn check_step(&self, folder: &Path) -> Result<()> {
        let mut steps_ms: Vec<f64> =
            self.runs.iter().flat_map(|run| run.rows.pairs().map(|w| w[1].t_ms - w[0].t_ms)).collect();
        steps_ms.sort_by(f64::total_cmp);
        let median_ms = steps_ms[steps_ms.len() / 2];
        if (median_ms / self.robot.step_ms - 1.0).abs() > STEP_TOLERANCE {
            let mut message =
                format!("rows are {median_ms} ms apart, but robot.toml has step_ms = {}", self.robot.step_ms);
            if (1000.0 * median_ms / self.robot.step_ms - 1.0).abs() <= STEP_TOLERANCE {
                message += ": t_ms seems to be in seconds; write milliseconds";
            }
            return Err(Error::in_file(folder, message));
        }
        Ok(())
    }
}

/// Returns the command that imports a recording; `None` if the file is not named like one.
pub fn recording_to_import(file: &Path) -> Option<String> {
    let name = file.file_name()?.to_string_lossy().to_lowercase();
    let ends_with = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
    let way = match () {
        () if ends_with(&[".mcap", ".db3", ".bag", ".mcap.zstd", ".mcap.zst"]) => "bag",
        () if ends_with(&[".csv", ".csv.gz", ".tsv", ".tum", ".txt"]) => "streams",
        () => return None,
    };
    Some(format!("import it with `mindgap import {way} {} --out logs`", file.display()))
}

/// Reads the commands of a run at their own times, which replace those of its rows.
fn read_commands(run: &mut Run, path: &Path, mut warn: impl FnMut(String)) -> Result<()> {
    let off = run.rows.set_changes(CommandChanges::read(path, &mut warn)?);
    if off > MEANS_WITHIN {
        let what = "left and right of the run are not the means of these commands, which are used instead";
        warn(format!("{}: {what}", path.display()));
    }
    Ok(())
}

/// Removes a run's readings and returns how many there were.
fn remove_readings(run: &mut Run) -> usize {
    let count = run.rows.iter().filter(|row| row.echo_cm.is_some()).count();
    run.rows.edit_each(|row| row.echo_cm = None);
    count
}

/// Warnings about files, each reported once with the first file affected.
#[derive(Default)]
struct Warnings(Vec<(String, String, usize)>);

impl Warnings {
    fn add(&mut self, path: &Path, warning: &str) {
        // Without the path, the same warning is equal for all files.
        let same = warning.strip_prefix(&path.display().to_string()).unwrap_or(warning);
        match self.0.iter_mut().find(|(known, ..)| known == same) {
            Some((.., files)) => *files += 1,
            None => self.0.push((same.to_owned(), warning.to_owned(), 1)),
        }
    }

    fn report(self, warn: &mut impl FnMut(String)) {
        for (_, first, files) in self.0 {
            warn(if files == 1 { first } else { format!("{first} (in {files} files)") });
        }
    }
}

/// Returns whether a file of this name in a folder of logs is part of them.
pub fn is_own_file(name: &str) -> bool {
    is_run_file(name) || commands::run_beside(name).is_some() || name == "robot.toml" || name == "scene.toml"
}

fn is_run_file(name: &str) -> bool {
    name.starts_with("run-") && name.ends_with(".csv")
}

/// Returns whether a file that is not a run's may be meant as one.
fn is_like_run_file(name: &str) -> bool {
    let lower = name.to_lowercase();
    let is_table = [".csv", ".csv.gz", ".csv.zip", ".tsv", ".txt"].iter().any(|ending| lower.ends_with(ending));
    lower.starts_with("run") && is_table
}
