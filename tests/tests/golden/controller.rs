//! A six-tuple controller.
//!
//! simulator: sim.mgap
//!
//! scene: scene.toml
//!
//! start: 1
//!
//! seed: 7
//!
//! generations: 1000
//!
//! fitness: 0.25

use mindgap_core::controller::{Controller, Tuple, When};

/// Run it with [`Machine`](mindgap_core::controller::Machine).
#[rustfmt::skip]
pub const CONTROLLER: Controller = Controller {
    step_ms: 400,
    max_steps: 150,
    tuples: [
        Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 },
        Tuple { left: -100, right: 100, when: When::Larger, threshold_cm: 0 },
        Tuple { left: 100, right: -100, when: When::Smaller, threshold_cm: 255 },
        Tuple { left: 0, right: 0, when: When::Larger, threshold_cm: 254 },
        Tuple { left: 7, right: -3, when: When::Smaller, threshold_cm: 1 },
        Tuple { left: 60, right: 60, when: When::Larger, threshold_cm: 128 },
    ],
};
