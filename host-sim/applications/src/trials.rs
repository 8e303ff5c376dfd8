//! The loop on the robot: evolve a controller, drive it, adapt the simulator to the run, and again until it works.
//!
//! A turn begins with what all runs so far say of the robot ([`adapt`](mod@crate::adapt)), [searches](search) on the robot in
//! the middle of those that remain possible, judges on many of them, and drives the best. Everything is in the folder's
//! [state] after every step, so that a loop that is stopped anywhere goes on.

pub mod drawing;
mod driven;
pub mod jury;
mod likeness;
pub mod robot;
pub mod search;
pub mod state;
pub mod vetting;

use std::fs;
use std::path::{Path, PathBuf};

use mindgap_core::controller::Controller;

use crate::adapt::{Adapted, adapt};
use jury::{Candidate, Tried};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::derive;
use mindgap_learning::evolve::chance::Chance;
use mindgap_learning::evolve::controller_file::{ControllerFile, Origin};
use mindgap_logs::{Logs, Run, Scene};
use mindgap_models::simulator::Simulator;
use mindgap_workers as workers;
use robot::{Call, TrialRobot};
use search::Search;
use state::{Failure, State, Trial, Verdict};
use vetting::Vetting;

/// Where no controller has this chance on robots that are possible, none is driven.
const HOPELESS: f64 = 0.03;
/// A drive that fails is tried so often.
const ATTEMPTS: usize = 2;

/// The job of a loop.
pub struct Job<'a> {
    /// Folder of its state and results.
    pub folder: &'a Path,
    /// Simulator file.
    pub simulator: &'a Path,
    /// Scene file.
    pub scene: &'a Path,
    /// Start within the scene, from 1.
    pub start: usize,
    /// Runs on the robot at most.
    pub trials: usize,
    /// Steps after which a controller gives up.
    pub max_steps: u16,
    /// Controllers to begin with.
    pub known: &'a [Controller],
    /// Seed of all draws.
    pub seed: u64,
}

