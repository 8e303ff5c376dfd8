//! The whole pipeline on the built-in robot: record, train, evaluate, evolve, simulate, test on the robot, export, plot;
//! then the closed loop with a robot that has changed since its logs.

pub mod repair;
pub mod robot;

use std::cell::RefCell;
use std::fs;
use std::path::Path;

use glam::DVec2;
use mindgap_controller_export::Origin;
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::nxc::{self, NxcOptions};
use mindgap_core::controller::Controller;
use schemars::JsonSchema;
use serde::Serialize;

use mindgap_built_in_robot::{self as built_in_robot, BuiltInRobot, Trajectory};
use mindgap_figures::pictures;
use mindgap_figures::report::paths::{PathPanel, Trace};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_foundations::random::{derive, generator};
use mindgap_learning::evaluation::accuracy::{self, Evaluation};
use mindgap_learning::evolve::fitness::Success;
use mindgap_learning::evolve::genome::GenotypeDecoder;
use mindgap_learning::evolve::paper::Evolved;
use mindgap_learning::evolve::request::Request;
use mindgap_learning::evolve::robust;
use mindgap_learning::evolve::route::RouteMap;
use mindgap_learning::evolve::task::EvolutionTask;
use mindgap_learning::learn::train::{self, TABLE_ONE, Trainer};
use mindgap_logs::controller_file::{self, ControllerFile};
use mindgap_logs::{Scene, Termination};
use mindgap_models::simulator::ensemble::Robots;
use mindgap_models::simulator::environment::{Environment, SensorModel};
use mindgap_models::simulator::rollout_report::RolloutReport;
use mindgap_models::simulator::{Noise, Simulator};
use repair::Repair;

const STEPS: usize = 60;
const MAX_STEPS: u16 = 60;
/// Number of controllers per start that are tested on the robot.
pub const TRIED: usize = 3;
/// Number of runs of each controller on the robot, and of simulated ones (paper, figure 4).
pub const TRIALS: usize = 3;
/// Number of new simulated runs for a success rate.
pub const JUDGED_RUNS: usize = 200;

/// Size of the demo.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    training_runs: usize,
    held_out_runs: usize,
    /// Number of starts for which controllers are evolved.
    pub starts: usize,
    /// Whether each start has a single run of the genetic algorithm and one controller, as in the paper.
    pub paper: bool,
    /// Maximum number of runs of the loop on the changed robot.
    pub trials: usize,
}

impl Size {
    /// Size of the paper's experiments.
    pub const USUAL: Size = Size { training_runs: 100, held_out_runs: 30, starts: 4, paper: false, trials: 5 };
    /// Short version.
    pub const QUICK: Size = Size { training_runs: 12, held_out_runs: 4, starts: 1, paper: true, trials: 1 };
}

/// Keys of the random streams.
#[derive(Clone, Copy)]
enum Purpose {
    TrainingLogs,
    HeldOutLogs,
    Training,
    Evolution,
    Simulation,
    Trial,
    Repair,
}

/// Stage of the demo, for a progress display.
#[derive(Clone, Debug, PartialEq)]
pub enum Stage {
    /// Recording of logs.
    Recording,
    /// Training of a network.
    Training(train::Progress),
    /// Evolution of a controller.
    Evolving {
        /// Number of the start, from 1.
        start: usize,
        /// Number of completed generations.
        generation: usize,
        /// Maximum number of generations.
        generations: usize,
    },
    /// Drawing of the figures.
    Drawing,
    /// Closed loop with the changed robot.
    Repairing {
        /// Number of the trial, from 1.
        trial: usize,
    },
}

/// Results.
pub struct Summary {
    /// Accuracy of the networks on held-out logs.
    pub evaluation: Evaluation,
    /// One entry per start.
    pub starts: Vec<StartSummary>,
    /// Simulated and real paths per start.
    pub panels: Vec<PathPanel>,
    /// Result of the loop with the changed robot.
    pub repair: Repair,
}

/// Success of one start's controller in simulation and in reality.
#[derive(Serialize, JsonSchema)]
pub struct StartSummary {
    /// Success in new simulated runs.
    pub simulated: Success,
    /// Success on the built-in robot.
    pub real: Success,
}

/// A start's controller and its runs.
struct Trial {
    /// Evolved controllers, best in a test on the robot first.
    controllers: Vec<Controller>,
    rollouts: RolloutReport,
    trajectories: Vec<Trajectory>,
    summary: StartSummary,
}

