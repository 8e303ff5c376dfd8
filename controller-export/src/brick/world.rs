//! The surroundings of a brick: what it senses and moves.

use super::motors::Drive;

/// Sensors, motors, buttons and battery around a brick. Times are milliseconds since the program started.
pub trait World {
    /// The ultrasonic sensor's response to a request for its nearest echo; `port` counts from 0.
    fn sonar(&mut self, port: usize, t_ms: u32) -> Sonar;

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

/// A world with scripted answers of the sensor, one a request; after the last one the sensor is silent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ScriptedWorld {
    /// Answers of the ultrasonic sensor, one a request.
    pub sonar: Vec<Sonar>,
    /// The port that it is plugged into, from 0.
    pub sonar_port: usize,
    /// When the dark button is pressed.
    pub exit_pressed_ms: Option<u32>,
    /// Battery voltage in millivolts.
    pub battery_mv: u16,
    /// Times at which the orange button goes down and up again.
    pub center_pressed_ms: Vec<(u32, u32)>,
    /// Number of requests so far.
    pub asked: usize,
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

    fn button(&mut self, button: u8, t_ms: u32) -> Button {
        const CENTER: u8 = 3;
        if button != CENTER {
            return Button::default();
        }
        let pressed = self.center_pressed_ms.iter().any(|(down, up)| (*down..*up).contains(&t_ms));
        let released = self.center_pressed_ms.iter().filter(|(_, up)| *up <= t_ms).count();
        Button { pressed, released: released as u8 }
    }

    fn exit_pressed_ms(&self) -> Option<u32> {
        self.exit_pressed_ms
    }

    fn battery_mv(&mut self, _: u32) -> u16 {
        self.battery_mv
    }
}
