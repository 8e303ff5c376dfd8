//! Why a controller cannot be exported as an onboard program.

use mindgap_core::controller::InvalidController;

use crate::onboard::SONAR_HANG_MS;

/// Why a controller cannot be exported as an onboard program: one line that says what to change.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// A number of the controller is out of its range.
    #[error("{}", describe(.0))]
    Controller(InvalidController),
    /// Two steps are closer together than a step takes.
    #[error(
        "step_ms is {step_ms}, but a step takes up to {shortest_ms} ms: a sensor that hangs keeps its port busy for \
         {SONAR_HANG_MS} ms, and there is a margin: raise it"
    )]
    StepTooShort {
        /// Time between two steps.
        step_ms: u16,
        /// The shortest possible.
        shortest_ms: u16,
    },
    /// A file name that the brick refuses.
    #[error("\"{name}\" cannot be a file name on the brick: {why}")]
    Name {
        /// The name as given.
        name: String,
        /// The rule that it breaks.
        why: &'static str,
    },
    /// A port that the brick does not have.
    #[error("\"{port}\" is no {kind} port; the brick has {has}")]
    NoSuchPort {
        /// The port as given.
        port: String,
        /// Kind of device: motor or sensor.
        kind: &'static str,
        /// The existing ports.
        has: &'static str,
    },
    /// Both motors on one port.
    #[error("left and right motor cannot both be on port {0}")]
    OnePortForTwoMotors(char),
    /// A log that the brick's flash cannot hold.
    #[error("the log takes {log_bytes} of {flash_bytes} bytes of flash: log at most {steps} steps, or nothing")]
    LogTooLarge {
        /// The size of the log.
        log_bytes: u32,
        /// Flash available beside the program.
        flash_bytes: u32,
        /// Largest number of steps whose log fits.
        steps: u16,
    },
    /// A parameter of a program that collects data is out of range.
    #[error("{name} is {value}; it has to lie in {range}")]
    OutOfRange {
        /// The number's name.
        name: &'static str,
        /// The number.
        value: u32,
        /// Its valid range.
        range: &'static str,
    },
}

impl From<InvalidController> for ExportError {
    fn from(problem: InvalidController) -> Self {
        ExportError::Controller(problem)
    }
}

fn describe(problem: &InvalidController) -> String {
    match problem {
        InvalidController::Speed(i) => format!("tuple {}: a motor command is outside -100..100", i + 1),
        InvalidController::Threshold(i) => format!("tuple {}: threshold_cm is outside 0..255", i + 1),
        InvalidController::StepTime => "step_ms is 0".to_owned(),
        InvalidController::StepLimit => "max_steps is 0".to_owned(),
    }
}
