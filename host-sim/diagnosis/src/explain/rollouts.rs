//! Whether rollouts bear out what steps say: effects that are the whole cause bring the ends of paths nearer too.
//!
//! What effects foretell is how far paths of the robot would end off, without them and with them, if it had them and its steps
//! scattered as they do: a check of the posterior by what it predicts (Gelman, Meng and Stern 1996, Statistica Sinica 6). Steps that
//! err seldom, but far and to one side, are few among all and carry a path away.

use std::ops::RangeInclusive;

use crate::calibration::Calibration;
use crate::compare::Comparison;
use mindgap_learning::evaluation::paths::{PathError, Paths};

/// Steps of the rollouts that are judged. One is judged by itself, and over more the simulator's own error adds up: robots whose
/// motion nothing changes end 25 steps up to 3.7 cm off where noise alone makes 2.8.
const JUDGED: RangeInclusive<usize> = 2..=10;

/// The longest rollouts that the effects bring less than so much nearer to where the robot went, for all that chance may do.
pub fn refuting<'a>(found: &'a Comparison, calibration: &Calibration) -> Option<&'a PathError> {
    let least = calibration.judgement.rollouts_nearer;
    let refutes = |paths: &&Paths| {
        JUDGED.contains(&paths.error.steps)
            && paths.nearer_ci95.is_some_and(|[_, nearer_at_most]| nearer_at_most < least)
    };
    found.paths.iter().rfind(refutes).map(|paths| &paths.error)
}

/// What they say, in words; none where rollouts bear the effects out.
pub fn refutation(found: &Comparison, calibration: &Calibration) -> Option<String> {
    let PathError { steps, before_cm, after_cm, .. } = refuting(found, calibration)?;
    Some(format!(
        "Paths of {steps} steps end {after_cm:.2} cm from where the robot went with these effects, and {before_cm:.2} cm without \
         them: they explain most steps, and something else carries it away."
    ))
}
