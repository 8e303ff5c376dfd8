//! Why a controller cannot become an onboard program.

use mindgap_core::controller::InvalidController;

use crate::onboard::{FREE_FLASH_BYTES, SHORTEST_STEP_MS};

/// Why a controller cannot become an onboard program: one line that says what to change.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// A number of the controller is out of its range.
    #[error("{}", describe(.0))]
    Controller(InvalidController),
    /// Two steps are closer together than a reading of the sensor takes.
    #[error("step_ms is {0}, but a step with a reading takes up to {shortest} ms", shortest = SHORTEST_STEP_MS)]
    StepTooShort(u16),
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
        /// What would be plugged in.
        kind: &'static str,
        /// The ports that there are.
        has: &'static str,
    },
    /// Both motors on one port.
    #[error("left and right motor cannot both be on port {0}")]
    OnePortForTwoMotors(char),
    /// A log that the brick's flash cannot hold.
    #[error(
        "the log of {bytes} bytes does not fit the {flash} bytes of flash: lower max_steps to {max_steps}, or log nothing",
        flash = FREE_FLASH_BYTES
    )]
    LogTooLarge {
        /// The size of the log.
        bytes: u32,
        /// The largest step limit whose log fits.
        max_steps: u16,
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
