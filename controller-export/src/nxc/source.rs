//! The common parts of all NXC programs: named constants, and source files that do not change.

use crate::onboard::{self, Ending, Safety};
use crate::wiring::Wiring;

/// Waits, and checks the orange button meanwhile.
pub(crate) const TIME: &str = include_str!("time.nxc");
/// Reads the ultrasonic sensor.
pub(crate) const SONAR: &str = include_str!("sonar.nxc");
/// Sets and stops the motors.
pub(crate) const MOTORS: &str = include_str!("motors.nxc");
/// Detects wheels that do not turn.
pub(crate) const STALL: &str = include_str!("stall.nxc");
/// Writes a log on the brick.
pub(crate) const LOG: &str = include_str!("log.nxc");
/// Shows numbers on the display.
pub(crate) const DISPLAY: &str = include_str!("display.nxc");
/// Reports how a run ended.
pub(crate) const ENDING: &str = include_str!("ending.nxc");

/// The optional parts of a program. A source line that belongs to one of them starts with its name, as in `@log `.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Parts {
    pub(crate) log: bool,
    pub(crate) display: bool,
    pub(crate) safety: Safety,
}

impl Parts {
    /// Returns the lines of a source that these parts need.
    pub(crate) fn select(self, source: &str) -> String {
        let parts = [
            ("@log ", self.log),
            ("@display ", self.display),
            ("@near ", self.safety.stop_cm.is_some()),
            ("@stall ", self.safety.stall),
        ];
        let selected = |line| {
            let part = parts.iter().find_map(|(mark, wanted)| Some((str::strip_prefix(line, mark)?, *wanted)));
            let (line, wanted) = part.unwrap_or((line, true));
            wanted.then_some([line, "\n"])
        };
        source.lines().filter_map(selected).flatten().collect()
    }
}

/// Named constants, one per line.
#[derive(Debug, Default)]
pub(crate) struct Constants(String);

impl Constants {
    /// Returns the constants of the common parts: ports, timing of the sensor, endings.
    pub(crate) fn shared(wiring: &Wiring, parts: Parts, step_ms: u16) -> Self {
        let Wiring { left, right, sonar } = wiring;
        let mut constants = Constants::default()
            .with("LEFT", format!("OUT_{left}"), "")
            .with("RIGHT", format!("OUT_{right}"), "")
            .with("SONAR", format!("IN_{sonar}"), "")
            .with("SONAR_NEAREST_ECHO", "0x42", "register with the distance in cm")
            .with("SONAR_TYPE", "0x10", "register with the type of sensor")
            .with("NO_ECHO", onboard::NO_ECHO_CM, "the sensor's code")
            .with("SONAR_FAILED", -1, "")
            .with("SONAR_WARM_UP_MS", onboard::SONAR_WARM_UP_MS, "")
            .with("SONAR_PROBES", onboard::SONAR_PROBES, "before anything moves")
            .with("SONAR_TIMEOUT_MS", onboard::SONAR_TIMEOUT_MS, "")
            .with("SONAR_HANG_MS", onboard::SONAR_HANG_MS, "until its port is free again")
            .with("SONAR_POLL_MS", onboard::SONAR_POLL_MS, "")
            .with("FAILED_STEPS_TO_STOP", onboard::FAILED_STEPS_TO_STOP, "in a row")
            .with("BUTTON_POLL_MS", onboard::BUTTON_POLL_MS, "");
        if let Some(stop_cm) = parts.safety.stop_cm {
            constants = constants.with("STOP_CM", stop_cm, "a smaller reading stops the robot");
        }
        if parts.safety.stall {
            constants = constants
                .with("STALL_POWER", onboard::STALL_POWER, "with less power a wheel may stand still")
                .with("STALL_DEG", onboard::stall_deg(step_ms), "per step")
                .with("STALLED_STEPS", onboard::stalled_steps(step_ms), "in a row");
        }
        constants = constants.with("TONE_MS", onboard::TONE_MS, "duration of the tone at the end of a run").with(
            "ENDING_MS",
            onboard::ENDING_MS,
            "duration of the text at the end of a run",
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

    /// Returns the constants as source.
    pub(crate) fn into_text(self) -> String {
        self.0
    }
}

/// Returns the lines of a program's head that state its ports and how it can be stopped.
pub(crate) fn ports_and_stops(wiring: &Wiring, safety: Safety) -> String {
    let Wiring { left, right, sonar } = wiring;
    let near = safety.stop_cm.map(|stop_cm| format!("// It also stops when a reading is below {stop_cm} cm.\n"));
    let stall = safety.stall.then(|| "// It also stops when a driven wheel does not turn.\n".to_owned());
    format!(
        "// Left motor on {left}, right motor on {right}, ultrasonic sensor on {sonar}; nothing moves unless the sensor answers. The orange\n\
         // button stops the robot at once, and so does the dark one.\n{}{}",
        near.unwrap_or_default(),
        stall.unwrap_or_default()
    )
}
