//! Experiments until certain: propose a script, drive it on the robot, diagnose again with its log, until one name is left.
//!
//! The folder is one of logs: `robot.toml`, `scene.toml`, and per run `script-NNN.csv` and `run-NNN.csv`. These files are the
//! whole state, so an interrupted series resumes from them.

mod log_check;

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::closed_loop::log_check::receive;
use log_check::ScriptCheck;
use mindgap_diagnosis::diagnosis::Diagnosis;
use mindgap_diagnosis::progress::Stage;
use mindgap_diagnosis::propose::Experiment;
use mindgap_diagnosis::request::{Answered, Request};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::random::derive;
use mindgap_foundations::statistics::rounding;
use mindgap_logs::sessions::Session;
use mindgap_logs::{Logs, Row, Run};
use mindgap_workers::program::Program;

/// A name with a higher probability and without rivals is the cause: nine of ten such answers and more are right.
const CERTAIN: f64 = 0.9;
/// Number of attempts per run.
const ATTEMPTS: u64 = 2;
/// A robot's command gets a seed below this: a short number is easier to handle for scripts.
const SEEDS: u64 = 1_000_000;

/// The inputs of a series of experiments.
pub struct Series<'a> {
    /// How logs are diagnosed.
    pub request: &'a Request<'a>,
    /// The first logs.
    pub logs: &'a Logs,
    /// Folder in which the scripts and their logs stay, if they should.
    pub folder: Option<&'a Path>,
    /// Maximum number of runs in the folder.
    pub runs: usize,
    /// The robot's command: called with a script, the log to write, and a seed.
    pub command: &'a Program,
}

/// Events of a running series.
pub enum Event<'a> {
    /// A diagnosis is at a stage.
    At(Stage),
    /// A script is about to be driven, as the run of this number from 0.
    Driving(usize, &'a Experiment),
    /// After a run the diagnosis of all logs is this.
    Diagnosed(&'a Diagnosis),
    /// An attempt failed.
    Failed(usize, &'a Error),
}

/// A run that was driven.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DrivenScript {
    /// File of its log in the folder.
    pub log: String,
    /// The script, described in words.
    pub script: String,
    /// The two most likely names before it; `no_gap` is the simulator as it is.
    pub between: [&'static str; 2],
    /// Information that it was expected to give about which name is the cause, nats.
    #[serde(serialize_with = "rounding::number")]
    pub expected_nats: f64,
    /// The effects that are named with its log.
    pub names: Vec<NameAfter>,
}

/// An effect that is named after a run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NameAfter {
    /// Its id.
    pub id: &'static str,
    /// Its probability.
    #[serde(serialize_with = "rounding::number")]
    pub probability: f64,
}

/// How a series ended.
pub struct Ended {
    /// The diagnosis of all logs.
    pub answered: Answered,
    /// The runs that were driven by this call.
    pub driven: Vec<DrivenScript>,
    /// Number of runs in the folder.
    pub runs: usize,
    /// Why it ended.
    pub reason: Reason,
}

/// Why a series ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// One name is left.
    Certain,
    /// All runs are used up.
    RunsExhausted,
    /// No script would say which name is the cause, or there is no gap.
    NothingToDecide,
}

/// Returns whether a folder holds a series, which is resumed.
pub fn is_series(folder: &Path) -> bool {
    folder.join(script_file(0)).is_file()
}

/// Drives experiments until one name is left or the runs are used up.
///
/// # Errors
/// If the logs cannot be diagnosed, the folder holds other logs or is in use, a file cannot be written, or the robot fails twice
/// in a row.
pub fn run(series: &Series, mut on_event: impl FnMut(Event)) -> Result<Ended> {
    let temporary = tempfile::tempdir().map_err(|e| Error::new(format!("no temporary folder can be made: {e}")))?;
    let series = &Drives { series, folder: series.folder.unwrap_or(temporary.path()) };
    files::make_folder(series.folder)?;
    let _lock = files::lock_folder(series.folder)?;
    let mut runs = series.resumed()?;
    let mut driven: Vec<DrivenScript> = Vec::new();
    loop {
        let answered = series.diagnosed(&runs, &mut on_event)?;
        if let Some(last) = driven.last_mut() {
            last.names = names(&answered.findings.diagnosis);
            on_event(Event::Diagnosed(&answered.findings.diagnosis));
        }
        let proposal = answered.findings.proposal.clone();
        let reason = match &proposal {
            _ if is_certain(&answered.findings.diagnosis) => Some(Reason::Certain),
            _ if runs.len() >= series.series.runs => Some(Reason::RunsExhausted),
            None => Some(Reason::NothingToDecide),
            Some(_) => None,
        };
        let (None, Some(experiment)) = (reason, proposal) else {
            let reason = reason.unwrap_or(Reason::NothingToDecide);
            return Ok(Ended { answered, driven, runs: runs.len(), reason });
        };
        let number = runs.len();
        runs.push(series.drive(number, &experiment, &mut on_event)?);
        let Experiment { between, script, information_nats, .. } = experiment;
        let log = log_file(number);
        driven.push(DrivenScript { log, script, between, expected_nats: information_nats, names: Vec::new() });
    }
}

/// Returns whether one name is left.
pub fn is_certain(diagnosis: &Diagnosis) -> bool {
    let has_rivals = diagnosis.effects.iter().any(|effect| !effect.ambiguous_with.is_empty());
    diagnosis.effects.first().is_some_and(|first| first.probability > CERTAIN) && !has_rivals
}

