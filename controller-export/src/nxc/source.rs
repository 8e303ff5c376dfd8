//! Common parts of all NXC programs: named constants, then constant parts.

use crate::onboard;
use crate::wiring::Wiring;

/// Waiting for a time.
pub(crate) const TIME: &str = include_str!("time.nxc");
/// Reading the ultrasonic sensor.
pub(crate) const SONAR: &str = include_str!("sonar.nxc");
/// Setting and stopping the motors.
pub(crate) const MOTORS: &str = include_str!("motors.nxc");
/// Writing a log on the brick.
pub(crate) const LOG: &str = include_str!("log.nxc");
/// Showing numbers.
pub(crate) const DISPLAY: &str = include_str!("display.nxc");

const LOG_HEADER_BYTES: u32 = 80;
/// Longest row of a log, line end included: a time of ten digits, two commands, two wheel rotations of seven digits,
/// millivolts, and a reading.
const LOG_ROW_BYTES: u32 = 10 + 4 + 4 + 7 + 7 + 5 + 3 + 6 + 2;

/// Named constants, a line each.
#[derive(Debug, Default)]
pub(crate) struct Constants(String);

impl Constants {
    /// The constants of the common parts: ports, and timing of the sensor.
    pub(crate) fn shared(wiring: &Wiring) -> Self {
        let Wiring { left, right, sonar } = wiring;
        Constants::default()
            .with("LEFT", format!("OUT_{left}"), "")
            .with("RIGHT", format!("OUT_{right}"), "")
            .with("SONAR", format!("IN_{sonar}"), "")
            .with("NO_ECHO", onboard::NO_ECHO_CM, "the sensor's own code")
            .with("SONAR_FAILED", -1, "")
            .with("SONAR_WARM_UP_MS", onboard::SONAR_WARM_UP_MS, "")
            .with("SONAR_TIMEOUT_MS", onboard::SONAR_TIMEOUT_MS, "")
            .with("SONAR_POLL_MS", onboard::SONAR_POLL_MS, "")
            .with("FAILED_STEPS_TO_STOP", onboard::FAILED_STEPS_TO_STOP, "in a row")
            .with("BRAKE_MS", onboard::BRAKE_MS, "before the program's end lets go of the motors")
            .with("FINISHED_HZ", onboard::FINISHED_HZ, "")
            .with("GAVE_UP_HZ", onboard::GAVE_UP_HZ, "")
    }

    /// Adds a constant.
    pub(crate) fn with(mut self, name: &str, value: impl ToString, comment: &str) -> Self {
        let line = format!("#define {name:<20} {}", value.to_string());
        self.0 += &if comment.is_empty() { line + "\n" } else { format!("{line:<34} // {comment}\n") };
        self
    }

    /// As source.
    pub(crate) fn into_text(self) -> String {
        self.0
    }
}

/// Size of a log of `rows` rows in flash.
pub(crate) fn log_bytes(rows: u32) -> u32 {
    LOG_HEADER_BYTES + rows * LOG_ROW_BYTES
}

/// Number of rows of a log that fit into `bytes`.
pub(crate) fn log_rows(bytes: u32) -> u32 {
    bytes.saturating_sub(LOG_HEADER_BYTES) / LOG_ROW_BYTES
}
