//! Behaviour of every onboard program beyond the controller: how it reads the ultrasonic sensor, when it considers the
//! sensor dead, how it can be stopped, and how it reports the end of a run.

pub use mindgap_core::limits::FREE_FLASH_BYTES;

/// The sensor's code for "no echo", which does not count as a reading: the tuple is held.
pub const NO_ECHO_CM: u8 = 255;

/// Timeout of one exchange with the sensor. The firmware's own driver gives up after three polls, 15 ms apart.
pub const SONAR_TIMEOUT_MS: u16 = 45;

/// Time for which a sensor that starts an answer and never finishes it keeps its port busy: the firmware's timeout of
/// 100 ms plus the time in which its driver resets. In the virtual machine of firmware 1.29 the next request is refused
/// after 104 ms and accepted after 106 ms.
pub const SONAR_HANG_MS: u32 = 106;

/// Time between two polls for the sensor's answer.
pub const SONAR_POLL_MS: u16 = 3;

/// Number of consecutive steps without an answer after which the sensor counts as dead and the robot stops. A single
/// missing answer may be interference on the wire; it holds the tuple, as a missing echo does.
pub const FAILED_STEPS_TO_STOP: u8 = 2;

/// Time between switching the sensor on and the first request.
pub const SONAR_WARM_UP_MS: u16 = 250;

/// Number of requests before the start, of which the sensor has to answer one. They ask for its type and take no reading.
pub const SONAR_PROBES: u8 = 3;

/// Time between two checks of the orange button while the program waits.
pub const BUTTON_POLL_MS: u16 = 20;

/// Duration of the tone of an ending.
pub const TONE_MS: u16 = 250;

/// Time for which the text of an ending is shown and the motors brake before the program ends. Then the firmware clears the
/// display and releases the motors.
pub const ENDING_MS: u16 = 2_000;

/// Volume of the tones, 0..=4.
pub const TONE_VOLUME: u8 = 4;

/// Additional reasons for a program to stop the motors. A controller on its own stops for neither.
///
/// ```
/// use mindgap_controller_export::onboard::Safety;
///
/// let safety = Safety { stop_cm: Some(15), stall: true };
/// assert_ne!(safety, Safety::default());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Safety {
    /// Distance in cm; a reading below it stops the robot.
    pub stop_cm: Option<u8>,
    /// Whether a driven wheel that does not turn stops the robot.
    pub stall: bool,
}

/// Power from which a driven wheel has to turn. Below it friction may hold the wheel.
pub const STALL_POWER: u8 = 30;

/// Rotation speed below which a wheel counts as not turning. At [`STALL_POWER`] a free wheel turns ten times as fast.
const STALL_DEG_S: u32 = 20;

/// Time without rotation after which a wheel has stalled. It allows for acceleration and for reversing.
const STALL_MS: u16 = 800;

/// How a run ends.
///
/// ```
/// use mindgap_controller_export::onboard::Ending;
///
/// assert_eq!((Ending::Stopped.text(), Ending::Stopped.hz()), ("stopped", 523));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// A reading ended the sixth tuple, or the last step of a program that collects data is done.
    Finished,
    /// The step limit was reached.
    TimedOut,
    /// The sensor stopped answering.
    SonarDead,
    /// No sensor answers on the port; nothing has moved.
    NoSonar,
    /// The orange button was pressed.
    Stopped,
    /// A reading was below [`Safety::stop_cm`].
    Near,
    /// A driven wheel does not turn.
    Stalled,
    /// The flash has no room for the log; nothing has moved.
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

    /// Returns the text on the display, at most 16 characters.
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

    /// Returns the frequency of the tone in Hz, which differs between endings.
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

/// Returns the rotation per step, in degrees, below which a wheel counts as not turning.
pub fn stall_deg(step_ms: u16) -> u16 {
    (u32::from(step_ms) * STALL_DEG_S).div_ceil(1_000) as u16
}

/// Returns the number of consecutive steps without rotation after which a wheel has stalled.
pub fn stalled_steps(step_ms: u16) -> u16 {
    STALL_MS.div_ceil(step_ms.max(1)).max(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ending_has_its_own_tone_and_a_text_that_fits_the_display() {
        for (at, ending) in Ending::ALL.iter().enumerate() {
            assert!(ending.text().len() <= 16, "{ending:?}");
            assert!(Ending::ALL[..at].iter().all(|other| other.hz() != ending.hz() && other.text() != ending.text()));
        }
    }

    #[test]
    fn stall_is_detected_after_the_same_time_at_any_step_length() {
        assert_eq!((stalled_steps(100), stalled_steps(400), stalled_steps(1_000)), (8, 2, 2));
        assert_eq!((stall_deg(10), stall_deg(400), stall_deg(u16::MAX)), (1, 8, 1_311));
    }
}
