//! Common parts of all NXC programs: named constants, then constant parts.

use crate::onboard::{self, Ending, Safety};
use crate::wiring::Wiring;

/// Waiting, and looking at the orange button meanwhile.
pub(crate) const TIME: &str = include_str!("time.nxc");
/// Reading the ultrasonic sensor.
pub(crate) const SONAR: &str = include_str!("sonar.nxc");
/// Setting and stopping the motors.
pub(crate) const MOTORS: &str = include_str!("motors.nxc");
/// Noticing wheels that do not turn.
pub(crate) const STALL: &str = include_str!("stall.nxc");
/// Writing a log on the brick.
pub(crate) const LOG: &str = include_str!("log.nxc");
/// Showing numbers.
pub(crate) const DISPLAY: &str = include_str!("display.nxc");
/// Saying how a run ended.
pub(crate) const ENDING: &str = include_str!("ending.nxc");

const LOG_HEADER_BYTES: u32 = 80;
/// Longest row of a log, line end included: a time of ten digits, two commands, two wheel rotations of seven digits,
/// millivolts, and a reading.
const LOG_ROW_BYTES: u32 = 10 + 4 + 4 + 7 + 7 + 5 + 3 + 6 + 2;

/// The parts of a program that are there on demand; lines for one of them start with its name, as `@log `.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Parts {
    pub(crate) log: bool,
    pub(crate) display: bool,
    pub(crate) safety: Safety,
}

impl Parts {
    /// The lines of a source that these parts need.
    pub(crate) fn choose(self, source: &str) -> String {
        let parts = [
            ("@log ", self.log),
            ("@display ", self.display),
            ("@near ", self.safety.stop_cm.is_some()),
            ("@stall ", self.safety.stall),
        ];
        let chosen = |line| {
            let part = parts.iter().find_map(|(mark, wanted)| Some((str::strip_prefix(line, mark)?, *wanted)));
            let (line, wanted) = part.unwrap_or((line, true));
            wanted.then_some([line, "\n"])
        };
        source.lines().filter_map(chosen).flatten().collect()
    }
}

/// Named constants, a line each.
#[derive(Debug, Default)]
pub(crate) struct Constants(String);

impl Constants {
    /// The constants of the common parts: ports, timing of the sensor, endings.
    pub(crate) fn shared(wiring: &Wiring, parts: Parts, step_ms: u16) -> Self {
        let Wiring { left, right, sonar } = wiring;
        let mut constants = Constants::default()
            .with("LEFT", format!("OUT_{left}"), "")
            .with("RIGHT", format!("OUT_{right}"), "")
            .with("SONAR", format!("IN_{sonar}"), "")
            .with("SONAR_NEAREST_ECHO", "0x42", "a register of the sensor: cm")
            .with("SONAR_KIND", "0x10", "another one: what it is")
            .with("NO_ECHO", onboard::NO_ECHO_CM, "the sensor's own code")
            .with("SONAR_FAILED", -1, "")
            .with("SONAR_WARM_UP_MS", onboard::SONAR_WARM_UP_MS, "")
            .with("SONAR_PROBES", onboard::SONAR_PROBES, "before anything moves")
            .with("SONAR_TIMEOUT_MS", onboard::SONAR_TIMEOUT_MS, "")
            .with("SONAR_HANG_MS", onboard::SONAR_HANG_MS, "until its port is free again")
            .with("SONAR_POLL_MS", onboard::SONAR_POLL_MS, "")
            .with("FAILED_STEPS_TO_STOP", onboard::FAILED_STEPS_TO_STOP, "in a row")
            .with("BUTTON_POLL_MS", onboard::BUTTON_POLL_MS, "");
        if let Some(stop_cm) = parts.safety.stop_cm {
            constants = constants.with("STOP_CM", stop_cm, "a nearer thing stops the robot");
        }
        if parts.safety.stall {
            constants = constants
                .with("STALL_POWER", onboard::STALL_POWER, "with less a wheel may stand")
                .with("STALL_DEG", onboard::stall_deg(step_ms), "a step")
                .with("STALLED_STEPS", onboard::stalled_steps(step_ms), "in a row");
        }
        constants = constants.with("TONE_MS", onboard::TONE_MS, "of an ending").with(
            "ENDING_MS",
            onboard::ENDING_MS,
            "in which its text is shown and the motors brake",
        );
        for ending in Ending::ALL {
            let (name, is_used) = match ending {
                Ending::Finished => ("FINISHED", true),
                Ending::TimedOut => ("TIMED_OUT", true),
                Ending::SonarDead => ("SONAR_DEAD", true),
                Ending::NoSonar => ("NO_SONAR", true),
                Ending::Stopped => ("STOPPED", true),
                Ending::Near => ("NEAR", parts.safety.stop_cm.is_some()),
                Ending::Stalled => ("STALLED", parts.safety.stall),
                Ending::NoRoom => ("NO_ROOM", parts.log),
            };
            if is_used {
                constants = constants.with(name, format!("\"{}\", {}", ending.text(), ending.hz()), "");
            }
        }
        constants
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

/// Lines of a program's head that say how it is wired and how to stop it.
pub(crate) fn wired_and_stopped(wiring: &Wiring, safety: Safety) -> String {
    let Wiring { left, right, sonar } = wiring;
    let near = safety.stop_cm.map(|stop_cm| format!(" It stops where a reading is below {stop_cm} cm."));
    let stall = safety.stall.then(|| " It stops when a driven wheel does not turn.".to_owned());
    format!(
        "// Left motor on {left}, right motor on {right}, ultrasonic sensor on {sonar}; nothing moves unless the sensor answers. The orange\n\
         // button stops the robot at once, the dark one too.{}{}\n",
        near.unwrap_or_default(),
        stall.unwrap_or_default()
    )
}

/// Size of a log of `rows` rows in flash.
pub(crate) fn log_bytes(rows: u32) -> u32 {
    LOG_HEADER_BYTES + rows * LOG_ROW_BYTES
}

/// Number of rows of a log that fit into `bytes`.
pub(crate) fn log_rows(bytes: u32) -> u32 {
    bytes.saturating_sub(LOG_HEADER_BYTES) / LOG_ROW_BYTES
}
