//! The reasons why a controller cannot be exported as an onboard program.

use mindgap_core::controller::InvalidController;

use crate::onboard::SONAR_HANG_MS;

/// The reason why a controller cannot be exported. Its message is one line that says what to change.
///
/// ```
/// use mindgap_controller_export::ExportError;
/// use mindgap_controller_export::wiring::SensorPort;
///
/// let error: ExportError = "5".parse::<SensorPort>().unwrap_err();
/// assert_eq!(error.to_string(), "\"5\" is not a sensor port; the brick has 1, 2, 3 and 4");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A number of the controller is out of range.
    #[error(transparent)]
    Controller(#[from] InvalidController),
    /// Two steps are closer together than a step can take.
    #[error(
        "step_ms is {step_ms}, but a step can take {shortest_ms} ms: a sensor that hangs keeps its port busy for \
         {SONAR_HANG_MS} ms, and there is a margin: raise step_ms"
    )]
    StepTooShort {
        /// Time between two steps.
        step_ms: u16,
        /// The shortest possible time.
        shortest_ms: u16,
    },
    /// The brick refuses this file name.
    #[error("\"{name}\" cannot be a file name on the brick: {why}")]
    Name {
        /// The name as given.
        name: String,
        /// The rule that it breaks.
        why: &'static str,
    },
    /// The brick does not have this port.
    #[error("\"{port}\" is not a {kind} port; the brick has {has}")]
    NoSuchPort {
        /// The port as given.
        port: String,
        /// Kind of device: motor or sensor.
        kind: &'static str,
        /// The existing ports.
        has: &'static str,
    },
    /// Both motors are on one port.
    #[error("left and right motor cannot both be on port {0}")]
    OnePortForTwoMotors(char),
    /// The brick's flash cannot hold the log.
    #[error("the log takes {log_bytes} of {flash_bytes} bytes of flash: log at most {steps} steps, or nothing")]
    LogTooLarge {
        /// Size of the log.
        log_bytes: u32,
        /// Flash available besides the program.
        flash_bytes: u32,
        /// Largest number of steps whose log fits.
        steps: u16,
    },
    /// A parameter of a program is out of range.
    #[error("{name} is {value}; it has to be in {range}")]
    OutOfRange {
        /// Name of the parameter.
        name: &'static str,
        /// Value of the parameter.
        value: u32,
        /// Its valid range.
        range: &'static str,
    },
}
