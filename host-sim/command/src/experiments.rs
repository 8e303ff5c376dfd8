//! The options of `mindgap diagnose` that drive scripts on a robot until one name is left.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, value_parser};

use super::compare::seconds;
use super::logging::status;
use super::table::count;
use super::{progress, warn};
use mindgap_applications::experiments::{self, Ended, Event, Reason, Series};
use mindgap_diagnosis::diagnosis::Diagnosis;
use mindgap_diagnosis::propose::Experiment;
use mindgap_diagnosis::request::Request;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_logs::Logs;
use mindgap_pages::words;
use mindgap_workers::program::Program;

/// A robot that is driven until one name is left.
#[derive(Args)]
pub struct DriveOptions {
    /// Drive proposed scripts on the robot until one cause is left: Mindgap calls COMMAND SCRIPT.csv OUT.csv SEED, which must
    /// drive the script once and write its log. Quotes group words as in a shell, but no shell is started.
    #[arg(long, value_name = "COMMAND", requires = "runs", conflicts_with = "controller")]
    drive: Option<String>,
    /// Maximum number of runs to drive.
    #[arg(long, value_name = "N", requires = "drive", value_parser = value_parser!(u32).range(1..=999))]
    runs: Option<u32>,
    /// Folder to keep the scripts and their logs in. If it contains those of an earlier call, that series is resumed.
    #[arg(long, value_name = "DIR", requires = "drive")]
    out: Option<PathBuf>,
    /// Timeout of one call of the command, s. It then receives SIGTERM, with everything that it started, and SIGKILL three
    /// seconds later.
    #[arg(long, value_name = "S", default_value_t = 600.0, value_parser = seconds)]
    command_timeout: f64,
}

impl DriveOptions {
    /// Adds the folder of the series. One that is resumed is not filled.
    pub fn places(&self, places: Places) -> Places {
        places.filling(self.out.as_ref().filter(|folder| !experiments::is_series(folder)))
    }

    /// Returns whether a robot is driven.
    pub fn is_driving(&self) -> bool {
        self.drive.is_some()
    }

    /// Returns the folder in which the series stays, if it should.
    pub fn folder(&self) -> Option<&PathBuf> {
        self.out.as_ref()
    }

    /// Drives a series and returns how it ended, or `None` if none was asked for.
    ///
    /// # Errors
    /// As [`experiments::run`].
    pub fn driven(&self, request: &Request, logs: &Logs) -> Result<Option<Ended>> {
        let (Some(command), Some(runs)) = (&self.drive, self.runs) else { return Ok(None) };
        let folder = self.out.as_deref();
        let timeout = Duration::from_secs_f64(self.command_timeout);
        let command = &Program::new("the robot's command", command, timeout)?;
        let series = Series { request, logs, folder, runs: runs as usize, command };
        let bar = progress::shares();
        let ended = experiments::run(&series, |event| match event {
            Event::At(stage) => progress::at(&bar, stage.share_before(), stage.words().into()),
            Event::Driving(number, experiment) => status(&of_script(number, runs, experiment)),
            Event::Diagnosed(diagnosis) => status(&now(diagnosis)),
            Event::Failed(number, error) => warn(format!("run {}: failed, nothing learned: {error}", number + 1)),
        });
        bar.finish_and_clear();
        ended.map(Some)
    }

    /// Says how a series ended.
    pub fn text(&self, ended: &Ended) -> String {
        let runs = count(ended.runs, "run");
        let folder = self.out.as_ref().map_or_else(String::new, |folder| format!(" in {}", folder.display()));
        let end = match ended.reason {
            Reason::Certain => "one name is left",
            Reason::RunsExhausted => "the runs are used up, and no name is certain",
            Reason::NothingToDecide => "no script would say more about the cause",
        };
        format!("After {runs}{folder}: {end}.\n")
    }
}

/// Describes a script that is about to be driven, and where the robot has room for it.
fn of_script(number: usize, runs: u32, experiment: &Experiment) -> String {
    let Experiment { between: [one, other], script, information_nats, commands, .. } = experiment;
    let start = commands.rows.first().and_then(|row| row.pose).map_or_else(String::new, |pose| {
        let [x, y] = pose.position_cm.to_array();
        format!(", with room from ({x:.0}, {y:.0}) cm at {:.0} degrees", pose.heading_rad.to_degrees())
    });
    format!(
        "run {} of {runs}: driving {script}{start}; {one} or {other}, {information_nats:.2} nats expected",
        number + 1
    )
}

/// Returns the names after a run.
fn now(diagnosis: &Diagnosis) -> String {
    let names: Vec<String> =
        diagnosis.effects.iter().map(|effect| format!("{} {:.0} %", effect.id, 100.0 * effect.probability)).collect();
    if names.is_empty() { words::verdict(diagnosis.verdict).into() } else { names.join(", ") }
}
