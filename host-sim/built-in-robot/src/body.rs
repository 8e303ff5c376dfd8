//! The state of the built-in robot during a run.

use std::collections::VecDeque;

use rand::RngExt;

use super::BuiltInRobot;
use super::drivetrain::Drivetrain;
use super::hardware::Hardware;
use super::noise::happens;
use super::sonar::{Ping, Receiver};
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_foundations::random::Generator;
use mindgap_logs::Row;

/// Time step of the physics; short compared with the relaxation of the tyres.
const TICK_MS: f64 = 2.0;

/// The built-in robot during a run.
#[derive(Clone, Debug)]
pub struct Body<'a> {
    robot: &'a BuiltInRobot,
    drivetrain: Drivetrain,
    receiver: Receiver,
    /// Heading shown by the compass needle.
    needle_rad: f64,
    /// The past, back to the oldest that sensor or tracker still report.
    trail: VecDeque<Past>,
    t_ms: f64,
    /// The command in effect at the motor driver.
    command: [f64; 2],
    /// Delayed commands with their arrival times.
    in_transit: VecDeque<(f64, [f64; 2])>,
    /// Lower bound on the distance that the robot can travel without touching anything, cm.
    clear_cm: f64,
    crashed: bool,
}

/// Where the robot was.
#[derive(Clone, Copy, Debug)]
struct Past {
    t_ms: f64,
    pose: Pose,
    /// Heading shown by the compass needle.
    needle_rad: f64,
}

impl<'a> Body<'a> {
    pub(super) fn at_rest(robot: &'a BuiltInRobot, at: Pose, rng: &mut Generator) -> Self {
        let clear_cm = robot.clearance_cm(&at);
        Body {
            robot,
            drivetrain: Drivetrain::at_rest(&robot.hardware, at, rng),
            receiver: Receiver::default(),
            needle_rad: at.heading_rad,
            trail: VecDeque::from([Past { t_ms: 0.0, pose: at, needle_rad: at.heading_rad }]),
            t_ms: 0.0,
            command: [0.0, 0.0],
            in_transit: VecDeque::new(),
            clear_cm,
            crashed: clear_cm <= 0.0,
        }
    }

    /// Applies a left and right command, -100..=100, for a duration. A robot that touches something stays there.
    pub fn drive(&mut self, command: [f64; 2], duration_ms: f64, rng: &mut Generator) {
        let link = &self.robot.hardware.link;
        let due_ms = self.t_ms + link.delay_ms + link.delay_jitter_ms * rng.random::<f64>();
        if link.lost == 0.0 || !happens(link.lost, rng) {
            self.in_transit.push_back((due_ms, command.map(|c| link.quantised(c))));
        }
        let end_ms = self.t_ms + duration_ms;
        while self.t_ms < end_ms && !self.crashed {
            while self.in_transit.front().is_some_and(|(due_ms, _)| *due_ms <= self.t_ms) {
                self.command = self.in_transit.pop_front().map_or(self.command, |(_, command)| command);
            }
            let tick_ms = TICK_MS.min(end_ms - self.t_ms);
            self.clear_cm -= self.drivetrain.tick(&self.robot.hardware, self.command, tick_ms, rng);
            self.t_ms += tick_ms;
            self.needle_rad =
                self.robot.hardware.tracker.needle_after(self.needle_rad, self.true_pose().heading_rad, tick_ms);
            self.record_trail();
            if self.clear_cm <= 0.0 {
                self.clear_cm = self.robot.clearance_cm(&self.true_pose());
                self.crashed = self.clear_cm <= 0.0;
            }
        }
        self.t_ms = end_ms;
    }

    /// Returns the true pose.
    pub fn true_pose(&self) -> Pose {
        self.drivetrain.pose()
    }

    /// Returns whether the body has touched a wall or an obstacle.
    pub fn crashed(&self) -> bool {
        self.crashed
    }

    /// Returns the distance between the body and the nearest wall or obstacle, cm.
    pub fn clearance_cm(&self) -> f64 {
        self.robot.clearance_cm(&self.true_pose())
    }

    /// Reads the ultrasonic sensor, cm; `None` if it produced no value.
    pub fn read_sonar(&mut self, rng: &mut Generator) -> Option<f64> {
        let hardware = &self.robot.hardware;
        let from = self.past(self.t_ms - hardware.sonar.age_ms).pose;
        let ping = Ping { from, t_ms: self.t_ms, wheel_speed: self.drivetrain.wheel_speed(hardware) };
        self.receiver.read(&hardware.sonar, &self.robot.sides, &ping, rng)
    }

    /// Returns the pose measured by the tracker; `None` for a lost frame.
    pub fn track(&self, rng: &mut Generator) -> Option<Pose> {
        let tracker = &self.robot.hardware.tracker;
        let Past { t_ms, pose, needle_rad } = self.past(self.t_ms - tracker.age_ms);
        let behind_rad = self.behind_rad(t_ms - tracker.averaged_ms, t_ms);
        tracker.see(&pose, needle_rad, behind_rad, rng)
    }

    /// Returns the current row of a log, with the command from here on and the reading that led to it.
    pub fn row(&self, command: [f64; 2], echo_cm: Option<f64>, rng: &mut Generator) -> Row {
        let [rot_left_deg, rot_right_deg] = self.drivetrain.counters_deg();
        Row {
            t_ms: self.t_ms,
            left: command[0],
            right: command[1],
            pose: self.track(rng),
            echo_cm,
            rot_left_deg: Some(rot_left_deg),
            rot_right_deg: Some(rot_right_deg),
            battery_mv: Some((1000.0 * self.drivetrain.battery_v(&self.robot.hardware)).round()),
            gyro_deg_s: None,
        }
    }

    fn record_trail(&mut self) {
        let Hardware { sonar, tracker, .. } = &self.robot.hardware;
        let oldest_ms = self.t_ms - f64::max(sonar.age_ms, tracker.age_ms + tracker.averaged_ms);
        self.trail.push_back(Past { t_ms: self.t_ms, pose: self.true_pose(), needle_rad: self.needle_rad });
        while self.trail.get(1).is_some_and(|past| past.t_ms <= oldest_ms) {
            self.trail.pop_front();
        }
    }

    /// Returns where the robot was at a time, or where its trail begins.
    fn past(&self, t_ms: f64) -> Past {
        let after = self.trail.partition_point(|past| past.t_ms <= t_ms);
        self.trail[after.max(1) - 1]
    }

    /// Returns by how much the mean heading between two times is behind the last one.
    fn behind_rad(&self, from_ms: f64, to_ms: f64) -> f64 {
        let now_rad = self.past(to_ms).pose.heading_rad;
        let between = self.trail.iter().filter(|past| from_ms < past.t_ms && past.t_ms <= to_ms);
        let (sum_rad, count) = between.fold((0.0, 0.0), |(sum_rad, count), past| {
            (sum_rad + wrap_rad(now_rad - past.pose.heading_rad), count + 1.0)
        });
        if count > 0.0 { sum_rad / count } else { 0.0 }
    }
}
