//! The controller as an Arduino sketch.
//!
//! Its driver is the only part that knows motors and sensor; the machine that steps is that of [`c`](crate::c).

use mindgap_core::controller::Controller;

use crate::c::machine;
use crate::error::ExportError;
use crate::onboard::{BUTTON_POLL_MS, FAILED_STEPS_TO_STOP, SONAR_PROBES, SONAR_WARM_UP_MS};
use crate::origin::Origin;

const DRIVER: &str = include_str!("arduino/driver.ino");
const RUN: &str = include_str!("arduino/run.ino");

/// The shortest step: an HC-SR04 needs that from one question to the next.
pub const LEAST_STEP_MS: u16 = 60;

/// The controller as a sketch.
///
/// # Errors
/// [`ExportError::Controller`], and [`ExportError::OutOfRange`] of a step shorter than [`LEAST_STEP_MS`].
pub fn sketch(controller: &Controller, origin: &Origin) -> Result<String, ExportError> {
    controller.check()?;
    let Controller { step_ms, max_steps, .. } = controller;
    if *step_ms < LEAST_STEP_MS {
        let range = "60..=65535, since an HC-SR04 needs 60 ms from one question to the next";
        return Err(ExportError::OutOfRange { name: "step_ms", value: (*step_ms).into(), range });
    }
    let origin: String = origin.lines().iter().map(|line| format!("// {line}\n")).collect();
    let head = format!(
        "// A six-tuple controller for an Arduino. Every {step_ms} ms the ultrasonic sensor is read once; a reading on the stated\n\
         // side of a tuple's threshold starts the next tuple. The robot stops after the sixth, after {max_steps} steps, or when the\n\
         // sensor is dead; nothing moves unless the sensor answers. A button stops it at once. How it ended is told at 115200 baud.\n\
         {origin}\n\
         {}\n\
         const uint8_t FAILED_STEPS_TO_STOP = {FAILED_STEPS_TO_STOP}; // in a row\n\
         const uint8_t SONAR_PROBES = {SONAR_PROBES};\n\
         const uint16_t SONAR_WARM_UP_MS = {SONAR_WARM_UP_MS};\n\
         const uint8_t BUTTON_POLL_MS = {BUTTON_POLL_MS};\n",
        machine(controller)
    );
    Ok([&head, DRIVER, RUN].join("\n"))
}