/// Runs the demo and writes all results to the folder `out` at the end.
///
/// # Errors
/// If `out` cannot be written.
pub fn run(executor: &dyn Executor, out: &Path, seed: u64, size: Size, watch: impl Fn(Stage)) -> Result<Summary> {
    let made = RefCell::new(Vec::new());
    let is_ours = |name: &str| made.borrow().iter().any(|made| made == name);
    files::write_folder(out, is_ours, |fresh| {
        let summary = fill(executor, fresh, seed, size, watch)?;
        let entries = fs::read_dir(fresh).map_err(|e| Error::in_file(out, format!("cannot be read: {e}")))?;
        made.borrow_mut().extend(entries.flatten().map(|entry| entry.file_name()));
        Ok(summary)
    })
}

fn fill(executor: &dyn Executor, out: &Path, seed: u64, size: Size, watch: impl Fn(Stage)) -> Result<Summary> {
    let of = |purpose: Purpose| derive(seed, &[purpose as u64]);
    watch(Stage::Recording);
    let robot = built_in_robot::default_robot();
    let mut scene = built_in_robot::four_obstacles();
    scene.starts.truncate(size.starts);
    let record = |room: &Scene, runs, purpose| built_in_robot::record(&robot, room, runs, STEPS, &[], of(purpose));
    let logs = record(&built_in_robot::training_room(), size.training_runs, Purpose::TrainingLogs)?;
    logs.write(&out.join("logs"))?;
    let held_out = record(&scene, size.held_out_runs, Purpose::HeldOutLogs)?;
    held_out.write(&out.join("held-out-logs"))?;
    scene.write(&out.join("scene.toml"))?;
    let simulator = train::train(executor, &logs, &Trainer::Fast, &TABLE_ONE, of(Purpose::Training), &|p| {
        watch(Stage::Training(p))
    })?;
    simulator.write(&out.join("simulator.json"))?;
    let evaluation = accuracy::evaluate(&simulator, &held_out, |_, _| ())?;
    files::write_json(&out.join("evaluation.json"), &evaluation)?;
    let robots = simulator.robots(0, of(Purpose::Evolution));
    let demo = DemoRun {
        executor,
        out,
        simulator: &simulator,
        robots: robots.as_ref(),
        scene: &scene,
        paper: size.paper,
        watch: &watch,
    };
    let trials = (0..scene.starts.len())
        .map(|start| demo.start(start, [Purpose::Evolution, Purpose::Simulation, Purpose::Trial].map(of)))
        .collect::<Result<Vec<_>>>()?;
    watch(Stage::Drawing);
    pictures::networks(out, &simulator, &evaluation, &held_out)?;
    let panels: Vec<PathPanel> = trials.iter().enumerate().map(|(i, trial)| panel(i, trial, &scene)).collect();
    pictures::paths(out, &panels)?;
    // The start whose controller does best on the unchanged robot.
    let real = |i: usize| &trials[i].summary.real;
    let better = |a: &usize, b: &usize| {
        real(*b).rate.total_cmp(&real(*a).rate).then(real(*a).median_cm.total_cmp(&real(*b).median_cm))
    };
    let best = (0..trials.len()).min_by(better).ok_or_else(|| Error::new("the scene has no start"))?;
    let watch_trial = |trial| watch(Stage::Repairing { trial });
    let job = repair::Job { start: best + 1, max_steps: MAX_STEPS, trials: size.trials, seed: of(Purpose::Repair) };
    let repair = repair::run(executor, out, &trials[best].controllers, &job, watch_trial)?;
    Ok(Summary { evaluation, starts: trials.into_iter().map(|trial| trial.summary).collect(), panels, repair })
}

/// Inputs common to all starts.
struct DemoRun<'a, W> {
    executor: &'a dyn Executor,
    out: &'a Path,
    simulator: &'a Simulator,
    /// Robots of the posterior.
    robots: Option<&'a Robots>,
    scene: &'a Scene,
    /// Whether to search for controllers as in the paper.
    paper: bool,
    watch: &'a W,
}

