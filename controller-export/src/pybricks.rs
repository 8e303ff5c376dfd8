//! A controller as a MicroPython program for hubs with Pybricks firmware: NXT, EV3, SPIKE and Technic.
//!
//! Its class `Robot` is the driver, the only part that depends on the hub's motors and sensor.

use mindgap_core::controller::{Controller, FULL_SPEED, Tuple, When};

use crate::error::ExportError;
use crate::onboard::FAILED_STEPS_TO_STOP;
use crate::origin::Origin;

/// The driver, which all programs for these hubs share.
pub(crate) const DRIVER: &str = include_str!("pybricks/driver.py");
/// The start of all these programs, after their function `run`.
pub(crate) const MAIN: &str = include_str!("pybricks/main.py");
const RUN: &str = include_str!("pybricks/run.py");

/// Returns the controller as a MicroPython program.
///
/// # Errors
/// Returns [`ExportError::Controller`] when a number of the controller is out of range.
///
/// ```
/// use mindgap_controller_export::{Origin, pybricks};
/// use mindgap_core::controller::{Controller, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// let source = pybricks::program(&controller, &Origin::default())?;
/// assert!(source.contains("(55, 48, SMALLER, 42),  # 1"));
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
pub fn program(controller: &Controller, origin: &Origin) -> Result<String, ExportError> {
    controller.check()?;
    let Controller { step_ms, max_steps, tuples } = controller;
    let origin: String = origin.lines().iter().map(|line| format!("# {line}\n")).collect();
    let rows: String = (1..).zip(tuples).map(row).collect();
    let head = format!(
        "# A six-tuple controller for a hub with Pybricks firmware. Every {step_ms} ms the ultrasonic sensor is read once; a reading\n\
         # on the stated side of a tuple's threshold starts the next tuple. The robot stops after the sixth, after {max_steps} steps,\n\
         # or when the sensor is dead; nothing moves unless the sensor answers. The hub's button stops it at once.\n\
         {origin}\n\
         STEP_MS = {step_ms}\n\
         MAX_STEPS = {max_steps}\n\
         FAILED_STEPS_TO_STOP = {FAILED_STEPS_TO_STOP}  # in a row\n\
         SMALLER = 0\n\
         LARGER = 1\n\
         # Left power, right power, side of the threshold on which the tuple ends, threshold in cm.\n\
         TUPLES = (\n{rows})\n"
    );
    Ok([&head, DRIVER, RUN, "", MAIN].join("\n"))
}

fn row((number, tuple): (usize, &Tuple)) -> String {
    let [left, right] = [tuple.left, tuple.right].map(|speed| speed.clamp(-FULL_SPEED, FULL_SPEED));
    let when = match tuple.when {
        When::Larger => "LARGER",
        When::Smaller => "SMALLER",
    };
    format!("    ({left}, {right}, {when}, {}),  # {number}\n", tuple.threshold_cm)
}
