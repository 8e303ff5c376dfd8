//! A simulator and an [`EvolutionTask`] for tests.

use std::sync::LazyLock;

use super::genome::GenotypeDecoder;
use super::route::RouteMap;
use super::task::EvolutionTask;
use crate::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_built_in_robot::{default_robot, four_obstacles, record, training_room};
use mindgap_foundations::executor::Serial;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::{Noise, Simulator};

const SEED: u64 = 5;

/// A simulator of the built-in robot, trained on a few logs.
pub static SIMULATOR: LazyLock<Simulator> = LazyLock::new(|| {
    let logs = record(&default_robot(), &training_room(), 20, 40, &[], SEED).unwrap();
    train(&Serial, &logs, &Trainer::Fast, &TABLE_ONE, SEED, &|_| {}).unwrap()
});

/// Calls `check` with a task in the scene with four obstacles.
pub fn with_task(check: impl Fn(&EvolutionTask)) {
    let scene = four_obstacles();
    let target_cm = scene.target_cm.unwrap();
    let environment = Environment::new(&SIMULATOR, &scene, scene.starts[0], Noise::Learned).unwrap();
    check(&EvolutionTask {
        executor: &Serial,
        environment: &environment,
        target_cm,
        routes: &RouteMap::new(&scene, target_cm, SIMULATOR.robot.body_radius_cm),
        decoder: GenotypeDecoder::new(&SIMULATOR, 60),
        seed: SEED,
    });
}
