//! The surroundings of a brick: its sensors, motors, buttons and battery.

use super::motors::{Drive, PORTS as MOTORS};
use super::shaft::Shaft;

/// The sensors, motors, buttons and battery of a brick. Times are in ms since the program started; ports count from 0.
///
/// ```
/// use mindgap_controller_export::brick::{Sonar, World};
///
/// /// A robot that approaches a wall by 1 cm per 100 ms.
/// struct Approach;
///
/// impl World for Approach {
///     fn sonar(&mut self, _port: usize, t_ms: u32) -> Sonar {
///         Sonar::Echo(200u8.saturating_sub((t_ms / 100) as u8))
///     }
///
///     fn sonar_answers(&mut self, port: usize, t_ms: u32) -> Sonar {
///         self.sonar(port, t_ms)
///     }
/// }
/// assert_eq!(Approach.sonar(3, 1_000), Sonar::Echo(190));
/// ```
pub trait World {
    /// Returns the ultrasonic sensor's response to a request for its nearest echo.
    fn sonar(&mut self, port: usize, t_ms: u32) -> Sonar;

    /// Returns the ultrasonic sensor's response to any other request, such as for its type. Only whether it answers counts.
    fn sonar_answers(&mut self, port: usize, t_ms: u32) -> Sonar;

    /// Returns the reading of a touch, light or sound sensor, 0..=100 percent, or `None` if the port is empty.
    fn percent(&mut self, port: usize, t_ms: u32) -> Option<u8> {
        let _ = (port, t_ms);
        None
    }

    /// Sets the drive of a motor from now on.
    fn motor(&mut self, port: usize, drive: Drive, t_ms: u32) {
        let _ = (port, drive, t_ms);
    }

    /// Returns the rotation of a motor's shaft, in degrees.
    fn rotation_deg(&mut self, port: usize, t_ms: u32) -> i32 {
        let _ = (port, t_ms);
        0
    }

    /// Returns the state of the right (1), left (2) or orange (3) button.
    fn button(&mut self, button: u8, t_ms: u32) -> Button {
        let _ = (button, t_ms);
        Button::default()
    }

    /// Returns the time at which the dark button is pressed, which ends any program.
    fn exit_pressed_ms(&self) -> Option<u32> {
        None
    }

    /// Returns the battery voltage, in millivolts.
    fn battery_mv(&mut self, t_ms: u32) -> u16 {
        let _ = t_ms;
        7800
    }
}

/// The response of the ultrasonic sensor to a request.
///
/// ```
/// use mindgap_controller_export::brick::Sonar;
/// use mindgap_controller_export::onboard::NO_ECHO_CM;
///
/// let no_echo = Sonar::Echo(NO_ECHO_CM);
/// assert_ne!(no_echo, Sonar::Silent, "a sensor without an echo still answers");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sonar {
    /// A distance in cm, or 255 if no echo returned.
    Echo(u8),
    /// No answer, as of a sensor that is unplugged or has no power.
    Silent,
    /// An answer that starts and never ends.
    Hangs,
}

/// The state of a button.
///
/// ```
/// use mindgap_controller_export::brick::Button;
///
/// assert_eq!(Button::default(), Button { pressed: false, released: 0 });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Button {
    /// Whether the button is pressed.
    pub pressed: bool,
    /// Number of times that it has been released.
    pub released: u8,
}

/// A press of a button.
///
/// ```
/// use mindgap_controller_export::brick::Press;
///
/// assert_eq!(Press::orange(300, 350), Press { button: 3, down_ms: 300, up_ms: 350 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// The right (1), left (2) or orange (3) button.
    pub button: u8,
    /// Time at which the button is pressed.
    pub down_ms: u32,
    /// Time at which the button is released.
    pub up_ms: u32,
}

impl Press {
    /// Returns a press of the orange button.
    pub fn orange(down_ms: u32, up_ms: u32) -> Press {
        Press { button: 3, down_ms, up_ms }
    }
}

/// The reading of a touch, light or sound sensor from a time on.
///
/// ```
/// use mindgap_controller_export::brick::{Level, ScriptedWorld, World};
///
/// let bump = Level { port: 0, t_ms: 700, percent: 100 };
/// let mut world = ScriptedWorld { levels: vec![bump], ..ScriptedWorld::default() };
/// assert_eq!((world.percent(0, 699), world.percent(0, 700)), (None, Some(100)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// Port of the sensor, from 0.
    pub port: usize,
    /// Time from which the reading holds, in ms.
    pub t_ms: u32,
    /// Reading, 0..=100. A touch sensor is pressed above 0.
    pub percent: u8,
}

/// A world that follows a script. The ultrasonic sensor gives one answer per request and is silent afterwards; the other
/// sensors and the buttons follow the time. The motors turn freely.
///
/// If no further answer is a distance, the sensor is missing or broken, and requests for its type get that answer too.
///
/// ```
/// use mindgap_controller_export::brick::{Press, ScriptedWorld, Sonar, World};
///
/// let press = Press::orange(500, 600);
/// let mut world = ScriptedWorld { presses: vec![press], ..ScriptedWorld::sonar([Sonar::Echo(42)]) };
/// assert_eq!(World::sonar(&mut world, 3, 0), Sonar::Echo(42));
/// assert_eq!(World::sonar(&mut world, 3, 100), Sonar::Silent);
/// assert!(world.button(3, 550).pressed);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScriptedWorld {
    /// Answers of the ultrasonic sensor, one per request.
    pub sonar: Vec<Sonar>,
    /// Port of the ultrasonic sensor, from 0.
    pub sonar_port: usize,
    /// Readings of the other sensors, in order of time.
    pub levels: Vec<Level>,
    /// Presses of the buttons.
    pub presses: Vec<Press>,
    /// Time at which the dark button is pressed, in ms.
    pub exit_pressed_ms: Option<u32>,
    /// Battery voltage, in millivolts.
    pub battery_mv: u16,
    /// Whether the wheels are blocked.
    pub wheels_blocked: bool,
    /// Number of requests for an echo so far.
    pub requests: usize,
    /// Shafts of the motors.
    pub shafts: [Shaft; MOTORS],
}

impl ScriptedWorld {
    /// Returns a world with an ultrasonic sensor on port 4, a charged battery, and no button pressed.
    pub fn sonar(answers: impl Into<Vec<Sonar>>) -> Self {
        ScriptedWorld { sonar: answers.into(), sonar_port: 3, battery_mv: 7800, ..ScriptedWorld::default() }
    }
}

impl World for ScriptedWorld {
    fn sonar(&mut self, port: usize, _: u32) -> Sonar {
        if port != self.sonar_port {
            return Sonar::Silent;
        }
        let answer = self.sonar.get(self.requests).copied().unwrap_or(Sonar::Silent);
        self.requests += 1;
        answer
    }

    fn sonar_answers(&mut self, port: usize, _: u32) -> Sonar {
        let rest = self.sonar.get(self.requests..).unwrap_or_default();
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
        let presses = || self.presses.iter().filter(|press| press.button == button);
        let pressed = presses().any(|press| (press.down_ms..press.up_ms).contains(&t_ms));
        let released = presses().filter(|press| press.up_ms <= t_ms).count();
        Button { pressed, released: released as u8 }
    }

    fn exit_pressed_ms(&self) -> Option<u32> {
        self.exit_pressed_ms
    }

    fn battery_mv(&mut self, _: u32) -> u16 {
        self.battery_mv
    }
}
