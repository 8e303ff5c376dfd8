//! `mindgap loop`

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, value_parser};

use super::json_output::JsonOption;
use super::logging::status;
use super::{Run, kinds, progress, textbook, warn};
use mindgap_applications::closed_loop::robot::{AskRobot, CommandRobot, TrialRobot};
use mindgap_applications::closed_loop::state::{OracleSuccess, State, Trial, Verdict};
use mindgap_applications::closed_loop::{self, Event, Job};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_learning::evolve::success_probability::SuccessProbability;
use mindgap_logs::Scene;
use mindgap_pages::trials::{Subject, page};

/// Evolve a controller, drive it on the robot, adapt the simulator to the run, and repeat until a controller works or the trials are used up.
///
/// The folder holds the state after every step; run the same command again to resume. At the end it contains controller.toml,
/// simulator.json, loop.json, the controllers and logs of all trials, and paths.png.
#[derive(Args)]
pub struct Loop {
    /// Folder of the state and the results.
    folder: PathBuf,
    /// The simulator file.
    #[arg(long)]
    sim: PathBuf,
    /// Scene with a target and starts.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Number of the start in the scene, from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: usize,
    /// Command that drives the robot. Mindgap appends five arguments: CONTROLLER.toml SCENE.toml START OUT.csv SEED. Quotes
    /// group words as in a shell, but no shell runs. With `ask`, Mindgap asks a person to drive the robot and to enter the path
    /// of the log.
    #[arg(long, value_name = "COMMAND")]
    robot: String,
    /// Timeout of the command. When it expires, the command and everything it started receive SIGTERM, and SIGKILL three
    /// seconds later.
    #[arg(long, value_name = "SECONDS", default_value_t = 300, value_parser = value_parser!(u64).range(1..))]
    robot_timeout: u64,
    /// Maximum number of runs on the robot.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = value_parser!(u32).range(1..=1000))]
    trials: u32,
    /// Maximum number of steps per run.
    #[arg(long, default_value_t = 60, value_parser = value_parser!(u16).range(1..))]
    max_steps: u16,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    json: JsonOption,
    /// Write an HTML page.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

/// Value of `--robot` for a person who drives.
const ASK: &str = "ask";

impl Run for Loop {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.sim, &self.scene]).writing(self.json.path(), kinds::REPORT);
        let places = places.writing(&self.html, kinds::PAGE);
        // A folder with a loop in it is resumed, not filled.
        let fresh = Some(&self.folder).filter(|folder| !folder.join(closed_loop::state::FILE).exists());
        places.filling(fresh)
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        textbook::learned(&self.sim)?;
        let job = Job {
            executor,
            folder: &self.folder,
            simulator: &self.sim,
            scene: &self.scene,
            start: self.start,
            trials: self.trials as usize,
            max_steps: self.max_steps,
            known: &[],
            seed: self.seed,
        };
        let timeout = Duration::from_secs(self.robot_timeout);
        let robot: &mut dyn TrialRobot =
            if self.robot == ASK { &mut AskRobot } else { &mut CommandRobot::new(&self.robot, timeout)? };
        let bar = progress::bar(self.trials.into());
        let state = closed_loop::run(&job, robot, |event| match event {
            Event::Driving(trial) => {
                bar.set_position(trial.number as u64 - 1);
                status(&format!("trial {}: predicted success {}, driving", trial.number, trial.predicted));
            }
            Event::Driven(trial) => status(&line(trial)),
            Event::Failed(failure) => {
                warn(format!("trial {}: failed, nothing learned: {}", failure.trial, failure.reason))
            }
        });
        bar.finish_and_clear();
        let state = state?;
        if let Some(path) = &self.html {
            let names = [&self.sim, &self.scene].map(|path| path.display().to_string());
            let scene = Scene::read(&self.scene)?;
            let subject = Subject {
                state: &state,
                scene: &scene,
                names: names.each_ref().map(String::as_str),
                start: self.start,
                seed: self.seed,
            };
            files::write(path, page(&subject))?;
        }
        self.json.emit(&state, self.describe(&state))
    }

    fn is_shared(&self) -> bool {
        true
    }
}

impl Loop {
    fn describe(&self, state: &State) -> String {
        let trials: String = state.trials.iter().map(|trial| line(trial) + "\n").collect();
        let controller = self.folder.join("controller.toml");
        let chance = state.chance.as_ref().map_or_else(|| "unknown".into(), SuccessProbability::to_string);
        let end = match state.verdict {
            Verdict::Works => "works: it reached the target three times; its",
            Verdict::Infeasible => {
                "no controller was found that reaches the target on any plausible robot; the best one's"
            }
            Verdict::TrialsExhausted | Verdict::Running => {
                "trials used up before a controller was confirmed; the best one's"
            }
        };
        let with_runs = state.chance_with_runs.map_or_else(String::new, with_runs);
        let known = state.oracle.as_ref().map_or_else(String::new, oracle);
        format!("{trials}{}: {end} success probability is {chance}{with_runs}\n{known}", controller.display())
    }
}

fn with_runs(chance: f64) -> String {
    format!(", {:.0} % after real runs of this and similar controllers", 100.0 * chance)
}

/// Returns what further trials could achieve.
fn oracle(OracleSuccess { success, is_enough }: &OracleSuccess) -> String {
    let (known, percent) = ("with a perfectly known robot it would be", 100.0 * success);
    if *is_enough {
        format!("{known} {percent:.0} %: further trials may help\n")
    } else {
        format!(
            "{known} {percent:.0} %: noise in motion and readings limits every controller that was found; further trials will \
             hardly help, a nearer start or a wider passage may\n"
        )
    }
}

/// Returns a trial as one line.
pub(super) fn line(trial: &Trial) -> String {
    let Some(real) = &trial.real else { return format!("trial {}: not driven", trial.number) };
    let reached = if real.reached { "reached the target" } else { "missed the target" };
    let effects: Vec<&str> = trial.effects.iter().map(|effect| effect.effect.as_str()).collect();
    let effects = if effects.is_empty() { String::new() } else { format!("; effects: {}", effects.join(", ")) };
    let after = trial.chance_after.as_ref().map_or_else(String::new, |chance| format!(", afterwards {chance}"));
    format!(
        "trial {}: {reached} ({} after {} steps, {:.0} cm off); predicted success {}{after}{effects}",
        trial.number, real.ending, real.steps, real.distance_cm, trial.predicted
    )
}
