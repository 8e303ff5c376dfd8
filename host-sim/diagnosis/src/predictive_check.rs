//! Posterior-predictive check: effects that are the whole cause bring the ends of open-loop paths closer too.
//!
//! Effects predict how far paths of a robot with these effects and this noise would end from predictions without and with them,
//! and that is compared with the logged paths (Gelman, Meng and Stern 1996, Statistica Sinica 6). Steps with rare but large and
//! one-sided errors hardly change the likelihood of steps, and carry a path away.

use std::ops::RangeInclusive;

use super::calibration::Calibration;
use super::confirm::Confirmed;
use mindgap_learning::evaluation::paths::{PathError, Paths};

/// Lengths of the paths that are checked. A single step is scored by its likelihood; over longer paths the simulator's own error
/// adds up: unchanged robots end 25 steps up to 3.7 cm off where noise alone makes 2.8 cm.
const STEPS: RangeInclusive<usize> = 2..=10;

/// Returns the longest paths that refute the effects: for all that chance may do, they improve by less than is required.
pub fn refuted<'a>(found: &'a Confirmed, calibration: &Calibration) -> Option<&'a PathError> {
    let least = calibration.judgement.rollouts_nearer;
    let refutes = |paths: &&Paths| {
        STEPS.contains(&paths.error.steps) && paths.improvement_ci95.is_some_and(|[_, at_most]| at_most < least)
    };
    found.paths.iter().rfind(refutes).map(|paths| &paths.error)
}

/// Returns a note about paths that refute the effects, if any do.
pub fn note(found: &Confirmed, calibration: &Calibration) -> Option<String> {
    let PathError { steps, before_cm, after_cm, .. } = refuted(found, calibration)?;
    Some(format!(
        "Open-loop paths of {steps} steps end {after_cm:.2} cm from the robot with these effects, and {before_cm:.2} cm without \
         them: the effects explain most single steps, but something else carries the robot away."
    ))
}
