//! How far commands that are held for long turn the built-in robot, and the simulated one in the middle of what its logs
//! leave open, and how that scatters, as CSV for docs/reference/measurements.md: `cargo run --release -p mindgap-tests --example held-commands --
//! SIM STEPS`.

use std::path::Path;
use std::process::ExitCode;

use glam::DVec2;
use mindgap_built_in_robot::{BuiltInRobot, default_robot, run_controller};
use mindgap_core::controller::{Controller, Tuple, When};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_foundations::random::generator;
use mindgap_foundations::statistics::summary::{mean, root_mean_square};
use mindgap_logs::Scene;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::RolloutRequest;
use mindgap_models::simulator::{Noise, Simulator};
use mindgap_tests::exit_code::exit_code;

const SEED: u64 = 9;
const RUNS: u64 = 40;
const COMMANDS: [[i8; 2]; 12] = [
    [60, 60],
    [58, 60],
    [50, 55],
    [40, 50],
    [60, 40],
    [70, 40],
    [80, 20],
    [60, 0],
    [20, -20],
    [40, -40],
    [60, -60],
    [90, -90],
];

fn main() -> ExitCode {
    exit_code(env!("CARGO_BIN_NAME"), measure())
}

fn measure() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [sim, steps] = arguments.as_slice() else { return Err(Error::new("SIM STEPS")) };
    let max_steps: u16 = steps.parse().map_err(|e| Error::new(format!("{steps}: {e}")))?;
    let simulator = Simulator::read(Path::new(sim))?;
    // The walls are beyond the reach of any command.
    let scene = Scene { arena_cm: Some(DVec2::splat(10_000.0)), ..Scene::default() };
    let start = Pose::new(5000.0, 5000.0, 0.0);
    let robots = simulator.robots(0, SEED);
    let simulated = Environment::new(&simulator, &scene, start, Noise::Learned)?.at_posterior_mean(robots.as_ref());
    let robot = BuiltInRobot::new(&default_robot(), &scene, &[]);
    println!("left,right,robot_turn_deg,robot_scatter_deg,simulated_turn_deg,simulated_scatter_deg");
    for [left, right] in COMMANDS {
        let never = Tuple { left, right, when: When::Larger, threshold_cm: 255 };
        let controller = &Controller { step_ms: simulator.robot.step_ms.round() as u16, max_steps, tuples: [never; 6] };
        let motions = &simulated.motions(controller);
        let real = (0..RUNS).map(|run| {
            let driven = run_controller(&robot, controller, start, &mut generator(SEED, &[run]));
            // At the last point the robot has come to rest.
            turned_deg(driven.points[1..].iter().take(usize::from(max_steps)).map(|point| point.true_pose))
        });
        let model = (0..RUNS).map(|seed| {
            let (_, points) = simulated.trace(RolloutRequest { controller, motions, seed });
            turned_deg(points.into_iter().map(|point| point.pose))
        });
        let [robot, simulated] = [summary(real.collect()), summary(model.collect())];
        println!("{left},{right},{:.2},{:.2},{:.2},{:.2}", robot[0], robot[1], simulated[0], simulated[1]);
    }
    Ok(())
}

/// Returns the total turn of a robot that starts at heading 0 and turns by less than 180 degrees per step.
fn turned_deg(poses: impl Iterator<Item = Pose>) -> f64 {
    let mut before_rad = 0.0;
    let turned_rad: f64 = poses
        .map(|pose| {
            let turned_rad = wrap_rad(pose.heading_rad - before_rad);
            before_rad = pose.heading_rad;
            turned_rad
        })
        .sum();
    turned_rad.to_degrees()
}

/// Returns the mean and the standard deviation.
fn summary(values: Vec<f64>) -> [f64; 2] {
    let middle = mean(values.iter().copied());
    [middle, root_mean_square(values.iter().map(|value| value - middle))]
}
