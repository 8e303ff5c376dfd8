//! What every onboard program does beyond the controller: how long it waits for the ultrasonic sensor, when it takes
//! the sensor for dead, and how it ends.

use mindgap_core::controller::Controller;

use crate::error::ExportError;

/// The sensor's word for "no echo came back". It is no reading: the tuple is held.
pub const NO_ECHO_CM: u8 = 255;

/// How long one exchange with the sensor may take. The firmware's own driver gives up after three polls 15 ms apart.
pub const SONAR_TIMEOUT_MS: u16 = 45;

/// Steps in a row without an answer after which the sensor counts as dead and the robot is stopped. One missed answer
/// may be a disturbed wire, and holds the tuple as a missing echo does.
pub const FAILED_STEPS_TO_STOP: u8 = 2;

/// Time between switching the sensor on and the start of the run.
pub const SONAR_WARM_UP_MS: u16 = 250;

/// How long the motors brake before the program ends, which lets go of them.
pub const BRAKE_MS: u16 = 250;

/// The shortest step that leaves room for an exchange that times out, a row of the log and the sensor's own pause
/// between two measurements.
pub const SHORTEST_STEP_MS: u16 = 100;

/// User flash of a brick with standard firmware 1.29 and an empty file system.
pub const FREE_FLASH_BYTES: u32 = 121_124;

/// Checks that a brick can run the controller.
///
/// # Errors
/// [`ExportError::Controller`] or [`ExportError::StepTooShort`].
pub fn check(controller: &Controller) -> Result<(), ExportError> {
    controller.check()?;
    if controller.step_ms < SHORTEST_STEP_MS {
        return Err(ExportError::StepTooShort(controller.step_ms));
    }
    Ok(())
}