fn names(diagnosis: &Diagnosis) -> Vec<NameAfter> {
    diagnosis.effects.iter().map(|effect| NameAfter { id: effect.id, probability: effect.probability }).collect()
}

fn script_file(number: usize) -> String {
    format!("script-{number:03}.csv")
}

fn log_file(number: usize) -> String {
    format!("run-{number:03}.csv")
}

/// A series in its folder.
struct Drives<'a> {
    series: &'a Series<'a>,
    folder: &'a Path,
}

impl Drives<'_> {
    /// Returns the path of a file in the folder.
    fn file(&self, name: &str) -> Result<PathBuf> {
        files::in_folder(self.folder, name)
    }

    /// Reads the runs of the series that the folder holds.
    fn resumed(&self) -> Result<Vec<Run>> {
        if !is_series(self.folder) {
            return Ok(Vec::new());
        }
        let (robot, scene) = (self.file("robot.toml")?, self.file("scene.toml")?);
        for (path, text) in [
            (&robot, self.series.logs.robot.to_text_with(&self.series.logs.sensors())),
            (&scene, self.series.logs.scene.to_text()),
        ] {
            if path.exists() && files::read_text(path)? != text {
                let what = "differs from that of the first logs: give another folder to --out";
                return Err(Error::in_file(path, what));
            }
        }
        let mut runs = Vec::new();
        while self.file(&log_file(runs.len()))?.exists() {
            runs.push(self.named(self.series.logs.read_further(&self.file(&log_file(runs.len()))?)?));
        }
        Ok(runs)
    }

    /// Gives a run the name of its session, where the first logs are of several.
    fn named(&self, run: Run) -> Run {
        if !self.has_sessions() {
            return run;
        }
        let session = Session { folder: self.folder.to_owned(), conditions: Default::default() };
        Run { name: format!("{}/{}", session.prefix(), run.name), rows: run.rows }
    }

    fn has_sessions(&self) -> bool {
        self.series.logs.runs.iter().any(|run| !run.session().is_empty())
    }

    fn diagnosed(&self, runs: &[Run], on_event: &mut impl FnMut(Event)) -> Result<Answered> {
        let mut logs = self.series.logs.clone();
        // Of several sessions every fourth is held out, and never the first: these runs are for deciding.
        let at = if self.has_sessions() { 0 } else { logs.runs.len() };
        logs.runs.splice(at..at, runs.iter().cloned());
        // The stages of a diagnosis are reported from where nothing else borrows.
        let reporting = RefCell::new(on_event);
        self.series.request.of(logs, |stage| {
            let mut report = reporting.borrow_mut();
            report(Event::At(stage));
        })
    }

    /// Writes the script of a run and drives it; a failure is repeated once.
    fn drive(&self, number: usize, experiment: &Experiment, on_event: &mut impl FnMut(Event)) -> Result<Run> {
        let script = with_rest(&experiment.commands);
        let path = self.file(&script_file(number))?;
        files::write(&path, script.script_text())?;
        self.series.logs.robot.write(&self.file("robot.toml")?)?;
        files::write(&self.file("scene.toml")?, self.series.logs.scene.to_text())?;
        on_event(Event::Driving(number, experiment));
        let mut attempt = 0;
        loop {
            attempt += 1;
            match self.attempt(number, attempt, &path, &script) {
                Ok(run) => return Ok(self.named(run)),
                Err(error) => {
                    on_event(Event::Failed(number, &error));
                    if attempt == ATTEMPTS {
                        let what = format!("{} failed {ATTEMPTS} times, stopped: {error}", log_file(number));
                        return Err(Error::new(what));
                    }
                }
            }
        }
    }

    /// Calls the robot's command once and keeps its log if it is one of this script.
    fn attempt(&self, number: usize, attempt: u64, path: &Path, script: &Run) -> Result<Run> {
        let unusable = format!("failed-{number:03}-attempt-{attempt}.csv");
        let log = self.file(&unusable)?;
        // Whatever appears in a folder of its own is of this attempt.
        let own_folder = files::StagingFolder::in_folder(self.folder)
            .map_err(|e| Error::in_file(self.folder, format!("cannot be written: {e}")))?;
        let out = own_folder.new_folder().join(log_file(number));
        let seed = (derive(self.series.request.method.seed, &[number as u64, attempt]) % SEEDS).to_string();
        let [script_path, out_path] = [files::absolute(path)?, files::absolute(&out)?];
        self.series.command.run(&[script_path.as_ref(), out_path.as_ref(), seed.as_ref()])?;
        receive(&out, &log)?;
        let run = ScriptCheck { first: self.series.logs, script }.read(&log)?;
        let place = self.file(&log_file(number))?;
        fs::rename(&log, &place).map_err(|e| Error::in_file(&place, format!("cannot be written: {e}")))?;
        Ok(Run { name: format!("run-{number:03}"), rows: run.rows })
    }
}

/// Appends the row in which the robot is at rest, a step after the others.
fn with_rest(commands: &Run) -> Run {
    let rows = &commands.rows;
    let step_ms = rows.at(1).t_ms - rows.at(0).t_ms;
    let rest = Row { t_ms: rows.at(rows.len() - 1).t_ms + step_ms, ..Row::default() };
    Run { name: commands.name.clone(), rows: rows.iter().chain([rest]).collect() }
}
