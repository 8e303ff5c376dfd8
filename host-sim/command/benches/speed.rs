//! How fast the harness is: `cargo bench -p mindgap-command`.

use std::process::Command;

use divan::Bencher;
use divan::counter::ItemsCount;
use mindgap_built_in_robot::{default_robot, four_obstacles, record, training_room};
use mindgap_core::controller::{Controller, Tuple, When};
use mindgap_core::network::Activation;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;
use mindgap_learning::evolve::fitness::{FitnessEvaluator, RandomNumbers};
use mindgap_learning::evolve::genome::GenotypeDecoder;
use mindgap_learning::evolve::paper;
use mindgap_learning::genetic::Settings;
use mindgap_learning::learn::dataset::Dataset;
use mindgap_learning::learn::genome::Shape;
use mindgap_learning::learn::{paper as paper_trainer, train};
use mindgap_models::simulator::environment::{Environment, SensorModel};
use mindgap_models::simulator::rollout::RolloutRequest;
use mindgap_models::simulator::{Noise, Simulator};
use mindgap_models::sonar::echo_law::Surfaces;
use mindgap_models::sonar::{FirstEchoLaw, SensorLaw};
use mindgap_workers::Workers;
use rand::RngExt;

const SEED: u64 = 1;
const MAX_STEPS: u16 = 150;

fn main() {
    divan::main();
}

/// What is computed in a step, besides geometry, draws and the controller.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// All five networks.
    FiveNetworks,
    /// The two sonar networks; the motions come from the controller's table.
    Tabulated,
    /// The same under the learned noise.
    TabulatedLearnedNoise,
    /// The beam in place of the sonar networks.
    TabulatedBeam,
}

/// Simulated runs side by side on one thread, all their steps taken; the counter is robot-steps.
#[divan::bench(args = [Step::FiveNetworks, Step::Tabulated, Step::TabulatedLearnedNoise, Step::TabulatedBeam])]
fn robot_steps(bencher: Bencher, step: Step) {
    const RUNS: u64 = 1000;
    let (simulator, scene) = (simulator(), four_obstacles());
    let (noise, sensor) = match step {
        Step::FiveNetworks | Step::Tabulated => (Noise::Paper, SensorModel::Networks),
        Step::TabulatedLearnedNoise => (Noise::Learned, SensorModel::Networks),
        Step::TabulatedBeam => (Noise::Learned, SensorModel::Beam),
    };
    let environment = Environment::new(&simulator, &scene, scene.starts[0], noise).expect("the robot has room");
    let environment = environment.sensing_by(sensor, &simulator, &scene).expect("no law is asked for");
    let environment = match step {
        Step::FiveNetworks => environment.asking_every_step(),
        _ => environment,
    };
    // It turns on the spot, and no reading is below zero: every run continues to its last step.
    let turning = Tuple { left: 30, right: -30, when: When::Smaller, threshold_cm: 0 };
    let controller = &Controller { step_ms: 400, max_steps: MAX_STEPS, tuples: [turning; 6] };
    let motions = &environment.motions(controller);
    let requests: Vec<RolloutRequest> = (0..RUNS).map(|seed| RolloutRequest { controller, motions, seed }).collect();
    let steps: u64 = environment.run(&requests).iter().map(|outcome| u64::from(outcome.steps)).sum();
    bencher.counter(ItemsCount::new(steps)).bench(|| environment.run(&requests));
}

/// The paper's genetic algorithm on the weights of a 2-10-1 network, with 1000 samples; the counter is generations.
#[divan::bench(sample_size = 1)]
fn training_generations(bencher: Bencher) {
    const GENERATIONS: usize = 100;
    let mut rng = generator(SEED, &[]);
    let mut data = Dataset::<2>::default();
    for run in 0..1000 {
        let (distance_cm, alpha_deg) = (rng.random_range(4.0..240.0), rng.random_range(0.0..90.0));
        data.push([distance_cm, alpha_deg], distance_cm + 0.1 * alpha_deg, run);
    }
    let genetic = Settings { stagnation: None, max_generations: GENERATIONS, ..Settings::default() };
    let options = paper_trainer::Options { genetic, ..paper_trainer::Options::default() };
    let train = || {
        paper_trainer::train(
            &Workers::default(),
            &data,
            Shape::halves(10),
            Activation::Linear,
            &options,
            SEED,
            |_, _| {},
        )
    };
    bencher.counter(ItemsCount::new(GENERATIONS)).bench(train);
}

