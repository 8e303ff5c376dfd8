//! A controller as a Rust constant, for programs that use [`mindgap_core`].

use mindgap_core::controller::{Controller, Tuple, When};

use crate::error::ExportError;
use crate::origin::Origin;

/// Returns the source of a Rust module with one constant, `CONTROLLER`.
///
/// # Errors
/// Returns [`ExportError::Controller`] when a number of the controller is out of range.
///
/// ```
/// use mindgap_controller_export::{Origin, rust};
/// use mindgap_core::controller::{Controller, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// let source = rust::module(&controller, &Origin::default())?;
/// assert!(source.contains("pub const CONTROLLER: Controller"));
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
pub fn module(controller: &Controller, origin: &Origin) -> Result<String, ExportError> {
    controller.check()?;
    let origin: String = origin.lines().iter().map(|line| format!("//!\n//! {line}\n")).collect();
    let tuples: String = controller.tuples.iter().map(tuple).collect();
    let Controller { step_ms, max_steps, .. } = controller;
    Ok(format!(
        "//! A six-tuple controller.\n\
         {origin}\n\
         use mindgap_core::controller::{{Controller, Tuple, When}};\n\
         \n\
         /// Run it with [`Machine`](mindgap_core::controller::Machine).\n\
         #[rustfmt::skip]\n\
         pub const CONTROLLER: Controller = Controller {{\n    \
             step_ms: {step_ms},\n    \
             max_steps: {max_steps},\n    \
             tuples: [\n{tuples}    ],\n\
         }};\n"
    ))
}

fn tuple(tuple: &Tuple) -> String {
    let Tuple { left, right, when, threshold_cm } = tuple;
    let when = match when {
        When::Larger => "When::Larger",
        When::Smaller => "When::Smaller",
    };
    format!("        Tuple {{ left: {left}, right: {right}, when: {when}, threshold_cm: {threshold_cm} }},\n")
}