impl<W: Fn(Stage)> DemoRun<'_, W> {
    /// Evolves controllers for one start (from 0), keeps the best one in a test on the robot, then writes, simulates and
    /// drives it.
    fn start(&self, start: usize, [evolution, simulation, trial]: [u64; 3]) -> Result<Trial> {
        let pose = self.scene.starts[start];
        let environment = Environment::new(self.simulator, self.scene, pose, Noise::Learned)?;
        let environment = &environment.at_posterior_mean(self.robots);
        let target_cm = self.scene.target_cm.ok_or_else(|| Error::new("the scene has no target"))?;
        let decoder = GenotypeDecoder::new(self.simulator, MAX_STEPS);
        let seed = derive(evolution, &[start as u64]);
        let routes = &RouteMap::new(self.scene, target_cm, self.simulator.robot.body_radius_cm);
        let task = EvolutionTask { executor: self.executor, environment, target_cm, routes, decoder, seed };
        let robot = &BuiltInRobot::new(&self.simulator.robot, self.scene, &[]);
        let drive = |controller: &Controller, place: &[u64]| {
            built_in_robot::run_controller(robot, controller, pose, &mut generator(trial, place))
        };
        // Real runs of one controller nearly coincide, so a single one shows whether it transfers.
        let mut candidates = self.candidates(start + 1, &task)?;
        candidates.truncate(TRIED);
        candidates.sort_by_cached_key(|c| millimetres_off(&drive(&c.controller, &[start as u64]), target_cm));
        let evolved = &candidates[0];
        let controller = evolved.controller.clone();
        let simulated = task.success(&controller, JUDGED_RUNS);
        let origin = controller_file::Origin {
            simulator: "simulator.json".into(),
            scene: "scene.toml".into(),
            start: start + 1,
            seed,
            generations: evolved.generations,
            fitness: Some(evolved.fitness),
            success: simulated.rate,
        };
        self.write(start + 1, &controller, origin)?;
        let rollouts =
            RolloutReport::new(environment, self.scene, &controller, TRIALS, derive(simulation, &[start as u64]));
        let trajectories: Vec<Trajectory> =
            (0..TRIALS as u64).map(|run| drive(&controller, &[start as u64, run])).collect();
        let real = success(trajectories.iter().cloned(), target_cm);
        let controllers = candidates.into_iter().map(|c| c.controller).collect();
        Ok(Trial { controllers, rollouts, trajectories, summary: StartSummary { simulated, real } })
    }

    /// Returns controllers for a start (from 1), the most promising first.
    fn candidates(&self, start: usize, task: &EvolutionTask) -> Result<Vec<Evolved>> {
        let evolving = |generation, generations| (self.watch)(Stage::Evolving { start, generation, generations });
        if !self.paper {
            return robust::candidates(task, |generation, _| evolving(generation, robust::GENERATIONS));
        }
        let request = Request {
            executor: self.executor,
            simulator: self.simulator,
            scene: self.scene,
            start,
            max_steps: MAX_STEPS,
            paper: true,
            noise: Noise::Paper,
            sensor: SensorModel::Networks,
            seed: task.seed,
        };
        Ok(vec![request.evolve(|generation, _| evolving(generation, request.generations()))?.evolved])
    }

    fn write(&self, number: usize, controller: &Controller, origin: controller_file::Origin) -> Result<()> {
        let name = format!("start-{number}");
        let in_file = |e: mindgap_controller_export::ExportError| Error::new(e.to_string());
        let program = BrickName::program(&name).map_err(in_file)?;
        let options = NxcOptions { display: true, ..NxcOptions::new(program) };
        let file = ControllerFile { controller: controller.clone(), sensors: Default::default(), origin: Some(origin) };
        let source = nxc::program(controller, &Origin::from(&file), &options).map_err(in_file)?;
        files::write(&self.out.join(format!("{name}.nxc")), source)?;
        file.write(&self.out.join(format!("{name}.toml")))
    }
}

/// Returns the simulated and real paths of a start (from 0).
fn panel(start: usize, trial: &Trial, scene: &Scene) -> PathPanel {
    let title = format!("Start {}", start + 1);
    let simulated = pictures::simulated_paths(title, scene, scene.starts[start], &trial.rollouts);
    let trace = |trajectory: &Trajectory| Trace {
        points_cm: trajectory.points.iter().map(|m| m.true_pose.position_cm).collect(),
        crashed: crashed(trajectory),
    };
    PathPanel { real: trial.trajectories.iter().map(trace).collect(), ..simulated }
}

fn crashed(trajectory: &Trajectory) -> bool {
    trajectory.termination == Termination::Crashed
}

/// Returns the final distance to the target in mm, or the largest number after a crash.
fn millimetres_off(trajectory: &Trajectory, target_cm: DVec2) -> u64 {
    if crashed(trajectory) { u64::MAX } else { (10.0 * trajectory.end().position_cm.distance(target_cm)) as u64 }
}

fn success(trajectories: impl Iterator<Item = Trajectory>, target_cm: DVec2) -> Success {
    Success::of_ends(trajectories.map(|driven| (driven.end().position_cm.distance(target_cm), crashed(&driven))))
}
