//! `loop.json`: the history of a loop and all it needs to resume.

use std::path::Path;

use glam::DVec2;
use mindgap_core::controller::Tuple;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::Job;
use crate::adapt::{Cause, Gap};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_learning::evolve::success_probability::{Endings, SuccessProbability};
use mindgap_logs::Termination;
use mindgap_models::effects::applied::AppliedEffect;

/// Version of the format.
const SCHEMA: u32 = 2;
/// File name in the loop's folder.
pub const FILE: &str = "loop.json";

/// The state of a loop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct State {
    /// Version of the file.
    #[schemars(extend("const" = SCHEMA))]
    schema: u32,
    /// SHA-256 of the inputs that determine the loop: simulator, scene, start, seed, step limit.
    job: String,
    /// Status of the loop.
    pub verdict: Verdict,
    /// Simulated success probability of the final controller.
    pub chance: Option<SuccessProbability>,
    /// Success probability of the final controller, updated with the real runs of this and similar controllers.
    #[serde(default)]
    pub chance_with_runs: Option<f64>,
    /// Success with a perfectly known robot; only if the trials were used up.
    #[serde(default)]
    pub oracle: Option<OracleSuccess>,
    /// The trials.
    pub trials: Vec<Trial>,
    /// Failed drives.
    pub failures: Vec<Failure>,
    /// Tuples of the controllers with which the next search begins.
    pub archive: Vec<Vec<Tuple>>,
}

/// Status of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The loop has not ended.
    Running,
    /// A controller succeeded on the robot often enough and has a high success probability.
    Works,
    /// The trials were used up before a controller was confirmed.
    TrialsExhausted,
    /// No controller was found that reaches the target on any plausible robot.
    Infeasible,
}

/// Success of the best controller for each robot of the posterior, as if the robot were known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OracleSuccess {
    /// Mean success probability.
    pub success: f64,
    /// Whether that could be confirmed. If not, process noise is the limit, and further trials will hardly help.
    pub is_enough: bool,
}

/// One trial: a controller on the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Trial {
    /// Number of the trial, from 1.
    pub number: usize,
    /// File of the controller.
    pub controller: String,
    /// File of the log.
    pub log: String,
    /// Success probability before the run.
    pub predicted: SuccessProbability,
    /// Simulated paths on robots of the posterior before the run.
    pub predicted_paths: Vec<SimulatedPath>,
    /// The run on the robot; null until it was driven.
    pub real: Option<DrivenRun>,
    /// Endings of simulated runs before the run.
    #[serde(default)]
    pub predicted_endings: Option<Endings>,
    /// Success probability after adapting to the run.
    pub chance_after: Option<SuccessProbability>,
    /// Endings of simulated runs after adapting to the run.
    #[serde(default)]
    pub endings_after: Option<Endings>,
    /// Success probability after adapting to the run by biases alone; null if no effect on the motion is used.
    #[serde(default)]
    pub chance_without_effects: Option<f64>,
    /// Error per step on held-out runs, before and after adapting to the others.
    pub gap: Option<Gap>,
    /// Effects of a diagnosis of all runs up to this one, as they were added to the simulator.
    pub effects: Vec<AppliedEffect>,
    /// All effects that the diagnosis named, with their probabilities and rivals.
    #[serde(default)]
    pub causes: Vec<Cause>,
}

/// A simulated run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SimulatedPath {
    /// How it ended.
    pub ending: Termination,
    /// Position at the start and after each step, `[x, y]`, cm.
    pub path_cm: Vec<[f64; 2]>,
}

/// A run on the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DrivenRun {
    /// How it ended.
    pub ending: Termination,
    /// Number of steps.
    pub steps: usize,
    /// Final position, x, cm.
    pub end_x_cm: f64,
    /// Final position, y, cm.
    pub end_y_cm: f64,
    /// Final distance to the target, cm.
    pub distance_cm: f64,
    /// Whether it reached the target.
    pub reached: bool,
    /// Tracked position at each row, `[x, y]`, cm.
    pub path_cm: Vec<[f64; 2]>,
}

/// A failed drive, whose log is not used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Failure {
    /// Number of the trial.
    pub trial: usize,
    /// Reason of the failure.
    pub reason: String,
}

impl State {
    /// Reads the state from a job's folder, or returns a new one if there is none.
    ///
    /// # Errors
    /// If a file cannot be read, the folder holds a loop with another simulator, scene, start, seed or step limit, or the state
    /// names other files than its own.
    pub fn open(job: &Job) -> Result<Self> {
        let mut digest = Sha256::new();
        for path in [job.simulator, job.scene] {
            digest.update(files::read_text(path)?);
        }
        digest.update(format!("{} {} {}", job.start, job.seed, job.max_steps));
        let digest = digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        let path = job.folder.join(FILE);
        if !files::in_folder(job.folder, FILE)?.exists() {
            return Ok(State {
                schema: SCHEMA,
                job: digest,
                verdict: Verdict::Running,
                chance: None,
                chance_with_runs: None,
                oracle: None,
                trials: Vec::new(),
                failures: Vec::new(),
                archive: job.known.iter().map(|controller| controller.tuples.to_vec()).collect(),
            });
        }
        let mut state: State = files::read_json(&path)?;
        if state.schema != SCHEMA || state.job != digest {
            let what = "is of a loop with another simulator, scene, start, seed or step limit: give another folder";
            return Err(Error::in_file(&path, what));
        }
        for (trial, number) in state.trials.iter().zip(1..) {
            let planned = Trial::planned(number, trial.predicted, None, Vec::new());
            if (trial.number, &trial.controller, &trial.log) != (number, &planned.controller, &planned.log) {
                let what = format!(
                    "trial {number}: its files must be {} and {} in this folder",
                    planned.controller, planned.log
                );
                return Err(Error::in_file(&path, what));
            }
        }
        if state.verdict == Verdict::TrialsExhausted && state.trials.len() < job.trials {
            state.verdict = Verdict::Running;
            state.oracle = None;
        }
        Ok(state)
    }

    /// Returns the upper limit of the success probability if it is too low to be confirmed.
    pub fn limit(&self) -> Option<f64> {
        self.oracle.filter(|known| !known.is_enough).map(|known| known.success)
    }

    /// Writes the state into a folder.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        files::write_json(&files::in_folder(folder, FILE)?, self)
    }
}

impl Trial {
    /// Returns a trial that is still to be driven.
    pub fn planned(
        number: usize,
        predicted: SuccessProbability,
        predicted_endings: Option<Endings>,
        predicted_paths: Vec<SimulatedPath>,
    ) -> Self {
        Trial {
            number,
            controller: format!("trial-{number}.toml"),
            log: format!("trial-{number}.csv"),
            predicted,
            predicted_paths,
            real: None,
            predicted_endings,
            chance_after: None,
            endings_after: None,
            chance_without_effects: None,
            gap: None,
            effects: Vec::new(),
            causes: Vec::new(),
        }
    }

    /// Returns the file of the log of an attempt, from 0, which stays if it cannot be used.
    pub fn attempt(&self, attempt: usize) -> String {
        format!("trial-{}-attempt-{}.csv", self.number, attempt + 1)
    }
}

/// Rounds a position to millimetres for output.
pub fn place_cm(at: DVec2) -> [f64; 2] {
    at.to_array().map(|cm| (10.0 * cm).round() / 10.0)
}
