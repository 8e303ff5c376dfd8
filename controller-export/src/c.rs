//! A controller as a C99 header: its tuples as a table, and the machine that steps through them.
//!
//! It does not allocate and needs only `stdbool.h` and `stdint.h`. The program that includes it reads the sensor, sets the
//! motors and keeps the time.

use mindgap_core::controller::{Controller, FULL_SPEED, TUPLES, When};

use crate::error::ExportError;
use crate::origin::Origin;

/// The machine. The table replaces `@tuples@`.
const MACHINE: &str = include_str!("c/machine.h");

/// Returns the controller as a C99 header.
///
/// # Errors
/// Returns [`ExportError::Controller`] when a number of the controller is out of range.
///
/// ```
/// use mindgap_controller_export::{Origin, c};
/// use mindgap_core::controller::{Controller, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// let header = c::header(&controller, &Origin::default())?;
/// assert!(header.contains("#define CONTROLLER_STEP_MS 400"));
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
pub fn header(controller: &Controller, origin: &Origin) -> Result<String, ExportError> {
    controller.check()?;
    let origin: String = origin.lines().iter().map(|line| format!("\n * {}", line.replace("*/", "* /"))).collect();
    Ok(format!(
        "/* A six-tuple controller. Set the motors to controller_motors_now(), and every CONTROLLER_STEP_MS read the sensor\n \
         * once, call controller_step() and set the motors again.\n *{origin}\n */\n\
         #ifndef MINDGAP_CONTROLLER_H\n\
         #define MINDGAP_CONTROLLER_H\n\
         \n\
         {}\n\
         #endif\n",
        machine(controller)
    ))
}

/// Returns the controller's table and its machine, in the common subset of C and C++.
pub(crate) fn machine(controller: &Controller) -> String {
    let Controller { step_ms, max_steps, .. } = controller;
    let numbers = format!(
        "#include <stdbool.h>\n\
         #include <stdint.h>\n\
         \n\
         #define CONTROLLER_TUPLES {TUPLES}\n\
         #define CONTROLLER_STEP_MS {step_ms}\n\
         #define CONTROLLER_MAX_STEPS {max_steps}\n"
    );
    numbers + &MACHINE.replace("@tuples@\n", &tuples(controller))
}

fn tuples(controller: &Controller) -> String {
    let mut text = "static const controller_tuple controller_tuples[CONTROLLER_TUPLES] = {\n".to_owned();
    for tuple in &controller.tuples {
        let [left, right] = [tuple.left, tuple.right].map(|speed| speed.clamp(-FULL_SPEED, FULL_SPEED));
        let larger = tuple.when == When::Larger;
        text += &format!("  {{{{{left:>4}, {right:>4}}}, {larger:>5}, {:>3}}},\n", tuple.threshold_cm);
    }
    text + "};\n"
}
