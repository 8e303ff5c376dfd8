//! Behaviour of every onboard program beyond the controller: how it reads the ultrasonic sensor and when it considers it
//! dead, how it is stopped, and how it says that it has ended.

pub use mindgap_core::limits::FREE_FLASH_BYTES;

/// The sensor's code for "no echo". It does not count as a reading: the tuple is held.
pub const NO_ECHO_CM: u8 = 255;

/// Timeout of one exchange with the sensor. The firmware's own driver gives up after three polls 15 ms apart.
pub const SONAR_TIMEOUT_MS: u16 = 45;

/// How long a sensor that begins an answer and never ends it keeps its port busy: the firmware's timeout of 100 ms and
/// the passes in which its driver resets. In the virtual machine of firmware 1.29 a request is refused 104 ms after such
/// a one, and accepted after 106.
pub const SONAR_HANG_MS: u32 = 106;

/// Time between two polls for the sensor's answer.
pub const SONAR_POLL_MS: u16 = 3;

/// Steps in a row without an answer after which the sensor counts as dead and the robot is stopped. One missed answer
/// may be a disturbed wire, and holds the tuple as a missing echo does.
pub const FAILED_STEPS_TO_STOP: u8 = 2;

/// Time between switching the sensor on and the first question to it.
pub const SONAR_WARM_UP_MS: u16 = 250;

/// Questions before the start, of which the sensor has to answer one. They ask for its kind, which is no measurement.
pub const SONAR_PROBES: u8 = 3;

/// Time between two looks at the orange button while the program waits.
pub const BUTTON_POLL_MS: u16 = 20;

/// How long the tone of an ending lasts.
pub const TONE_MS: u16 = 250;

/// How long the text of an ending is shown, and the motors brake, before the program ends: then the firmware lets go of
/// both.
pub const ENDING_MS: u16 = 2_000;

/// Volume of the tones, of 4.
pub const TONE_VOLUME: u8 = 4;

/// What makes a program stop the motors beside its controller; a controller as its definition says stops for neither.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Safety {
    /// A reading below this stops the robot.
    pub stop_cm: Option<u8>,
    /// Wheels that are driven and do not turn stop it.
    pub stall: bool,
}

/// Power from which a driven wheel has to turn: friction may hold it at less.
pub const STALL_POWER: u8 = 30;

/// Rotation of a wheel in a second below which it does not turn; at [`STALL_POWER`] a free one turns ten times as fast.
const STALL_DEG_S: u32 = 20;

/// Time without rotation after which a wheel has stalled: it includes setting off and turning back.
const STALL_MS: u16 = 800;

/// How a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The sixth tuple's test held, or the last step of a drive that collects data is done.
    Finished,
    /// The step limit was reached.
    TimedOut,
    /// The sensor stopped answering.
    SonarDead,
    /// Nothing answers on the sensor's port: nothing has moved.
    NoSonar,
    /// The orange button was pressed.
    Stopped,
    /// A reading was below [`Safety::stop_cm`].
    Near,
    /// A driven wheel does not turn.
    Stalled,
    /// The flash has no room for the log: nothing has moved.
    NoRoom,
}

impl Ending {
    /// All endings.
    pub const ALL: [Ending; 8] = [
        Ending::Finished,
        Ending::TimedOut,
        Ending::SonarDead,
        Ending::NoSonar,
        Ending::Stopped,
        Ending::Near,
        Ending::Stalled,
        Ending::NoRoom,
    ];

    /// The text on the display, at most 16 characters.
    pub fn text(self) -> &'static str {
        match self {
            Ending::Finished => "finished",
            Ending::TimedOut => "timed out",
            Ending::SonarDead => "sonar dead",
            Ending::NoSonar => "no sonar",
            Ending::Stopped => "stopped",
            Ending::Near => "obstacle near",
            Ending::Stalled => "wheels stalled",
            Ending::NoRoom => "no room: log",
        }
    }

    /// Frequency of the tone, another one for each.
    pub fn hz(self) -> u16 {
        match self {
            Ending::Finished => 880,
            Ending::TimedOut => 220,
            Ending::SonarDead => 330,
            Ending::NoSonar => 392,
            Ending::Stopped => 523,
            Ending::Near => 659,
            Ending::Stalled => 440,
            Ending::NoRoom => 294,
        }
    }
}

/// Rotation within a step below which a wheel does not turn, degrees.
pub fn stall_deg(step_ms: u16) -> u16 {
    (u32::from(step_ms) * STALL_DEG_S).div_ceil(1_000) as u16
}

/// Steps in a row without rotation after which a wheel has stalled.
pub fn stalled_steps(step_ms: u16) -> u16 {
    STALL_MS.div_ceil(step_ms.max(1)).max(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ending_has_a_text_that_fits_the_display_and_a_tone_of_its_own() {
        for (at, ending) in Ending::ALL.iter().enumerate() {
            assert!(ending.text().len() <= 16, "{ending:?}");
            assert!(Ending::ALL[..at].iter().all(|other| other.hz() != ending.hz() && other.text() != ending.text()));
        }
    }

    #[test]
    fn a_wheel_has_stalled_after_the_same_time_at_any_step() {
        assert_eq!((stalled_steps(100), stalled_steps(400), stalled_steps(1_000)), (8, 2, 2));
        assert_eq!((stall_deg(10), stall_deg(400), stall_deg(u16::MAX)), (1, 8, 1_311));
    }
}
