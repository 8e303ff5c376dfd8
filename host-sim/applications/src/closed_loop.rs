//! The closed loop with a robot: evolve a controller, drive it, adapt the simulator to the run, and repeat until it works.
//!
//! Each iteration [adapts](mod@crate::adapt) the simulator to all runs so far, [searches](search) for controllers at the
//! posterior mean, evaluates them over the posterior, and drives the best one. The [state] in the folder is written after
//! every step, so an interrupted loop resumes from there.

pub mod drawing;
pub mod evaluator;
pub mod log_check;
pub mod robot;
pub mod search;
mod similarity;
pub mod state;
mod tuple_trace;

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use mindgap_core::controller::Controller;

use crate::adapt::{Adapted, adapt};
use evaluator::{Candidate, Found, Tried};
use log_check::LogCheck;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::{self, Executor};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::derive;
use mindgap_logs::controller_file::{ControllerFile, Origin};
use mindgap_logs::{Logs, Run, Scene};
use mindgap_models::simulator::Simulator;
use robot::{Call, TrialRobot};
use search::Search;
use state::{Failure, State, Trial, Verdict};

/// Success probability below which no controller is worth driving.
const HOPELESS: f64 = 0.03;
/// Number of attempts per trial.
const ATTEMPTS: usize = 2;

/// The inputs of a loop.
pub struct Job<'a> {
    /// Executor of independent work items.
    pub executor: &'a dyn Executor,
    /// Folder of the state and the results.
    pub folder: &'a Path,
    /// Simulator file.
    pub simulator: &'a Path,
    /// Scene file.
    pub scene: &'a Path,
    /// Number of the start in the scene, from 1.
    pub start: usize,
    /// Maximum number of runs on the robot.
    pub trials: usize,
    /// Maximum number of steps of a controller.
    pub max_steps: u16,
    /// Controllers to begin with.
    pub known: &'a [Controller],
    /// Random seed.
    pub seed: u64,
}