/// One controller by the paper's procedure at its full size; the counter is generations.
#[divan::bench(sample_size = 1, sample_count = 3)]
fn evolving_generations(bencher: Bencher) {
    let (simulator, scene) = (simulator(), four_obstacles());
    let environment = &Environment::new(&simulator, &scene, scene.starts[0], Noise::Paper).expect("the robot has room");
    let evaluator = FitnessEvaluator {
        environment,
        target_cm: scene.target_cm.expect("the scene has a target"),
        routes: None,
        decoder: GenotypeDecoder::new(&simulator, MAX_STEPS),
        runs: paper::RUNS,
        floor_cm: paper::FLOOR_CM,
        random_numbers: RandomNumbers::Independent,
        seed: SEED,
    };
    let settings = paper::settings();
    let evolve = || paper::evolve(&Workers::default(), &evaluator, &settings, |_, _| {});
    bencher.counter(ItemsCount::new(settings.max_generations)).bench(evolve);
}

/// What a sensor that follows the first-echo law faces, at poses all over a room; the counter is poses.
#[divan::bench]
fn sights(bencher: Bencher) {
    const POSES: usize = 1000;
    let (scene, mut rng) = (four_obstacles(), generator(SEED, &[]));
    let surfaces = Surfaces::new(scene.sides());
    let law = SensorLaw::FirstEcho(FirstEchoLaw::ideal_ray(1.0, 0.0, [4.0, 240.0]));
    let poses: Vec<Pose> = (0..POSES)
        .map(|_| Pose::new(rng.random_range(20.0..280.0), rng.random_range(20.0..200.0), rng.random_range(-3.0..3.0)))
        .collect();
    let look = || poses.iter().map(|pose| law.view(&surfaces, pose, 1.0)).collect::<Vec<_>>();
    bencher.counter(ItemsCount::new(POSES)).bench(look);
}

/// Whole commands, from files to a file, on all processors: 100 runs of 60 steps, and the first start among four boxes.
#[divan::bench(args = ["train", "evolve", "evolve --paper"], sample_size = 1, sample_count = 3)]
fn command(bencher: Bencher, call: &str) {
    let folder = Folder::new();
    four_obstacles().write(&folder.0.path().join("scene.toml")).expect("a folder takes files");
    folder.mindgap("record --out logs");
    folder.mindgap("train logs --out sim.json");
    let call = match call.split_once("evolve") {
        Some((_, options)) => format!("evolve sim.json --scene scene.toml --out controller.toml{options}"),
        None => format!("{call} logs --out again.json"),
    };
    bencher.bench_local(|| folder.mindgap(&call));
}

/// The diagnosis of 24 runs of 60 steps of a robot in which these effects are at work, from files to a file, on all
/// processors: one cause, and two of which one moves the sensor.
#[divan::bench(args = ["drive_scale=1.1", "marker_offset=4@2 sonar_crosstalk=0.2"], sample_size = 1, sample_count = 3)]
fn diagnosis(bencher: Bencher, effects: &str) {
    let folder = Folder::new();
    folder.mindgap("record --out logs");
    folder.mindgap("train logs --out sim.json");
    let effects: String = effects.split(' ').map(|effect| format!(" --effect {effect}")).collect();
    folder.mindgap(&format!("record --out changed --runs 24 --seed 5{effects}"));
    bencher.bench_local(|| folder.mindgap("diagnose sim.json changed --json report.json --force"));
}

/// A folder in which commands are at work.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Folder(tempfile::tempdir().expect("a folder"))
    }

    /// Runs a command to its end.
    fn mindgap(&self, call: &str) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mindgap"));
        let done = command.args(call.split(' ')).current_dir(&self.0).output().expect("the command starts");
        assert!(done.status.success(), "{call}: {}", String::from_utf8_lossy(&done.stderr));
    }
}

/// A simulator with networks of the paper's sizes, learned from few logs.
fn simulator() -> Simulator {
    let logs = record(&default_robot(), &training_room(), 20, 40, &[], SEED).expect("the room has room");
    train::train(&Workers::default(), &logs, &train::Trainer::Fast, &train::TABLE_ONE, SEED, &|_| {})
        .expect("these logs train all networks")
}
