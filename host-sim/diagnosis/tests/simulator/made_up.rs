//! A made-up robot of two wheels, integrated in small steps: its own physics, apart from that of simulators and effects.

use glam::DVec2;
use mindgap_built_in_robot::default_robot;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;
use mindgap_logs::{CommandChange, CommandChanges, Logs, Robot, Row, Rows, Run, Scene};
use rand::RngExt;
use rand_distr::StandardNormal;

/// Time step of the physics, s.
const DT_S: f64 = 0.01;
/// Steps of 400 ms per run.
const ROWS: usize = 60;
/// Time between the poses of [`MadeUp::sampled`], ms.
const SEEN_MS: usize = 200;

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
            let mut moving = Moving::START;
            let row = |step: usize| {
                let noise: [f64; 3] = [0.1, 0.1, 0.005].map(|s: f64| s * rng.sample::<f64, _>(StandardNormal));
                let seen = moving.seen(noise);
                let unsteady = [0, 1].map(|_| 1.0 + 0.02 * rng.sample::<f64, _>(StandardNormal));
                for part in 0..per_row {
                    let sent = (step * per_row + part).checked_sub(late).map_or([0.0; 2], |at| commands[at / per_row]);
                    self.advance(&robot, &mut moving, sent, unsteady);
                }
                let [left, right] = commands[step];
                Row { t_ms: step as f64 * robot.step_ms, left, right, pose: Some(seen), ..Row::default() }
            };
            Run { name: format!("run-{number:03}"), rows: (0..ROWS).map(row).collect() }
        };
        Logs { robot, scene: scene.clone(), runs: (0..runs).map(run).collect() }
    }

    /// Logs of one drive by commands that change at any time, in rows of each of these steps, which are multiples of
    /// [`SEEN_MS`].
    pub fn sampled<const N: usize>(&self, steps_ms: [usize; N], runs: u64, seed: u64) -> [Logs; N] {
        let robot = |step_ms: usize| Robot { step_ms: step_ms as f64, ultrasonic: None, ..default_robot() };
        let scene = Scene::default();
        let driven: Vec<(CommandChanges, Vec<Pose>)> = (0..runs).map(|run| self.driven(seed, run)).collect();
        steps_ms.map(|step_ms| {
            let run = |(number, (changes, seen)): (usize, &(CommandChanges, Vec<Pose>))| {
                let seen = seen.iter().step_by(step_ms / SEEN_MS);
                let row =
                    |(k, pose): (usize, &Pose)| Row { t_ms: (k * step_ms) as f64, pose: Some(*pose), ..Row::default() };
                let mut rows: Rows = seen.enumerate().map(row).collect();
                rows.set_changes(changes.clone());
                Run { name: format!("run-{number:03}"), rows }
            };
            Logs { robot: robot(step_ms), scene: scene.clone(), runs: driven.iter().enumerate().map(run).collect() }
        })
    }

    /// Drives by random commands, and returns these and the poses seen every [`SEEN_MS`].
    fn driven(&self, seed: u64, run: u64) -> (CommandChanges, Vec<Pose>) {
        let mut rng = generator(seed, &[run]);
        let mut commands: Vec<[f64; 2]> = Vec::new();
        let mut changes = Vec::new();
        while commands.len() < ROWS * 40 {
            let command = [0, 1].map(|_| rng.random_range(-80.0..80.0f64).round());
            changes.push(CommandChange { t_ms: commands.len() as f64 * DT_S * 1000.0, command });
            commands.extend(vec![command; rng.random_range(90..=400)]);
        }
        let late = (self.dead_time_s / DT_S).round() as usize;
        let (mut moving, mut seen, mut unsteady) = (Moving::START, Vec::new(), [1.0; 2]);
        for at in 0..ROWS * 40 {
            if at % (SEEN_MS / 10) == 0 {
                seen.push(moving.seen([0.1, 0.1, 0.005].map(|s: f64| s * rng.sample::<f64, _>(StandardNormal))));
                unsteady = [0, 1].map(|_| 1.0 + 0.02 * rng.sample::<f64, _>(StandardNormal));
            }
            let sent = at.checked_sub(late).map_or([0.0; 2], |at| commands[at]);
            self.advance(&default_robot(), &mut moving, sent, unsteady);
        }
        (CommandChanges::of(changes).expect("commands"), seen)
    }

    /// Moves for [`DT_S`] under a command, with wheels that cover these multiples of their way.
    fn advance(&self, robot: &Robot, moving: &mut Moving, sent: [f64; 2], unsteady: [f64; 2]) {
        let Moving { pose, speeds_cm_s } = moving;
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
}

/// A made-up robot in motion.
struct Moving {
    pose: Pose,
    speeds_cm_s: [f64; 2],
}

impl Moving {
    const START: Moving =
        Moving { pose: Pose { position_cm: DVec2::splat(1000.0), heading_rad: 0.3 }, speeds_cm_s: [0.0; 2] };

    /// Returns the pose with an error.
    fn seen(&self, [x, y, heading_rad]: [f64; 3]) -> Pose {
        let [x_cm, y_cm] = self.pose.position_cm.to_array();
        Pose::new(x_cm + x, y_cm + y, self.pose.heading_rad + heading_rad)
    }
}
