//! `loop.json`: what happened in a loop so far, and all that it needs to go on.

use std::fmt;
use std::path::Path;

use glam::DVec2;
use mindgap_core::controller::Tuple;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::Job;
use crate::adapt::Gap;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_learning::evolve::chance::Chance;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::simulator::rollout::Termination;

/// The version of this format.
const SCHEMA: u32 = 1;
/// The file's name within the loop's folder.
pub const FILE: &str = "loop.json";

/// The state of a loop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Version of the format.
    schema: u32,
    /// SHA-256 of all that decides how the loop goes: simulator, scene, start, seed.
    job: String,
    /// How it stands.
    pub verdict: Verdict,
    /// Simulated chance of the controller that it settled on.
    pub chance: Option<Chance>,
    /// The same with what real runs came to, its own and those of controllers like it.
    #[serde(default)]
    pub chance_with_runs: Option<f64>,
    /// Where the trials were spent, what could be reached if the robot were known.
    #[serde(default)]
    pub if_known: Option<IfKnown>,
    /// The trials.
    pub trials: Vec<Trial>,
    /// Drives that nothing was learned from.
    pub failures: Vec<Failure>,
    /// Tuples of controllers from which the next search goes on.
    pub archive: Vec<Vec<Tuple>>,
}

/// How a loop stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It has not ended.
    Running,
    /// A controller succeeded on the robot often enough, and has a good chance by all that is known.
    Works,
    /// The trials are spent before that.
    Spent,
    /// No six tuples were found that reach the target on any robot that is possible.
    OutOfReach,
}

/// What the best of the controllers that were found reaches on a robot that is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct IfKnown {
    /// Its chance of success.
    pub success: f64,
    /// Whether that could be confirmed. If not, chance is what limits it, which further trials will hardly change.
    pub is_enough: bool,
}

/// A controller on the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Which, from 1.
    pub number: usize,
    /// File of the controller.
    pub controller: String,
    /// File of the log.
    pub log: String,
    /// Its chance before it was driven.
    pub predicted: Chance,
    /// Its paths on robots that were possible then.
    pub predicted_paths: Vec<SimulatedPath>,
    /// How it went; null until then.
    pub real: Option<Real>,
    /// Its chance by what the run told.
    pub chance_after: Option<Chance>,
    /// What simulated steps were off by on runs kept back, before and after adapting to the others.
    pub gap: Option<Gap>,
    /// Effects that a diagnosis of all runs up to this one names.
    pub effects: Vec<AppliedEffect>,
}

/// A simulated run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulatedPath {
    /// How it ended.
    pub ending: Ending,
    /// Where the robot was at the start and after each step, along x and y.
    pub path_cm: Vec<[f64; 2]>,
}

/// How a run on the robot went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Real {
    /// How it ended.
    pub ending: Ending,
    /// Steps taken.
    pub steps: usize,
    /// Where it ended, along x.
    pub end_x_cm: f64,
    /// And along y.
    pub end_y_cm: f64,
    /// How far from the target that is.
    pub distance_cm: f64,
    /// Whether it reached the target.
    pub reached: bool,
    /// Where the tracker saw the robot at each row, along x and y.
    pub path_cm: Vec<[f64; 2]>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The sixth tuple's test held.
    Finished,
    /// The step limit was reached.
    TimedOut,
    /// The robot touched a wall or an obstacle.
    Crashed,
}

/// A drive that nothing was learned from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Which trial it was to be.
    pub trial: usize,
    /// What was wrong.
    pub reason: String,
}

impl State {
    /// The state of a job's folder, new where it holds none.
    ///
    /// # Errors
    /// When a file cannot be read, or when the folder's loop has another simulator, scene, start or seed.
    pub fn open(job: &Job) -> Result<Self> {
        let mut digest = Sha256::new();
        for path in [job.simulator, job.scene] {
            digest.update(files::read_text(path)?);
        }
        digest.update(format!("{} {} {}", job.start, job.seed, job.max_steps));
        let digest = digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        let path = job.folder.join(FILE);
        if !path.exists() {
            return Ok(State {
                schema: SCHEMA,
                job: digest,
                verdict: Verdict::Running,
                chance: None,
                chance_with_runs: None,
                if_known: None,
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
        if state.verdict == Verdict::Spent && state.trials.len() < job.trials {
            state.verdict = Verdict::Running;
            state.if_known = None;
        }
        Ok(state)
    }

    /// The chance of success beyond which no controller that was found gets, if that cannot be confirmed.
    pub fn limit(&self) -> Option<f64> {
        self.if_known.filter(|known| !known.is_enough).map(|known| known.success)
    }

    /// Writes it.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, folder: &Path) -> Result<()> {
        files::write_json(&folder.join(FILE), self)
    }
}

impl Trial {
    /// A trial that is still to be driven.
    pub fn planned(number: usize, predicted: Chance, predicted_paths: Vec<SimulatedPath>) -> Self {
        Trial {
            number,
            controller: format!("trial-{number}.toml"),
            log: format!("trial-{number}.csv"),
            predicted,
            predicted_paths,
            real: None,
            chance_after: None,
            gap: None,
            effects: Vec::new(),
        }
    }
}

/// A place as it is written, to the millimetre.
pub fn place_cm(at: DVec2) -> [f64; 2] {
    at.to_array().map(|cm| (10.0 * cm).round() / 10.0)
}

impl From<Termination> for Ending {
    fn from(termination: Termination) -> Self {
        match termination {
            Termination::Finished => Ending::Finished,
            Termination::TimedOut => Ending::TimedOut,
            Termination::Crashed => Ending::Crashed,
        }
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Ending::Finished => "finished",
            Ending::TimedOut => "timed out",
            Ending::Crashed => "crashed",
        })
    }
}
