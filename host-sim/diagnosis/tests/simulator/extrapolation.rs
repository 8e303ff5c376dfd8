//! What the fast trainer's networks say where no sample is: nothing explodes; and what physics orders is in order.

use std::ops::RangeInclusive;

use mindgap_core::network::Network;
use mindgap_learning::learn::dataset::{Dataset, Datasets};
use mindgap_models::simulator::Learned;

use crate::{HEALTHY, SIMULATOR};

/// How far the grid goes beyond the range of an input, as a share of it.
const BEYOND: f32 = 0.2;
/// Points of the grid along each input.
const POINTS: usize = 15;

fn network<const N: usize>(learned: &Option<Learned<N>>) -> &Network<f32, N> {
    &learned.as_ref().unwrap().network
}

/// Every point of a grid over boxes, one side of the box an input.
fn grid<const N: usize>(sides: [RangeInclusive<f32>; N]) -> impl Iterator<Item = [f32; N]> {
    (0..POINTS.pow(N as u32)).map(move |point| {
        std::array::from_fn(|i| {
            let share = (point / POINTS.pow(i as u32) % POINTS) as f32 / (POINTS - 1) as f32;
            sides[i].start() + share * (sides[i].end() - sides[i].start())
        })
    })
}

/// Asserts that all over the box that the samples span, most of which holds none, outputs stay in the targets' range
/// widened by half to either side.
fn assert_tame<const N: usize>(name: &str, learned: &Option<Learned<N>>, data: &Dataset<N>) {
    let targets = data.target_range();
    let width = targets.end() - targets.start();
    let tame = targets.start() - 0.5 * width..=targets.end() + 0.5 * width;
    for inputs in grid(data.ranges()) {
        let output = network(learned).evaluate(inputs);
        assert!(tame.contains(&output), "{name}: {output} for {inputs:?}, with targets in {targets:?}");
    }
}

/// Asserts that beyond that box a network says what it says at its edge.
fn assert_flat_beyond<const N: usize>(name: &str, learned: &Option<Learned<N>>, data: &Dataset<N>) {
    let ranges = data.ranges();
    let beyond = data.ranges().map(|range| {
        let margin = BEYOND * (range.end() - range.start());
        range.start() - margin..=range.end() + margin
    });
    for inputs in grid(beyond) {
        let edge = std::array::from_fn(|i| inputs[i].clamp(*ranges[i].start(), *ranges[i].end()));
        let (output, there) = (network(learned).evaluate(inputs), network(learned).evaluate(edge));
        assert!(
            (output - there).abs() <= 1e-3 * there.abs().max(1.0),
            "{name}: {output} for {inputs:?}, {there} at the edge"
        );
    }
}

/// Asserts that outputs rise from one to the next, a little noise of the training apart, and by `in_all` at least.
fn assert_rising(name: &str, outputs: impl Iterator<Item = f32>, noise: f32, in_all: f32) {
    let outputs: Vec<f32> = outputs.collect();
    assert!(outputs.windows(2).all(|pair| pair[1] > pair[0] - noise), "{name}: {outputs:?}");
    assert!(outputs[outputs.len() - 1] - outputs[0] > in_all, "{name}: {outputs:?}");
}

#[test]
fn nothing_explodes_where_no_sample_is() {
    let (data, s) = (Datasets::from_logs(&HEALTHY), &*SIMULATOR);
    assert_tame("forward", &s.forward, &data.forward);
    assert_tame("lateral", &s.lateral, &data.lateral);
    assert_tame("turn", &s.turn, &data.turn);
    assert_tame("echo_value", &s.echo_value, &data.echo_value);
    assert_tame("echo_probability", &s.echo_probability, &data.echo_probability);
}

#[test]
fn beyond_the_samples_networks_say_what_they_say_at_the_edge() {
    let (data, s) = (Datasets::from_logs(&HEALTHY), &*SIMULATOR);
    assert_flat_beyond("forward", &s.forward, &data.forward);
    assert_flat_beyond("lateral", &s.lateral, &data.lateral);
    assert_flat_beyond("turn", &s.turn, &data.turn);
    assert_flat_beyond("echo_value", &s.echo_value, &data.echo_value);
    assert_flat_beyond("echo_probability", &s.echo_probability, &data.echo_probability);
}

#[test]
fn what_physics_orders_is_in_order_among_the_samples() {
    let (data, s) = (Datasets::from_logs(&HEALTHY), &*SIMULATOR);
    // Beyond what every input has seen, outputs are flat and in no order.
    let least = |ranges: [RangeInclusive<f32>; 4]| {
        ranges.map(|range| range.end().min(-range.start())).into_iter().fold(f32::INFINITY, f32::min)
    };
    let most = least(data.forward.ranges());
    let commands = || (-6..=6).map(|i| most * i as f32 / 6.0);
    // At the share of its full speed that the healthy robot reaches, from backwards to forwards.
    let step_s = 1e-3 * HEALTHY.robot.step_ms as f32;
    let way_cm = 2.0 * most / 100.0 * HEALTHY.robot.full_speed_cm_s as f32 * step_s;
    let along = commands().map(|c| network(&s.forward).evaluate([c; 4]));
    assert_rising("faster is farther", along, 0.1, 0.8 * way_cm);
    let turn_deg = (2.0 * way_cm / HEALTHY.robot.track_cm as f32).to_degrees();
    let turning = commands().map(|c| network(&s.turn).evaluate([-c, c, -c, c]));
    assert_rising("a larger difference turns more", turning, 0.5, 0.7 * turn_deg);
    // What is much farther seldom echoes: a reading then comes from something nearer beside it.
    let facing = |steps| (1..=steps).map(|i| network(&s.echo_value).evaluate([20.0 * i as f32, 0.0]));
    assert_rising("what is farther reads farther", facing(8), 0.0, 80.0);
    assert_rising("as far as it is farther, where echoes are many", facing(5), 0.0, 0.9 * 80.0);
    // Nearer to 90 degrees the rim of the beam meets the wall nearer by.
    let slanting = (0..=6).rev().map(|i| network(&s.echo_probability).evaluate([120.0, 10.0 * i as f32]));
    assert_rising("an echo from a slanting wall is rarer", slanting, 0.05, 0.2);
}
