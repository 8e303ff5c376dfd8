//! Controllers for tests.

use mindgap_core::controller::{Controller, Tuple, When};

/// Returns a controller at the ends of every range: full speed in both directions, standstill, thresholds 0 and 255.
pub fn at_its_limits() -> Controller {
    let tuple = |left, right, when, threshold_cm| Tuple { left, right, when, threshold_cm };
    Controller {
        step_ms: 400,
        max_steps: 150,
        tuples: [
            tuple(55, 48, When::Smaller, 42),
            tuple(-100, 100, When::Larger, 0),
            tuple(100, -100, When::Smaller, 255),
            tuple(0, 0, When::Larger, 254),
            tuple(7, -3, When::Smaller, 1),
            tuple(60, 60, When::Larger, 128),
        ],
    }
}
