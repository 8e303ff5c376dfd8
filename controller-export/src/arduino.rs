//! A controller as an Arduino sketch.
//!
//! Its driver is the only part that depends on the motors and the sensor. The stepping machine is that of [`c`](crate::c).

use mindgap_core::controller::Controller;

use crate::c::machine;
use crate::error::ExportError;
use crate::onboard::{BUTTON_POLL_MS, FAILED_STEPS_TO_STOP, SONAR_PROBES, SONAR_WARM_UP_MS};
use crate::origin::Origin;

const DRIVER: &str = include_str!("arduino/driver.ino");
const RUN: &str = include_str!("arduino/run.ino");

/// Shortest step time: an HC-SR04 needs 60 ms from one measurement to the next.
pub const MIN_STEP_MS: u16 = 60;

/// Returns the controller as the source of a sketch.
///
/// # Errors
/// Returns [`ExportError::Controller`] when a number of the controller is out of range, and [`ExportError::OutOfRange`] when
/// its step is shorter than [`MIN_STEP_MS`].
///
/// ```
/// use mindgap_controller_export::{Origin, arduino};
/// use mindgap_core::controller::{Controller, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// let sketch = arduino::sketch(&controller, &Origin::default())?;
/// assert!(sketch.contains("void setup()"));
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
pub fn sketch(controller: &Controller, origin: &Origin) -> Result<String, ExportError> {
    controller.check()?;
    let Controller { step_ms, max_steps, .. } = controller;
    if *step_ms < MIN_STEP_MS {
        let range = "60..65535: an HC-SR04 needs 60 ms from one measurement to the next";
        return Err(ExportError::OutOfRange { name: "step_ms", value: (*step_ms).into(), range });
    }
    let origin: String = origin.lines().iter().map(|line| format!("// {line}\n")).collect();
    let head = format!(
        "// A six-tuple controller for an Arduino. Every {step_ms} ms the ultrasonic sensor is read once; a reading on the stated\n\
         // side of a tuple's threshold starts the next tuple. The robot stops after the sixth, after {max_steps} steps, or when the\n\
         // sensor is dead; nothing moves unless the sensor answers. A button stops it at once. The ending is printed at 115200 baud.\n\
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
