//! Which of a controller's tuples a run held, by the commands of its log alone.

use mindgap_core::controller::{Controller, TUPLES};

use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Run;

/// What the logged commands say of a run.
pub struct Driven {
    /// The tuples that may have been held last: consecutive ones with the same command look alike.
    last: [bool; TUPLES],
    /// Rows at which a tuple was held.
    pub steps: usize,
    /// Whether the motors were stopped then.
    stopped: bool,
}

impl Driven {
    /// Follows the controller's tuples through the commands of a run.
    ///
    /// # Errors
    /// Names the line whose commands are not those of this controller.
    pub fn of(controller: &Controller, run: &Run) -> Result<Self> {
        let commands = controller.tuples.each_ref().map(|tuple| [f64::from(tuple.left), f64::from(tuple.right)]);
        let mut driven = Driven { last: [false; TUPLES], steps: 0, stopped: false };
        for (i, row) in run.rows.iter().enumerate() {
            // A tuple is held from the first row on, or after itself or the one before.
            let held: [bool; TUPLES] = std::array::from_fn(|tuple| {
                let follows = driven.last[tuple] || tuple > 0 && driven.last[tuple - 1];
                commands[tuple] == row.command() && if i == 0 { tuple == 0 } else { follows }
            });
            let may_hold = held.contains(&true);
            if i > 0 && row.command() == [0.0; 2] && (i + 1 == run.rows.len() || !may_hold) {
                driven.stopped = true;
            } else if may_hold && !driven.stopped {
                (driven.last, driven.steps) = (held, driven.steps + 1);
            } else {
                let [left, right] = row.command();
                let what = format!("line {}: commands {left}, {right} are not this controller's at that point", i + 2);
                return Err(Error::new(format!("{what}: it is the log of another controller or robot")));
            }
        }
        Ok(driven)
    }

    /// Whether the last tuple's test may have ended the run.
    pub fn may_have_finished(&self) -> bool {
        self.stopped && self.last[TUPLES - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_core::controller::{Machine, Status, Tuple, When};
    use mindgap_logs::Row;
    use proptest::prelude::*;

    /// Few commands and thresholds, so that neighbours are often the same.
    fn controllers() -> impl Strategy<Value = Controller> {
        let tuple = (-1..=1i8, 0..=1i8, 40..60i16).prop_map(|(left, right, threshold_cm)| Tuple {
            left,
            right,
            when: When::Smaller,
            threshold_cm,
        });
        prop::array::uniform6(tuple).prop_map(|tuples| Controller { step_ms: 400, max_steps: 12, tuples })
    }

    proptest! {
        #[test]
        fn every_run_of_a_controller_is_its_own(
            controller in controllers(),
            readings in prop::collection::vec(30..70i16, 12),
        ) {
            let mut machine = Machine::start();
            let mut rows = Vec::new();
            for reading_cm in readings {
                let motors = machine.motors(&controller);
                rows.push(Row { left: motors.left.into(), right: motors.right.into(), ..Row::default() });
                if machine.step(&controller, Some(reading_cm)) != Status::Running {
                    break;
                }
            }
            let steps = rows.len();
            rows.push(Row::default());
            let run = Run { name: "run".into(), rows: rows.into_iter().collect() };
            let driven = Driven::of(&controller, &run).expect("its own commands");
            prop_assert_eq!(driven.steps, steps);
            prop_assert!(machine.status() != Status::Finished || driven.may_have_finished());
        }
    }
}
