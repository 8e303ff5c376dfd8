//! The state of the built-in robot during a run.

use std::collections::VecDeque;

use rand::RngExt;

use super::BuiltInRobot;
use super::drivetrain::Drivetrain;
use super::noise::happens;
use super::sonar::{Ping, Receiver};
use mindgap_foundations::chance::Generator;
use mindgap_foundations::geometry::Pose;
use mindgap_logs::Row;

/// Time step of the physics; short compared with the relaxation of the tyres.
const TICK_MS: f64 = 2.0;

/// The built-in robot during a run.
#[derive(Clone, Debug)]
pub struct Body<'a> {
    robot: &'a BuiltInRobot,
    drivetrain: Drivetrain,
    receiver: Receiver,
    /// Heading that the compass's needle shows.
    needle_rad: f64,
    /// Past poses with their times, back to when the sensor sent the ping whose echo it reports now.
    trail: VecDeque<(f64, Pose)>,
    t_ms: f64,
    /// The command in effect at the motor driver.
    command: [f64; 2],
    /// Delayed commands with the times of their arrival.
    on_the_way: VecDeque<(f64, [f64; 2])>,
    /// Lower bound on the distance that the robot can travel without touching anything, cm.
    clear_cm: f64,
    crashed: bool,
}

impl<'a> Body<'a> {
    pub(super) fn at_rest(robot: &'a BuiltInRobot, at: Pose, rng: &mut Generator) -> Self {
        let clear_cm = robot.clearance_cm(&at);
        Body {
            robot,
            drivetrain: Drivetrain::at_rest(&robot.hardware, at, rng),
            receiver: Receiver::default(),
            needle_rad: at.heading_rad,
            trail: VecDeque::from([(0.0, at)]),
            t_ms: 0.0,
            command: [0.0, 0.0],
            on_the_way: VecDeque::new(),
            clear_cm,
            crashed: clear_cm <= 0.0,
        }
    }

    /// Applies left and right command, -100..=100, for a duration. A robot that touches something stays there.
    pub fn drive(&mut self, command: [f64; 2], duration_ms: f64, rng: &mut Generator) {
        let link = &self.robot.hardware.link;
        let due_ms = self.t_ms + link.delay_ms + link.delay_jitter_ms * rng.random::<f64>();
        if link.lost == 0.0 || !happens(link.lost, rng) {
            self.on_the_way.push_back((due_ms, command.map(|c| link.passes(c))));
        }
        let end_ms = self.t_ms + duration_ms;
        while self.t_ms < end_ms && !self.crashed {
            while self.on_the_way.front().is_some_and(|(due_ms, _)| *due_ms <= self.t_ms) {
                self.command = self.on_the_way.pop_front().map_or(self.command, |(_, command)| command);
            }
            let tick_ms = TICK_MS.min(end_ms - self.t_ms);
            self.clear_cm -= self.drivetrain.tick(&self.robot.hardware, self.command, tick_ms, rng);
            self.t_ms += tick_ms;
            self.needle_rad = self.robot.hardware.tracker.swung(self.needle_rad, self.true_pose().heading_rad, tick_ms);
            self.leave_trail();
            if self.clear_cm <= 0.0 {
                self.clear_cm = self.robot.clearance_cm(&self.true_pose());
                self.crashed = self.clear_cm <= 0.0;
            }
        }
        self.t_ms = end_ms;
    }

    /// The true pose.
    pub fn true_pose(&self) -> Pose {
        self.drivetrain.pose()
    }

    /// Whether the body has touched a wall or an obstacle.
    pub fn crashed(&self) -> bool {
        self.crashed
    }

    /// Distance between the body and the nearest wall or obstacle, cm.
    pub fn clearance_cm(&self) -> f64 {
        self.robot.clearance_cm(&self.true_pose())
    }

    /// One reading of the ultrasonic sensor, cm; `None` if it produced no value.
    pub fn read_sonar(&mut self, rng: &mut Generator) -> Option<f64> {
        let hardware = &self.robot.hardware;
        let (_, from) = self.trail[0];
        let ping = Ping { from, t_ms: self.t_ms, wheel_speed: self.drivetrain.wheel_speed(hardware) };
        self.receiver.read(&hardware.sonar, &self.robot.sides, &ping, rng)
    }

    /// The pose that the tracker measures; `None` for a lost frame.
    pub fn track(&self, rng: &mut Generator) -> Option<Pose> {
        self.robot.hardware.tracker.see(&self.true_pose(), self.needle_rad, rng)
    }

    /// The current row of a log, with the command from here on and the reading that led to it.
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
        }
    }

    fn leave_trail(&mut self) {
        self.trail.push_back((self.t_ms, self.true_pose()));
        let pinged_ms = self.t_ms - self.robot.hardware.sonar.age_ms;
        while self.trail.get(1).is_some_and(|(t_ms, _)| *t_ms <= pinged_ms) {
            self.trail.pop_front();
        }
    }
}