/// What a loop tells while it runs.
pub enum Event<'a> {
    /// A controller is to be driven.
    Driving(&'a Trial),
    /// It was driven.
    Driven(&'a Trial),
    /// A drive failed.
    Failed(&'a Failure),
}

/// A loop that is under way.
struct Trials<'a> {
    job: &'a Job<'a>,
    simulator: Simulator,
    scene: Scene,
    start: Pose,
    state: State,
}

/// Runs a loop to its end, from where it stood if its folder holds one.
///
/// # Errors
/// When a file cannot be read or written, when the folder holds another loop, or when the robot fails twice in a row.
pub fn run(job: &Job, robot: &mut dyn TrialRobot, mut tell: impl FnMut(Event)) -> Result<State> {
    let mut trials = Trials::open(job)?;
    // Before anything else lies in the folder, so that it is known for a loop's.
    trials.state.write(job.folder)?;
    while trials.state.verdict == Verdict::Running {
        if trials.state.trials.last().is_some_and(|trial| trial.real.is_none()) {
            trials.state = workers::once(|| trials.drive(robot, &mut tell).map(|()| trials.state.clone()))?;
        } else {
            trials.turn()?;
        }
        trials.state.write(job.folder)?;
    }
    Ok(trials.state)
}

impl<'a> Trials<'a> {
    fn open(job: &'a Job<'a>) -> Result<Self> {
        let simulator = Simulator::read(job.simulator)?;
        let scene = Scene::read(job.scene)?;
        let start = scene.start(job.start, simulator.robot.body_radius_cm).map_err(|e| e.or_in_file(job.scene))?;
        if scene.target_cm.is_none() {
            return Err(Error::in_file(job.scene, "has no [target]"));
        }
        files::make_folder(job.folder)?;
        let state = workers::once(|| State::open(job))?;
        Ok(Trials { job, simulator, scene, start, state })
    }

    /// Adapts to all runs so far, and ends the loop or plans the next trial.
    fn turn(&mut self) -> Result<()> {
        let runs = self.runs()?;
        let logs = Logs { robot: self.simulator.robot, scene: self.scene.clone(), runs };
        let adapted = match logs.runs.as_slice() {
            [] => None,
            _ => Some(adapt(&self.simulator, &logs, self.job.seed, |_| ())?),
        };
        let simulator = adapted.as_ref().map_or(&self.simulator, |adapted| &adapted.simulator).clone();
        let count = self.state.trials.len();
        let search = Search {
            simulator: &simulator,
            scene: &logs.scene,
            start: self.start,
            max_steps: self.job.max_steps,
            seed: derive(self.job.seed, &[count as u64]),
        };
        let tried = self.tried()?;
        let known = search.judged(&tried)?;
        self.note(adapted, tried.last().and_then(|last| known.chance_of(&last.controller)));
        simulator.write(&self.job.folder.join("simulator.json"))?;
        if let Some(works) = known.confirmed(&tried) {
            return self.settle(Verdict::Works, works);
        }
        let found = search.best(&self.state.archive, &tried)?;
        let archive = found.tuples(search::ARCHIVED);
        let choice = found.choice(&tried).ok_or_else(|| Error::new("no controller was found"))?;
        if count >= self.job.trials {
            // The last run may have told what none of the driven ones was made for.
            self.state.if_known = Some(search.if_known(&archive, &tried)?);
            // The archive stays as it is: with more trials this turn is made again, from what it is made from now.
            return self.settle(Verdict::Spent, choice);
        }
        self.state.archive = archive;
        if choice.chance.success < HOPELESS {
            return self.settle(Verdict::OutOfReach, choice);
        }
        let trial = Trial::planned(count + 1, choice.chance, search.paths(&choice.controller)?);
        self.write_controller(&self.job.folder.join(&trial.controller), choice)?;
        self.state.trials.push(trial);
        Ok(())
    }

    /// What the last run told, at its trial.
    fn note(&mut self, adapted: Option<Adapted>, chance: Option<Chance>) {
        if let (Some(trial), Some(Adapted { lesson, .. })) = (self.state.trials.last_mut(), adapted) {
            trial.effects = lesson.effects;
            trial.gap = lesson.gap;
            trial.chance_after = chance;
        }
    }

    /// Drives the controller of the last trial and keeps its log if it is one to learn from.
    fn drive(&mut self, robot: &mut dyn TrialRobot, tell: &mut impl FnMut(Event)) -> Result<()> {
        let folder = self.job.folder;
        let Some(trial) = self.state.trials.last().cloned() else { return Ok(()) };
        let path = folder.join(&trial.controller);
        let controller = ControllerFile::read(&path)?.controller;
        let attempt = self.state.failures.iter().filter(|failure| failure.trial == trial.number).count();
        let out = folder.join("driving.csv");
        // What an interrupted drive left is of no run that is known.
        let _ = fs::remove_file(&out);
        tell(Event::Driving(&trial));
        let call = Call {
            controller: &path,
            scene: self.job.scene,
            start: self.job.start,
            out: &out,
            // Robots see small numbers.
            seed: derive(self.job.seed, &[trial.number as u64, attempt as u64]) % 1_000_000,
        };
        let vetting =
            Vetting { simulator: &self.simulator, scene: &self.scene, start: self.start, controller: &controller };
        let driven = robot.drive(&call).and_then(|()| vetting.read(&out));
        match driven {
            Ok((run, real)) => {
                run.write(&folder.join(&trial.log))?;
                let _ = fs::remove_file(&out);
                if let Some(trial) = self.state.trials.last_mut() {
                    trial.real = Some(real);
                    tell(Event::Driven(trial));
                }
                drawing::paths(folder, &self.scene, self.start, &self.state)
            }
            Err(problem) => {
                let failure = Failure { trial: trial.number, reason: problem.to_string() };
                tell(Event::Failed(&failure));
                self.state.failures.push(failure);
                self.state.write(folder)?;
                if attempt + 1 < ATTEMPTS {
                    return Ok(());
                }
                // Whoever starts the loop again means to try again.
                self.state.failures.retain(|failure| failure.trial != trial.number);
                self.state.write(folder)?;
                Err(Error::new(format!(
                    "trial {} failed {ATTEMPTS} times, and the loop stands still: {problem}",
                    trial.number
                )))
            }
        }
    }

    /// Ends the loop with a controller.
    fn settle(&mut self, verdict: Verdict, settled: &Candidate) -> Result<()> {
        self.write_controller(&self.job.folder.join("controller.toml"), settled)?;
        self.state.verdict = verdict;
        self.state.chance = Some(settled.chance);
        self.state.chance_with_runs = Some(settled.score);
        Ok(())
    }

    /// The logs of all trials.
    fn runs(&self) -> Result<Vec<Run>> {
        let driven = self.state.trials.iter().filter(|trial| trial.real.is_some());
        driven.map(|trial| Run::read(&self.job.folder.join(&trial.log), |_| {})).collect()
    }

    /// The controllers of all trials, each once, with how they did.
    fn tried(&self) -> Result<Vec<Tried>> {
        let mut tried: Vec<Tried> = Vec::new();
        for trial in &self.state.trials {
            let controller = ControllerFile::read(&self.job.folder.join(&trial.controller))?.controller;
            let Some(real) = &trial.real else { continue };
            let before = tried.iter().position(|tried| tried.controller == controller).map(|at| tried.remove(at));
            let before = before.unwrap_or(Tried { controller, runs: 0, successes: 0, steps: 0 });
            tried.push(Tried {
                runs: before.runs + 1,
                successes: before.successes + usize::from(real.reached),
                steps: before.steps.max(real.steps),
                ..before
            });
        }
        Ok(tried)
    }

    fn write_controller(&self, path: &Path, Candidate { controller, chance, .. }: &Candidate) -> Result<()> {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let origin = Origin {
            simulator: name(&PathBuf::from("simulator.json")),
            scene: name(self.job.scene),
            start: self.job.start,
            seed: self.job.seed,
            generations: search::GENERATIONS,
            fitness: 0.0,
            success: chance.success,
        };
        ControllerFile { controller: controller.clone(), origin: Some(origin) }.write(path)
    }
}
