//! Procedures that find a controller for a robot, with or without trials on it.

use std::path::Path;

use mindgap_applications::adapt::adapt;
use mindgap_applications::closed_loop::{self, Job};
use mindgap_applications::demo::robot::TrialledRobot;
use mindgap_core::controller::Controller;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Serial;
use mindgap_foundations::random::derive;
use mindgap_learning::evolve::fitness::{FitnessEvaluator, RandomNumbers};
use mindgap_learning::evolve::genome::GenotypeDecoder;
use mindgap_learning::evolve::paper;
use mindgap_learning::evolve::robust;
use mindgap_learning::evolve::route::RouteMap;
use mindgap_learning::evolve::success_probability::{Judge, ROBOTS, RUNS};
use mindgap_learning::evolve::task::EvolutionTask;
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::{Logs, Run, Scene, Termination};
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::nominal::NominalModel;
use mindgap_models::simulator::{Noise, Simulator};

use crate::cases::{Case, SEED};
use crate::on_robot;

/// The name of a procedure and its function.
pub type Procedure = (&'static str, fn(&Workbench) -> Result<Settled>);

/// All procedures.
pub const PROCEDURES: [Procedure; 8] = [
    ("paper", by_the_paper),
    ("straight", evolve_straight),
    ("evolve", evolve),
    ("three", try_three),
    ("retrain", retrain),
    ("correct", correct),
    ("loop", loops),
    ("on_robot", on_robot),
];

const TRIALS: usize = 5;
const MAX_STEPS: u16 = 60;
/// Rows at the end of a crashed run that a wall may have affected.
const LAST_ROWS: usize = 2;
/// Number of the first run that procedures see.
const SEEN: u64 = 1000;

/// Inputs of a procedure.
pub struct Workbench<'a> {
    /// The simulator's file.
    pub path: &'a Path,
    /// The simulator.
    pub simulator: &'a Simulator,
    /// The simulator's training logs.
    pub logs: &'a Logs,
    /// The case to solve.
    pub case: &'a Case,
}

/// Result of a procedure.
pub struct Settled {
    /// The controller.
    pub controller: Controller,
    /// Number of runs on the robot.
    pub trials: usize,
    /// The procedure's own verdict.
    pub verdict: &'static str,
}

/// The paper's procedure: networks without corrections, straight distance to the target, one run of its genetic algorithm.
fn by_the_paper(bench: &Workbench) -> Result<Settled> {
    let Workbench { simulator, case, .. } = bench;
    let evaluator = FitnessEvaluator {
        environment: &Environment::new(simulator, &case.scene, case.pose(), Noise::Paper)?,
        target_cm: case.target_cm(),
        routes: None,
        decoder: GenotypeDecoder::new(simulator, MAX_STEPS),
        runs: paper::RUNS,
        floor_cm: paper::FLOOR_CM,
        random_numbers: RandomNumbers::Independent,
        seed: bench.seed(),
    };
    Ok(untried(paper::evolve(&Serial, &evaluator, &paper::settings(), |_, _| {})?.controller))
}

/// `mindgap evolve` without paths around obstacles and without the posterior.
fn evolve_straight(bench: &Workbench) -> Result<Settled> {
    let plain = Simulator { ensemble: None, ..bench.simulator.clone() };
    // Without obstacles every path is straight.
    let empty = Scene { obstacles: Vec::new(), ..bench.case.scene.clone() };
    Ok(untried(bench.candidates(&plain, &empty)?.swap_remove(0)))
}

/// `mindgap evolve`.
fn evolve(bench: &Workbench) -> Result<Settled> {
    Ok(untried(bench.judged()?.swap_remove(0)))
}

/// The one of the three best candidates of `mindgap evolve` that comes nearest to the target in a trial.
fn try_three(bench: &Workbench) -> Result<Settled> {
    let case = bench.case;
    let mut candidates = bench.judged()?;
    candidates.truncate(3);
    let trials = candidates.len();
    let missed_cm = |controller: &Controller| case.missed_cm(&case.drive(controller, SEEN));
    let nearest = candidates.into_iter().min_by(|a, b| missed_cm(a).total_cmp(&missed_cm(b)));
    let controller = nearest.ok_or_else(|| Error::new("no candidate"))?;
    Ok(Settled { controller, trials, verdict: "" })
}

/// Trains the motion networks again on all logs after each trial.
fn retrain(bench: &Workbench) -> Result<Settled> {
    let Workbench { simulator, logs, .. } = bench;
    bench.with_trials(|runs| {
        // The new runs were driven in another room. Without walls they train no sensor model.
        let runs = logs.runs.iter().chain(runs).cloned().collect();
        let all = Logs { robot: logs.robot, scene: Scene::default(), runs };
        let again = train(&Serial, &all, &Trainer::Fast, &TABLE_ONE, bench.seed(), &|_| {})?;
        let motion = again.reference.and_then(|reference| reference.motion);
        let reference = simulator.reference.clone().map(|before| NominalModel { motion, ..before });
        let (forward, lateral, turn) = (again.forward, again.lateral, again.turn);
        Ok(Simulator { forward, lateral, turn, reference, ensemble: None, ..(*simulator).clone() })
    })
}

