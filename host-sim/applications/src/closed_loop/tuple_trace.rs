//! The tuples that a run went through, inferred from the commands of its log.

use mindgap_core::controller::{Controller, TUPLES};

use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Run;

/// The tuples of a run.
pub struct TupleTrace {
    /// Tuples that may have been active last: consecutive ones with the same command cannot be distinguished.
    last: [bool; TUPLES],
    /// Number of rows at which a tuple was active.
    pub steps: usize,
    /// Whether the motors were stopped afterwards.
    stopped: bool,
}

impl TupleTrace {
    /// Follows the controller's tuples through the commands of a run.
    ///
    /// # Errors
    /// If a line has commands that this controller cannot give at that point.
    pub fn of(controller: &Controller, run: &Run) -> Result<Self> {
        let commands = controller.tuples.each_ref().map(|tuple| [f64::from(tuple.left), f64::from(tuple.right)]);
        let mut driven = TupleTrace { last: [false; TUPLES], steps: 0, stopped: false };
        for (i, row) in run.rows.iter().enumerate() {
            // The first tuple is active at the first row; later, the last active tuple or the next one is.
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
                let what = format!("line {}: this controller cannot give the commands {left}, {right} here", i + 2);
                return Err(Error::new(format!("{what}: it is the log of another controller or robot")));
            }
        }
        Ok(driven)
    }

    /// Returns whether the last tuple's test may have ended the run.
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

    /// Controllers with few distinct commands, so that neighbouring tuples are often equal.
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
        fn every_run_of_a_controller_is_recognised(
            controller in controllers(),
            readings in prop::collection::vec(30..70i16, 12),
        ) {
            let mut machine = Machine::start(&controller);
            let mut rows = Vec::new();
            for reading_cm in readings {
                let motors = machine.motors();
                rows.push(Row { left: motors.left.into(), right: motors.right.into(), ..Row::default() });
                if machine.step(Some(reading_cm)) != Status::Running {
                    break;
                }
            }
            let steps = rows.len();
            rows.push(Row::default());
            let run = Run { name: "run".into(), rows: rows.into_iter().collect() };
            let driven = TupleTrace::of(&controller, &run).expect("its own commands");
            prop_assert_eq!(driven.steps, steps);
            prop_assert!(machine.status() != Status::Finished || driven.may_have_finished());
        }
    }
}
