//! `mindgap loop`

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, value_parser};

use super::facts::FactsOption;
use super::voice::meanwhile;
use super::{Run, kinds, progress, textbook, warn};
use mindgap_applications::trials::robot::{AskRobot, CommandRobot, TrialRobot};
use mindgap_applications::trials::state::{IfKnown, State, Trial, Verdict};
use mindgap_applications::trials::{self, Event, Job};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_learning::evolve::chance::Chance;
use mindgap_logs::Scene;
use mindgap_pages::trials::{Subject, page};

/// Evolve a controller, drive it on the robot, adapt the simulator to the run, and again until it works.
///
/// The folder holds the state after every step: the same call goes on from there. At the end it holds controller.toml,
/// simulator.json, loop.json, the controllers and logs of all trials, and paths.png.
#[derive(Args)]
pub struct Loop {
    /// Folder for the state and the results.
    folder: PathBuf,
    /// The simulator file.
    #[arg(long)]
    sim: PathBuf,
    /// The scene, with a target and starts.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Which of the scene's starts, from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: usize,
    /// Command that drives, with its first arguments, parted by blanks; CONTROLLER.toml SCENE.toml START OUT.csv SEED are
    /// added. `ask` asks a person to drive and to name the log.
    #[arg(long, value_name = "COMMAND")]
    robot: String,
    /// How long the command may take.
    #[arg(long, value_name = "SECONDS", default_value_t = 300, value_parser = value_parser!(u64).range(1..))]
    robot_timeout: u64,
    /// Runs on the robot at most.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = value_parser!(u32).range(1..=1000))]
    trials: u32,
    /// Steps after which a controller gives up.
    #[arg(long, default_value_t = 60, value_parser = value_parser!(u16).range(1..))]
    max_steps: u16,
    /// Fixes every draw.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    facts: FactsOption,
    /// Also write a page for a browser here.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

/// Stands for a person who drives.
const ASK: &str = "ask";

impl Run for Loop {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.sim, &self.scene]).writing(self.facts.asked(), kinds::REPORT);
        let places = places.writing(&self.html, kinds::PAGE);
        // A folder in which a loop was begun is gone on with.
        let fresh = Some(&self.folder).filter(|folder| !folder.join(trials::state::FILE).exists());
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
        let command = || CommandRobot { command: self.robot.clone(), timeout: Duration::from_secs(self.robot_timeout) };
        let robot: &mut dyn TrialRobot = if self.robot == ASK { &mut AskRobot } else { &mut command() };
        let bar = progress::bar(self.trials.into());
        let state = trials::run(&job, robot, |event| match event {
            Event::Driving(trial) => {
                bar.set_position(trial.number as u64 - 1);
                meanwhile(&format!("trial {}: chance {}, driving", trial.number, trial.predicted));
            }
            Event::Driven(trial) => meanwhile(&line(trial)),
            Event::Failed(failure) => warn(format!("trial {}: nothing is learned: {}", failure.trial, failure.reason)),
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
        self.facts.told(&state, self.told(&state))
    }

    fn is_shared(&self) -> bool {
        true
    }
}

impl Loop {
    fn told(&self, state: &State) -> String {
        let trials: String = state.trials.iter().map(|trial| line(trial) + "\n").collect();
        let controller = self.folder.join("controller.toml");
        let chance = state.chance.as_ref().map_or_else(|| "unknown".into(), Chance::to_string);
        let end = match state.verdict {
            Verdict::Works => "it works: it reached the target three times, and by all that is known",
            Verdict::OutOfReach => {
                "no six tuples were found that reach the target on a robot that is possible; of the best"
            }
            Verdict::Spent | Verdict::Running => "the trials are spent before one was confirmed; of the best",
        };
        let with_runs = state.chance_with_runs.map_or_else(String::new, with_runs);
        let known = state.if_known.as_ref().map_or_else(String::new, if_known);
        format!("{trials}{}: {end} the chance is {chance}{with_runs}\n{known}", controller.display())
    }
}

fn with_runs(chance: f64) -> String {
    format!(", {:.0} % with real runs of it and its like", 100.0 * chance)
}

/// What further trials may do.
fn if_known(IfKnown { success, is_enough }: &IfKnown) -> String {
    let (known, percent) = ("if the robot were known it would be", 100.0 * success);
    if *is_enough {
        format!("{known} {percent:.0} %: further trials may get there\n")
    } else {
        format!(
            "{known} {percent:.0} %: no six tuples were found that do better against chance in motion and readings; further \
             trials will hardly change that, a nearer start or a wider way may\n"
        )
    }
}

/// A trial in one line.
pub(super) fn line(trial: &Trial) -> String {
    let Some(real) = &trial.real else { return format!("trial {}: not driven", trial.number) };
    let reached = if real.reached { "reached the target" } else { "missed the target" };
    let effects: Vec<&str> = trial.effects.iter().map(|effect| effect.effect.as_str()).collect();
    let effects = if effects.is_empty() { String::new() } else { format!("; effects: {}", effects.join(", ")) };
    let after = trial.chance_after.as_ref().map_or_else(String::new, |chance| format!(", then {chance}"));
    format!(
        "trial {}: {reached} ({} after {} steps, {:.0} cm off); chance {}{after}{effects}",
        trial.number, real.ending, real.steps, real.distance_cm, trial.predicted
    )
}
