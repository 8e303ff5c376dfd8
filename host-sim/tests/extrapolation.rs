//! What the fast trainer's networks say where no sample is: nothing explodes, and what physics orders stays in order.

use std::sync::LazyLock;

use mindgap_core::network::Network;
use mindgap_host_sim::built_in_robot::{default_robot, record, training_room};
use mindgap_host_sim::learn::dataset::{Dataset, Datasets};
use mindgap_host_sim::learn::train::{self, TABLE_ONE, Trainer};
use mindgap_host_sim::simulator::{Learned, Simulator};

const SEED: u64 = 1;
/// How far the grid goes beyond the range of an input, as a share of it.
const BEYOND: f32 = 0.2;
/// Points of the grid along each input.
const POINTS: usize = 15;

static LEARNED: LazyLock<(Datasets, Simulator)> = LazyLock::new(|| {
    let logs = record(&default_robot(), &training_room(), 60, 60, &[], SEED).unwrap();
    let simulator = train::train(&logs, &Trainer::Fast, &TABLE_ONE, SEED, |_| {}).unwrap();
    (Datasets::from_logs(&logs), simulator)
});

fn network<const N: usize>(learned: &Option<Learned<N>>) -> &Network<f32, N> {
    &learned.as_ref().unwrap().network
}

/// Asserts that on a grid over the inputs' range and beyond, outputs stay in the targets' range widened by half to
/// either side.
fn assert_tame<const N: usize>(name: &str, learned: &Option<Learned<N>>, data: &Dataset<N>) {
    let ranges = data.ranges();
    let targets = data.target_range();
    let width = targets.end() - targets.start();
    for point in 0..POINTS.pow(N as u32) {
        let inputs: [f32; N] = std::array::from_fn(|i| {
            let share = (point / POINTS.pow(i as u32) % POINTS) as f32 / (POINTS - 1) as f32;
            let (from, to) = (ranges[i].start(), ranges[i].end());
            from + (share * (1.0 + 2.0 * BEYOND) - BEYOND) * (to - from)
        });
        let output = network(learned).evaluate(inputs);
        let is_tame = (targets.start() - 0.5 * width..=targets.end() + 0.5 * width).contains(&output);
        assert!(is_tame, "{name}: {output} for {inputs:?}, with targets in {targets:?}");
    }
}

/// Asserts that outputs rise from one to the next, a little noise of the training apart.
fn assert_rising(name: &str, outputs: impl Iterator<Item = f32>, noise: f32) {
    let outputs: Vec<f32> = outputs.collect();
    assert!(outputs.windows(2).all(|pair| pair[1] > pair[0] - noise), "{name}: {outputs:?}");
    assert!(outputs.last() > outputs.first(), "{name}: {outputs:?}");
}

#[test]
fn nothing_explodes_beyond_the_samples() {
    let (data, s) = &*LEARNED;
    assert_tame("forward", &s.forward, &data.forward);
    assert_tame("lateral", &s.lateral, &data.lateral);
    assert_tame("turn", &s.turn, &data.turn);
    assert_tame("echo_value", &s.echo_value, &data.echo_value);
    assert_tame("echo_probability", &s.echo_probability, &data.echo_probability);
}

#[test]
fn what_physics_orders_stays_in_order_beyond_the_samples() {
    let (_, s) = &*LEARNED;
    let commands = || (-12..=12).map(|i| 10.0 * i as f32);
    let along = commands().map(|c| network(&s.forward).evaluate([c; 4]));
    assert_rising("faster is farther", along, 0.1);
    let turning = commands().map(|c| network(&s.turn).evaluate([-c, c, -c, c]));
    assert_rising("a larger difference turns more", turning, 0.5);
    // What is much farther seldom echoes: a reading then comes from something nearer beside it.
    let facing = (1..=8).map(|i| network(&s.echo_value).evaluate([20.0 * i as f32, 0.0]));
    assert_rising("what is farther reads farther", facing, 0.0);
    // Nearer to 90 degrees the rim of the beam meets the wall nearer by.
    let slanting = (0..=6).rev().map(|i| network(&s.echo_probability).evaluate([120.0, 10.0 * i as f32]));
    assert_rising("an echo from a slanting wall is rarer", slanting, 0.05);
}
