//! `mindgap evolve`

use std::path::{Path, PathBuf};

use clap::{Args, value_parser};
use schemars::JsonSchema;
use serde::Serialize;

use super::checkpoint_args::{Checkpoint, CheckpointOption};
use super::choices::{SENSOR_MODELS, one_of};
use super::json_output::JsonOption;
use super::{Run, kinds, progress, textbook};
use mindgap_figures::pictures;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_learning::evolve::fitness::Success;
use mindgap_learning::evolve::request::{Answered, JUDGED_RUNS, Request};
use mindgap_learning::evolve::success_probability::SuccessProbability;
use mindgap_logs::controller_file::{ControllerFile, Origin};
use mindgap_logs::{Robot, Scene};
use mindgap_models::simulator::Noise;
use mindgap_models::simulator::environment::SensorModel;

/// Evolve one controller in a simulator.
#[derive(Args)]
pub struct Evolve {
    /// The simulator file.
    sim: PathBuf,
    /// Scene with a target and starts.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Number of the start in the scene, from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: usize,
    /// The controller file to write.
    #[arg(long)]
    out: PathBuf,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Follow the paper exactly: one run of the genetic algorithm, its fittest individual, echo dropouts as the only
    /// noise.
    #[arg(long)]
    paper: bool,
    /// Simulate echo dropouts only, as in the paper.
    #[arg(long)]
    paper_noise: bool,
    /// Sensor model: the beam model fitted to the training logs, the two networks, or the first-echo law, which is
    /// slower. --paper and --paper-noise use the networks.
    #[arg(long, value_parser = one_of::<SensorModel>(SENSOR_MODELS), default_value = "beam", conflicts_with_all = ["paper", "paper_noise"])]
    sonar: SensorModel,
    /// Maximum number of steps per run.
    #[arg(long, default_value_t = 60, value_parser = value_parser!(u16).range(1..))]
    max_steps: u16,
    #[command(flatten)]
    json: JsonOption,
    /// Range sensor that the controller asks (default: `[ultrasonic]`, or the first `[[range_sensor]]` where there is none).
    #[arg(long, value_name = "NAME")]
    sensor: Option<String>,
    /// Draw simulated runs of the controller into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    #[command(flatten)]
    checkpoint: CheckpointOption,
}

/// Results of `mindgap evolve`.
#[derive(Serialize, JsonSchema)]
pub struct EvolveResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// The controller file.
    controller: &'a Path,
    /// Number of the start in the scene, from 1.
    start: usize,
    /// Random seed.
    seed: u64,
    /// Number of generations of the genetic algorithm.
    generations: usize,
    /// Fitness of the controller in the search, 1/cm.
    fitness: f64,
    /// Success in new simulated runs.
    #[serde(flatten)]
    success: Success,
    /// Success probability over the robots that are consistent with the logs; null if the simulator has no such robots.
    chance: Option<SuccessProbability>,
}

impl Run for Evolve {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.sim, &self.scene]).writing([&self.out], kinds::CONTROLLER);
        let places = places.writing(self.json.path(), kinds::REPORT).filling(&self.figures);
        places.writing(self.checkpoint.path(), kinds::CHECKPOINT)
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        let simulator = textbook::simulator(&self.sim)?;
        let sensor = self.sensor.clone().filter(|sensor| sensor != simulator.first_sensor());
        let simulator = sensor.as_deref().map(|sensor| simulator.asking(sensor)).transpose()?.unwrap_or(simulator);
        let scene = Scene::read(&self.scene)?;
        let start = start_of(&scene, self.start, &simulator.robot, &self.scene)?;
        let request = Request {
            executor,
            simulator: &simulator,
            scene: &scene,
            start: self.start,
            max_steps: self.max_steps,
            paper: self.paper,
            noise: if self.paper || self.paper_noise { Noise::Paper } else { Noise::Learned },
            sensor: self.sonar,
            seed: self.seed,
        };
        let bar = progress::bar(request.generations() as u64);
        let answered = request.evolve(|generation, fitness| {
            bar.set_position(generation as u64 + 1);
            bar.set_message(format!("fitness {fitness:.3}"));
        });
        bar.finish_and_clear();
        let Answered { evolved, success, chance, rollouts } =
            answered.map_err(|error| error.or_in_file(&self.scene))?;
        let origin = Origin {
            simulator: name(&self.sim),
            scene: name(&self.scene),
            start: self.start,
            seed: self.seed,
            generations: evolved.generations,
            fitness: Some(evolved.fitness),
            success: success.rate,
        };
        if let Some(folder) = &self.figures {
            let title = format!("Start {}", self.start);
            pictures::paths(folder, &[pictures::simulated_paths(title, &scene, start, &rollouts)])?;
        }
        let sensors = std::array::from_fn(|_| sensor.clone());
        ControllerFile { controller: evolved.controller, sensors, origin: Some(origin) }.write(&self.out)?;
        let results = EvolveResults {
            schema: SchemaNumber,
            controller: &self.out,
            start: self.start,
            seed: self.seed,
            generations: evolved.generations,
            fitness: evolved.fitness,
            success,
            chance,
        };
        let text = format!(
            "start {}: {:.0} % of {JUDGED_RUNS} new simulated runs reach the target, {:.0} % crash; median distance {:.1} cm\n\
             {}controller written to {}\n",
            self.start,
            100.0 * success.rate,
            100.0 * success.crashed,
            success.median_cm,
            chance.map_or_else(String::new, |chance| describe(&chance)),
            self.out.display()
        );
        self.json.emit_sorted(&results, text)
    }

    fn checkpoint(&self) -> Option<Checkpoint> {
        self.checkpoint.for_output(&self.out)
    }

    fn is_shared(&self) -> bool {
        true
    }
}

fn describe(chance: &SuccessProbability) -> String {
    let epistemic = 100.0 * chance.epistemic_fraction;
    format!(
        "success probability over the posterior of robots: {chance}; {epistemic:.0} % of the uncertainty is epistemic\n"
    )
}

/// Returns start `number` (from 1) of a scene.
///
/// # Errors
/// If there is no such start, or the robot does not fit there.
pub fn start_of(scene: &Scene, number: usize, robot: &Robot, path: &Path) -> Result<Pose> {
    scene.start(number, robot.body_radius_cm).map_err(|error| error.or_in_file(path))
}

/// Returns the file name without folders: paths of this machine mean nothing to others.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
