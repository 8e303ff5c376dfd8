//! A tracked heading that follows the true one with a first-order lag.
//!
//! A robot that turns evenly by ω runs ahead of such a heading by e, with e' = ω − e/τ. While the commands change, e is a filter of
//! the turns alone, so that a step is predicted from the pose tracked before it: its translation appears turned by e, and its
//! turn shortened by what e grows.

use super::context::{HISTORY, StepContext};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::motion::Motion;

/// A first-order lag of the tracked heading behind the true one.
#[derive(Clone, Copy, Debug)]
pub struct LaggingHeading {
    /// Its time constant, steps; negative for a heading that leads, as it does beside older positions.
    steps: f64,
    /// Share of an error that is left after a step.
    left: f64,
    /// What a step adds to the error, as a share of its turn.
    added: f64,
}

/// The turn of a step.
#[derive(Clone, Copy, Debug)]
pub struct Turns {
    /// The turn itself.
    pub rad: f64,
    /// What it would be if the step's command had been held for long.
    pub held_rad: f64,
}

/// After this many time constants a twentieth of an error is left.
const OVER: f64 = 3.0;

impl LaggingHeading {
    /// Returns the lag of this many steps; `None` for none.
    pub fn new(steps: f64) -> Option<Self> {
        let left = libm::exp(-1.0 / steps.abs());
        (steps != 0.0).then_some(LaggingHeading { steps, left, added: steps * (1.0 - left) })
    }

    /// Returns by how much the heading is ahead of the tracked one at the start of the present step. `turns` returns those of the step
    /// this many steps ago; before the oldest that matters the robot turned as in that one.
    pub fn error_rad(&self, mut turns: impl FnMut(usize) -> Turns) -> f64 {
        let oldest = self.reach_steps();
        let steady_rad = self.steps * turns(oldest).held_rad;
        (1..oldest).rev().fold(steady_rad, |error_rad, ago| self.after(error_rad, turns(ago)))
    }

    /// Returns the number of earlier steps whose turns matter.
    pub fn reach_steps(&self) -> usize {
        ((OVER * self.steps.abs()).ceil() as usize).clamp(1, HISTORY - 1)
    }

    /// Returns how a step looks that starts with this error; `held_rad` is its turn if its command had been held for long.
    pub fn seen(&self, mut motion: Motion<f64>, held_rad: f64, error_rad: f64) -> Motion<f64> {
        let grown_rad = self.after(error_rad, Turns { rad: motion.turn, held_rad }) - error_rad;
        motion.rotate_translation(error_rad);
        Motion { turn: motion.turn - grown_rad, ..motion }
    }

    /// What a step turns less than under a held command it misses at its beginning.
    fn after(&self, error_rad: f64, Turns { rad, held_rad }: Turns) -> f64 {
        self.left * (error_rad + self.steps.signum() * (rad - held_rad)) + self.added * held_rad
    }
}

/// Returns the heading of a robot whose tracked heading lags by this many steps: ahead of it by the lag times the rate at which that
/// turned last.
pub fn ahead_of_tracked_rad(steps: f64, context: &StepContext) -> f64 {
    let here_rad = context.pose.heading_rad;
    let turned_rad = context.earlier[0].map_or(0.0, |before| wrap_rad(here_rad - before.heading_rad));
    wrap_rad(here_rad + steps * turned_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::geometry::Pose;

    /// Integrates the filter in small steps behind turns that begin at once, and drives 10 cm a step.
    fn integrated(lag_steps: f64, turns_rad: &[f64]) -> Vec<Motion<f64>> {
        const PARTS: usize = 4000;
        let (mut pose, mut tracked_rad) = (Pose::new(0.0, 0.0, 0.0), 0.0);
        let mut seen = Vec::new();
        for turn_rad in turns_rad {
            let start = Pose { heading_rad: tracked_rad, ..pose };
            for _ in 0..PARTS {
                let part = Motion { forward: 10.0, lateral: 0.0, turn: *turn_rad }.scaled(1.0 / PARTS as f64);
                pose = part.end(&pose);
                tracked_rad += wrap_rad(pose.heading_rad - tracked_rad) / (lag_steps * PARTS as f64);
            }
            seen.push(Motion::between(&start, &Pose { heading_rad: tracked_rad, ..pose }));
        }
        seen
    }

    #[test]
    fn steps_look_as_a_filter_in_small_steps_makes_them() {
        let turns_rad = [0.0, 0.0, 0.0, 0.4, 0.4, -0.3, 0.0];
        for lag_steps in [0.2, 0.5, 1.0] {
            let lag = LaggingHeading::new(lag_steps).unwrap();
            for (step, expected) in integrated(lag_steps, &turns_rad).into_iter().enumerate() {
                let even = |rad: f64| Turns { rad, held_rad: rad };
                let error_rad = lag.error_rad(|ago| even(if ago <= step { turns_rad[step - ago] } else { 0.0 }));
                let half_rad = 0.5 * turns_rad[step];
                let chord_cm = if half_rad == 0.0 { 10.0 } else { 10.0 * libm::sin(half_rad) / half_rad };
                let (forward, lateral) = (chord_cm * libm::cos(half_rad), chord_cm * libm::sin(half_rad));
                let found = lag.seen(Motion { forward, lateral, turn: turns_rad[step] }, turns_rad[step], error_rad);
                // Of what is older than three time constants, up to a twentieth of 0.4 rad is missing.
                assert!((found.turn - expected.turn).abs() < 0.02, "{lag_steps}: {found:?} {expected:?}");
                assert!((found.lateral - expected.lateral).abs() < 0.3, "{lag_steps}: {found:?} {expected:?}");
                assert!((found.forward - expected.forward).abs() < 0.1, "{lag_steps}: {found:?} {expected:?}");
            }
        }
    }

    /// A step whose turn comes late, behind a slow drive, ends with the error of the rate that it reached.
    #[test]
    fn late_turn_leaves_the_error_of_the_final_rate() {
        let lag = LaggingHeading::new(0.2).unwrap();
        let error_rad = lag.after(0.0, Turns { rad: 0.3, held_rad: 0.4 });
        assert!((error_rad - 0.2 * 0.4).abs() < 0.002, "{error_rad}");
        let lead = LaggingHeading::new(-0.2).unwrap();
        assert_eq!(lead.after(0.0, Turns { rad: 0.3, held_rad: 0.4 }), -error_rad);
    }

    #[test]
    fn heading_that_does_not_lag_is_no_lag() {
        assert!(LaggingHeading::new(0.0).is_none());
    }
}
