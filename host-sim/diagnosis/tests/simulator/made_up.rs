//! A made-up robot of two wheels, integrated in small steps: its own physics, apart from that of simulators and effects.

use glam::DVec2;
use mindgap_built_in_robot::default_robot;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;
use mindgap_logs::{Logs, Row, Run, Scene};
use rand::RngExt;
use rand_distr::StandardNormal;

/// Time step of the physics, s.
const DT_S: f64 = 0.01;
/// Steps of 400 ms per run.
const ROWS: usize = 60;

/// What differs from a textbook robot.
#[derive(Clone, Copy)]
pub struct MadeUp {
    /// The track, in multiples of what robot.toml says.
    pub stretch: f64,
    /// Time until a command acts on the wheels, s.
    pub dead_time_s: f64,
    /// Time constant with which they then follow it, s.
    pub lag_s: f64,
    /// The most by which the speed of a wheel changes, cm/s².
    pub ramp_cm_s2: f64,
    /// What the left motor delivers of its speed.
    pub left: f64,
}

impl MadeUp {
    /// The textbook robot.
    pub const TEXTBOOK: MadeUp =
        MadeUp { stretch: 1.0, dead_time_s: 0.0, lag_s: 0.0, ramp_cm_s2: f64::INFINITY, left: 1.0 };

    /// Logs of random commands that are held for three to ten steps.
    pub fn logs(&self, runs: u64, seed: u64) -> Logs {
        let robot = default_robot();
        let scene = Scene { arena_cm: Some(DVec2::splat(2000.0)), ..Scene::default() };
        let per_row = (robot.step_ms / 1000.0 / DT_S).round() as usize;
        let late = (self.dead_time_s / DT_S).round() as usize;
        let run = |number: u64| {
            let mut rng = generator(seed, &[number]);
            let mut commands: Vec<[f64; 2]> = Vec::new();
            while commands.len() < ROWS {
                let command = [0, 1].map(|_| rng.random_range(-80.0..80.0f64).round());
                commands.extend(vec![command; rng.random_range(3..=10)]);
            }
            let (mut pose, mut speeds_cm_s) = (Pose::new(1000.0, 1000.0, 0.3), [0.0; 2]);
            let row = |step: usize| {
                let noise: [f64; 3] = [0.1, 0.1, 0.005].map(|s: f64| s * rng.sample::<f64, _>(StandardNormal));
                let [x, y] = pose.position_cm.to_array();
                let seen = Pose::new(x + noise[0], y + noise[1], pose.heading_rad + noise[2]);
                let unsteady = [0, 1].map(|_| 1.0 + 0.02 * rng.sample::<f64, _>(StandardNormal));
                for part in 0..per_row {
                    let sent = (step * per_row + part).checked_sub(late).map_or([0.0; 2], |at| commands[at / per_row]);
                    for wheel in 0..2 {
                        let towards = sent[wheel] / 100.0 * robot.full_speed_cm_s;
                        let most_cm_s = self.ramp_cm_s2 * DT_S;
                        let change = (towards - speeds_cm_s[wheel]) * f64::min(DT_S / self.lag_s.max(DT_S), 1.0);
                        speeds_cm_s[wheel] += change.clamp(-most_cm_s, most_cm_s);
                    }
                    let [left, right] = [speeds_cm_s[0] * self.left * unsteady[0], speeds_cm_s[1] * unsteady[1]];
                    let turn_rad = (right - left) / (self.stretch * robot.track_cm) * DT_S;
                    let towards = DVec2::from_angle(pose.heading_rad + 0.5 * turn_rad);
                    pose.position_cm += 0.5 * (left + right) * DT_S * towards;
                    pose.heading_rad += turn_rad;
                }
                let [left, right] = commands[step];
                Row { t_ms: step as f64 * robot.step_ms, left, right, pose: Some(seen), ..Row::default() }
            };
            Run { name: format!("run-{number:03}"), rows: (0..ROWS).map(row).collect() }
        };
        Logs { robot, scene: scene.clone(), runs: (0..runs).map(run).collect() }
    }
}