/// Evolves at the posterior mean after each trial, without regard to its uncertainty.
fn correct(bench: &Workbench) -> Result<Settled> {
    let Workbench { simulator, case, .. } = bench;
    bench.with_trials(|runs| {
        if runs.is_empty() {
            return Ok((*simulator).clone());
        }
        let logs = Logs { robot: simulator.robot, scene: case.scene.clone(), runs: runs.to_vec() };
        Ok(adapt(simulator, &logs, bench.seed(), |_| ())?.simulator)
    })
}

/// `mindgap loop`.
fn loops(bench: &Workbench) -> Result<Settled> {
    let folder = tempfile::tempdir().map_err(|e| Error::new(e.to_string()))?;
    let scene = folder.path().join("scene.toml");
    bench.case.scene.write(&scene)?;
    let job = Job {
        executor: &Serial,
        folder: &folder.path().join("loop"),
        simulator: bench.path,
        scene: &scene,
        start: bench.case.start,
        trials: TRIALS,
        max_steps: MAX_STEPS,
        known: &[],
        seed: bench.seed(),
    };
    let state = closed_loop::run(&job, &mut TrialledRobot(bench.case.effects()), |_| {})?;
    let controller = ControllerFile::read(&job.folder.join("controller.toml"))?.controller;
    let verdict = match state.verdict {
        closed_loop::state::Verdict::Works => "works",
        closed_loop::state::Verdict::Infeasible => "out of reach",
        closed_loop::state::Verdict::TrialsExhausted if state.limit().is_some() => "limited by chance",
        closed_loop::state::Verdict::TrialsExhausted | closed_loop::state::Verdict::Running => "spent",
    };
    Ok(Settled { controller, trials: state.trials.len(), verdict })
}

/// `mindgap evolve`, then evolution on the robot.
fn on_robot(bench: &Workbench) -> Result<Settled> {
    let decoder = GenotypeDecoder::new(bench.simulator, MAX_STEPS);
    let (controller, trials) = on_robot::evolved(bench.case, &decoder, &bench.judged()?, bench.seed());
    Ok(Settled { controller, trials, verdict: "" })
}

fn untried(controller: Controller) -> Settled {
    Settled { controller, trials: 0, verdict: "" }
}

impl Workbench<'_> {
    fn seed(&self) -> u64 {
        derive(SEED, &[self.case.room, self.case.start as u64])
    }

    /// Returns controllers evolved at the posterior mean, or by the networks alone, with the paths of a room.
    fn candidates(&self, simulator: &Simulator, ways_of: &Scene) -> Result<Vec<Controller>> {
        let Case { scene, .. } = self.case;
        let robots = simulator.robots(1, self.seed());
        let environment = Environment::new(simulator, scene, self.case.pose(), Noise::Learned)?;
        let environment = environment.at_posterior_mean(robots.as_ref());
        let target_cm = self.case.target_cm();
        let task = EvolutionTask {
            executor: &Serial,
            environment: &environment,
            target_cm,
            routes: &RouteMap::new(ways_of, target_cm, simulator.robot.body_radius_cm),
            decoder: GenotypeDecoder::new(simulator, MAX_STEPS),
            seed: self.seed(),
        };
        Ok(robust::candidates(&task, |_, _| {})?.into_iter().map(|evolved| evolved.controller).collect())
    }

    /// Returns the candidates of `mindgap evolve`, the most likely to succeed over the posterior first.
    fn judged(&self) -> Result<Vec<Controller>> {
        let Workbench { simulator, case, .. } = self;
        let candidates = self.candidates(simulator, &case.scene)?;
        let robots = simulator.robots(ROBOTS, self.seed());
        let robots = robots.ok_or_else(|| Error::new("the simulator does not say what its logs leave open"))?;
        let judge =
            Judge::new(&Serial, simulator, &robots.drawn, &case.scene, case.pose(), case.target_cm(), self.seed())?;
        let chances = judge.success_probabilities(&candidates, RUNS)?;
        let mut judged: Vec<_> = candidates.into_iter().zip(chances).collect();
        judged.sort_by(|a, b| b.1.success.total_cmp(&a.1.success));
        Ok(judged.into_iter().map(|(controller, _)| controller).collect())
    }

    /// Evolves in the simulator that `learn` makes of the runs so far, then drives. A controller that reaches the target is
    /// driven again and is kept if it succeeds twice.
    fn with_trials(&self, learn: impl Fn(&[Run]) -> Result<Simulator>) -> Result<Settled> {
        let (mut runs, mut last): (Vec<Run>, Option<(Controller, bool)>) = (Vec::new(), None);
        for trial in 1..=TRIALS {
            let again = last.take().filter(|(_, reached)| *reached);
            let confirms = again.is_some();
            let controller = match again {
                Some((controller, _)) => controller,
                None => self.candidates(&learn(&runs)?, &self.case.scene)?.swap_remove(0),
            };
            let driven = self.case.drive(&controller, SEEN + trial as u64);
            let reached = self.case.reached(&driven);
            if confirms && reached {
                return Ok(Settled { controller, trials: trial, verdict: "works" });
            }
            let mut run = driven.to_run("run");
            if driven.termination == Termination::Crashed {
                let first = run.rows.len().saturating_sub(LAST_ROWS);
                (first..run.rows.len()).for_each(|row| run.rows.edit(row, |row| row.pose = None));
            }
            runs.push(run);
            last = Some((controller, reached));
        }
        let (controller, _) = last.ok_or_else(|| Error::new("no trial"))?;
        Ok(Settled { controller, trials: TRIALS, verdict: "spent" })
    }
}