/// Events of a running loop.
pub enum Event<'a> {
    /// A controller is about to be driven.
    Driving(&'a Trial),
    /// A controller was driven.
    Driven(&'a Trial),
    /// A drive failed.
    Failed(&'a Failure),
}

/// A loop in progress.
struct ClosedLoop<'a> {
    job: &'a Job<'a>,
    simulator: Simulator,
    scene: Scene,
    start: Pose,
    state: State,
    /// Held while the loop runs.
    _lock: Option<File>,
}

/// Runs a loop to its end, resuming the one in its folder if there is one.
///
/// # Errors
/// If a file cannot be read or written, the folder holds another loop or is in use by one, or the robot fails twice in a row.
pub fn run(job: &Job, robot: &mut dyn TrialRobot, mut on_event: impl FnMut(Event)) -> Result<State> {
    let mut trials = ClosedLoop::open(job)?;
    // Written first, so that the folder is recognised as a loop's.
    trials.state.write(job.folder)?;
    while trials.state.verdict == Verdict::Running {
        if trials.state.trials.last().is_some_and(|trial| trial.real.is_none()) {
            trials.state =
                executor::once(job.executor, || trials.drive(robot, &mut on_event).map(|()| trials.state.clone()))?;
        } else {
            trials.plan_next()?;
        }
        trials.state.write(job.folder)?;
    }
    Ok(trials.state)
}

impl<'a> ClosedLoop<'a> {
    fn open(job: &'a Job<'a>) -> Result<Self> {
        let simulator = Simulator::read(job.simulator)?;
        let scene = Scene::read(job.scene)?;
        let start = scene.start(job.start, simulator.robot.body_radius_cm).map_err(|e| e.or_in_file(job.scene))?;
        if scene.target_cm.is_none() {
            return Err(Error::in_file(job.scene, "has no [target]"));
        }
        files::make_folder(job.folder)?;
        let mut lock = None;
        let state = executor::once(job.executor, || {
            lock = files::lock_folder(job.folder)?;
            State::open(job)
        })?;
        Ok(ClosedLoop { job, simulator, scene, start, state, _lock: lock })
    }

    /// Returns the path of a file in the loop's folder.
    fn file(&self, name: &str) -> Result<PathBuf> {
        files::in_folder(self.job.folder, name)
    }

    /// Adapts to all runs so far, and ends the loop or plans the next trial.
    fn plan_next(&mut self) -> Result<()> {
        let runs = self.runs()?;
        let logs = Logs { robot: self.simulator.robot, scene: self.scene.clone(), runs };
        let adapted = match logs.runs.as_slice() {
            [] => None,
            _ => Some(adapt(&self.simulator, &logs, self.job.seed, |_| ())?),
        };
        let simulator = adapted.as_ref().map_or(&self.simulator, |adapted| &adapted.simulator).clone();
        let count = self.state.trials.len();
        let search = Search {
            executor: self.job.executor,
            simulator: &simulator,
            scene: &logs.scene,
            start: self.start,
            max_steps: self.job.max_steps,
            seed: derive(self.job.seed, &[count as u64]),
        };
        let tried = self.tried()?;
        let known = search.judged(&tried)?;
        if let (Some(adapted), Some(last)) = (adapted, tried.last()) {
            self.note(adapted, &last.controller, &known, search)?;
        }
        simulator.write(&self.file("simulator.json")?)?;
        if let Some(works) = known.confirmed(&tried) {
            return self.settle(Verdict::Works, works);
        }
        let found = search.best(&self.state.archive, &tried)?;
        let archive = found.tuples(search::ARCHIVED);
        let choice = found.choice(&tried).ok_or_else(|| Error::new("no controller was found"))?;
        if count >= self.job.trials {
            // The last run may favour a controller that was not driven.
            self.state.oracle = Some(search.oracle(&archive, &tried)?);
            // The archive is unchanged: with more trials this iteration is repeated from the same state.
            return self.settle(Verdict::TrialsExhausted, choice);
        }
        self.state.archive = archive;
        if choice.chance.success < HOPELESS {
            return self.settle(Verdict::Infeasible, choice);
        }
        let (endings, paths) = (search.endings(&choice.controller)?, search.paths(&choice.controller)?);
        let trial = Trial::planned(count + 1, choice.chance, Some(endings), paths);
        self.write_controller(&self.file(&trial.controller)?, choice)?;
        self.state.trials.push(trial);
        Ok(())
    }

    /// Stores at the last trial, of this controller, what was learned from its run, and why its success probability changed.
    fn note(&mut self, adapted: Adapted, driven: &Controller, known: &Found, search: Search) -> Result<()> {
        let Some(trial) = self.state.trials.last_mut() else { return Ok(()) };
        let Adapted { lesson, without_effects, .. } = adapted;
        trial.effects = lesson.effects;
        trial.causes = lesson.causes;
        trial.gap = lesson.gap;
        trial.chance_after = known.chance_of(driven);
        trial.endings_after = Some(search.endings(driven)?);
        let without = without_effects.map(|simulator| Search { simulator: &simulator, ..search }.endings(driven));
        trial.chance_without_effects = without.transpose()?.map(|endings| endings.reached);
        Ok(())
    }

    /// Drives the controller of the last trial and keeps its log if it is valid.
    fn drive(&mut self, robot: &mut dyn TrialRobot, on_event: &mut impl FnMut(Event)) -> Result<()> {
        let folder = self.job.folder;
        let Some(trial) = self.state.trials.last().cloned() else { return Ok(()) };
        let attempt = self.state.failures.iter().filter(|failure| failure.trial == trial.number).count();
        let (controller_file, name) = (self.file(&trial.controller)?, trial.attempt(attempt));
        let controller = ControllerFile::read(&controller_file)?.controller;
        let log = self.file(&name)?;
        // Whatever appears in a folder of its own is of this attempt.
        let own_folder = files::StagingFolder::in_folder(folder)
            .map_err(|e| Error::in_file(folder, format!("cannot be written: {e}")))?;
        let out = own_folder.new_folder().join(name);
        on_event(Event::Driving(&trial));
        let call = Call {
            controller: &controller_file,
            scene: self.job.scene,
            start: self.job.start,
            out: &out,
            // A short number is easier to handle for robot scripts.
            seed: derive(self.job.seed, &[trial.number as u64, attempt as u64]) % 1_000_000,
        };
        let check =
            LogCheck { simulator: &self.simulator, scene: &self.scene, start: self.start, controller: &controller };
        let driven = robot.drive(&call).and_then(|()| log_check::receive(&out, &log)).and_then(|()| check.read(&log));
        match driven {
            Ok((run, real)) => {
                run.write(&self.file(&trial.log)?)?;
                let _ = fs::remove_file(&log);
                if let Some(trial) = self.state.trials.last_mut() {
                    trial.real = Some(real);
                    on_event(Event::Driven(trial));
                }
                for name in drawing::FILES {
                    self.file(name)?;
                }
                drawing::paths(folder, &self.scene, self.start, &self.state)
            }
            Err(problem) => {
                let failure = Failure { trial: trial.number, reason: problem.to_string() };
                on_event(Event::Failed(&failure));
                self.state.failures.push(failure);
                self.state.write(folder)?;
                if attempt + 1 < ATTEMPTS {
                    return Ok(());
                }
                // Calling the loop again retries the trial.
                self.state.failures.retain(|failure| failure.trial != trial.number);
                self.state.write(folder)?;
                Err(Error::new(format!("trial {} failed {ATTEMPTS} times, loop stopped: {problem}", trial.number)))
            }
        }
    }

    /// Ends the loop with a controller.
    fn settle(&mut self, verdict: Verdict, settled: &Candidate) -> Result<()> {
        self.write_controller(&self.file("controller.toml")?, settled)?;
        self.state.verdict = verdict;
        self.state.chance = Some(settled.chance);
        self.state.chance_with_runs = Some(settled.score);
        Ok(())
    }

    /// Reads the logs of all trials.
    fn runs(&self) -> Result<Vec<Run>> {
        let driven = self.state.trials.iter().filter(|trial| trial.real.is_some());
        let sensors = self.simulator.sensors();
        driven.map(|trial| Run::read_by(&self.file(&trial.log)?, &sensors)).collect()
    }

    /// Returns the distinct controllers of all trials with their results.
    fn tried(&self) -> Result<Vec<Tried>> {
        let mut tried: Vec<Tried> = Vec::new();
        for trial in &self.state.trials {
            let controller = ControllerFile::read(&self.file(&trial.controller)?)?.controller;
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
            fitness: None,
            success: chance.success,
        };
        ControllerFile { controller: controller.clone(), sensors: Default::default(), origin: Some(origin) }.write(path)
    }
}
