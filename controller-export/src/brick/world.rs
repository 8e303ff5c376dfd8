//! The surroundings of a brick: what it senses and moves.

use super::motors::{Drive, PORTS as MOTORS};
use super::shaft::Shaft;

/// Sensors, motors, buttons and battery around a brick. Times are milliseconds since the program started.
pub trait World {
    /// The ultrasonic sensor's response to a request for its nearest echo; `port` counts from 0.
    fn sonar(&mut self, port: usize, t_ms: u32) -> Sonar;

    /// Its response to any other request, such as for its kind: only whether it answers counts.
    fn sonar_answers(&mut self, port: usize, t_ms: u32) -> Sonar;

    /// What a touch, light or sound sensor senses, 0..=100 percent; `None` if none is plugged in there.
    fn percent(&mut self, port: usize, t_ms: u32) -> Option<u8> {
        let _ = (port, t_ms);
        None
    }

    /// Sets the drive of a motor from now on; `port` counts from 0.
    fn motor(&mut self, port: usize, drive: Drive, t_ms: u32) {
        let _ = (port, drive, t_ms);
    }

    /// Rotation of a motor's shaft, degrees; `port` counts from 0.
    fn rotation_deg(&mut self, port: usize, t_ms: u32) -> i32 {
        let _ = (port, t_ms);
        0
    }

    /// State of the right (1), left (2) or orange (3) button.
    fn button(&mut self, button: u8, t_ms: u32) -> Button {
        let _ = (button, t_ms);
        Button::default()
    }

    /// When the dark button below them is pressed, which ends any program.
    fn exit_pressed_ms(&self) -> Option<u32> {
        None
    }

    /// Battery voltage in millivolts.
    fn battery_mv(&mut self, t_ms: u32) -> u16 {
        let _ = t_ms;
        7800
    }
}

/// Response of the ultrasonic sensor to a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sonar {
    /// A distance in cm; 255 if no echo returned.
    Echo(u8),
    /// No answer: unplugged or without power.
    Silent,
    /// An answer that begins and never ends.
    Hangs,
}

/// The state of a button.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Button {
    /// Whether it is down.
    pub pressed: bool,
    /// How often it has been released.
    pub released: u8,
}

/// A press of a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// The right (1), left (2) or orange (3) button.
    pub button: u8,
    /// When it goes down.
    pub down_ms: u32,
    /// When it goes up again.
    pub up_ms: u32,
}

impl Press {
    /// A press of the orange button.
    pub fn orange(down_ms: u32, up_ms: u32) -> Press {
        Press { button: 3, down_ms, up_ms }
    }
}

/// What a touch, light or sound sensor senses from a time on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// The sensor's port, from 0.
    pub port: usize,
    /// From when.
    pub t_ms: u32,
    /// How much, 0..=100; a touch sensor is pressed at more than 0.
    pub percent: u8,
}

/// A world by script: the ultrasonic sensor's answers, one a request, after which it is silent; the other sensors'
/// levels and the buttons' presses by time. Its motors turn freely.
///
/// A script that holds no distance from the next answer on is that of a sensor that is not there or broken, and then
/// requests for anything else get that answer too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScriptedWorld {
    /// Answers of the ultrasonic sensor, one a request.
    pub sonar: Vec<Sonar>,
    /// The port that it is plugged into, from 0.
    pub sonar_port: usize,
    /// What the other sensors sense, in order of time.
    pub levels: Vec<Level>,
    /// Presses of buttons.
    pub presses: Vec<Press>,
    /// When the dark button is pressed.
    pub exit_pressed_ms: Option<u32>,
    /// Battery voltage in millivolts.
    pub battery_mv: u16,
    /// Whether something holds the wheels.
    pub wheels_blocked: bool,
    /// Number of requests so far.
    pub asked: usize,
    /// The shafts of the motors.
    pub shafts: [Shaft; MOTORS],
}

impl ScriptedWorld {
    /// A sensor on port 4 with these answers, a charged battery, and no button pressed.
    pub fn sonar(answers: impl Into<Vec<Sonar>>) -> Self {
        ScriptedWorld { sonar: answers.into(), sonar_port: 3, battery_mv: 7800, ..ScriptedWorld::default() }
    }
}

impl World for ScriptedWorld {
    fn sonar(&mut self, port: usize, _: u32) -> Sonar {
        if port != self.sonar_port {
            return Sonar::Silent;
        }
        let answer = self.sonar.get(self.asked).copied().unwrap_or(Sonar::Silent);
        self.asked += 1;
        answer
    }

    fn sonar_answers(&mut self, port: usize, _: u32) -> Sonar {
        let rest = self.sonar.get(self.asked..).unwrap_or_default();
        match rest.first() {
            Some(next) if port == self.sonar_port => {
                rest.iter().find(|answer| matches!(answer, Sonar::Echo(_))).copied().unwrap_or(*next)
            }
            _ => Sonar::Silent,
        }
    }

    fn percent(&mut self, port: usize, t_ms: u32) -> Option<u8> {
        let level = self.levels.iter().rfind(|level| level.port == port && level.t_ms <= t_ms);
        level.map(|level| level.percent)
    }

    fn motor(&mut self, port: usize, drive: Drive, t_ms: u32) {
        if !self.wheels_blocked {
            self.shafts[port].set(drive, t_ms);
        }
    }

    fn rotation_deg(&mut self, port: usize, t_ms: u32) -> i32 {
        self.shafts[port].angle_deg(t_ms)
    }

    fn button(&mut self, button: u8, t_ms: u32) -> Button {
        let of_button = || self.presses.iter().filter(|press| press.button == button);
        let pressed = of_button().any(|press| (press.down_ms..press.up_ms).contains(&t_ms));
        let released = of_button().filter(|press| press.up_ms <= t_ms).count();
        Button { pressed, released: released as u8 }
    }

    fn exit_pressed_ms(&self) -> Option<u32> {
        self.exit_pressed_ms
    }

    fn battery_mv(&mut self, _: u32) -> u16 {
        self.battery_mv
    }
}
