//! The controller that the images run.

use mindgap_core::controller::{Controller, Tuple, When};

/// Drives up to a wall and back, three times.
pub static CONTROLLER: Controller = Controller {
    step_ms: 400,
    max_steps: 150,
    tuples: [
        Tuple { left: 60, right: 55, when: When::Smaller, threshold_cm: 60 },
        Tuple { left: -45, right: -50, when: When::Larger, threshold_cm: 110 },
        Tuple { left: 80, right: 78, when: When::Smaller, threshold_cm: 45 },
        Tuple { left: -70, right: -60, when: When::Larger, threshold_cm: 140 },
        Tuple { left: 35, right: 40, when: When::Smaller, threshold_cm: 30 },
        Tuple { left: -90, right: -90, when: When::Larger, threshold_cm: 100 },
    ],
};
