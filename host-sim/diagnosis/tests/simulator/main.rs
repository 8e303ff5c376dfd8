//! A simulator trained on logs of the built-in robot, and what it is good for.

mod added_effect;
mod extrapolation;
mod gap;
mod gap_apply;
mod made_up;
mod metamorphic;
mod own_effect;
mod sampling;
mod skid;
mod slow_drive;
mod turning_loss;

use std::sync::LazyLock;

use mindgap_built_in_robot::{ActiveEffect, default_robot, record, training_room};
use mindgap_foundations::executor::Serial;
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_logs::Logs;
use mindgap_models::simulator::Simulator;

/// Rows of each run.
const STEPS: usize = 60;

/// What the simulator is trained on.
static HEALTHY: LazyLock<Logs> = LazyLock::new(|| logs(60, &[], 1));

/// A simulator of the built-in robot as it is.
static SIMULATOR: LazyLock<Simulator> = LazyLock::new(|| {
    train(&Serial, &HEALTHY, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("the logs train every network")
});

fn logs(runs: usize, effects: &[&str], seed: u64) -> Logs {
    let effects: Vec<ActiveEffect> = effects.iter().map(|e| e.parse().expect("an effect")).collect();
    record(&default_robot(), &training_room(), runs, STEPS, &effects, seed).expect("the room has room")
}
