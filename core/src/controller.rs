//! The six-tuple threshold controller (paper, section IX) and the machine that steps through it.

use serde::{Deserialize, Serialize};

/// The number of tuples in a controller.
pub const TUPLES: usize = 6;
/// The strongest motor command.
pub const FULL_SPEED: i8 = 100;
/// The farthest threshold: an NXT ultrasonic sensor reports whole centimetres, 255 standing for none.
pub const MAX_THRESHOLD_CM: i16 = 255;

/// A controller: six tuples, run one after the other.
///
/// ```
/// use mindgap_core::controller::{Controller, Machine, Motors, Status, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// let mut machine = Machine::start();
/// assert_eq!(machine.motors(&controller), Motors { left: 55, right: 48 });
/// // No echo, or an echo from too far away, changes nothing.
/// assert_eq!(machine.step(&controller, None::<f32>), Status::Running);
/// assert_eq!(machine.step(&controller, Some(42.0)), Status::Running);
/// assert_eq!(machine.tuple(), 0);
/// machine.step(&controller, Some(41.0));
/// assert_eq!(machine.tuple(), 1);
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Controller {
    /// Time between two readings of the sensor.
    pub step_ms: u16,
    /// Steps after which the controller gives up.
    pub max_steps: u16,
    /// The tuples in their order.
    #[serde(rename = "tuple")]
    pub tuples: [Tuple; TUPLES],
}

/// Motor commands, held until the sensor produces a value on the stated side of the threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tuple {
    /// Command of the left motor, -100..=100 (mot1).
    pub left: i8,
    /// Command of the right motor, -100..=100 (mot2).
    pub right: i8,
    /// The side of the threshold on which a reading ends the tuple (bigorsmall).
    pub when: When,
    /// The threshold, 0..=255 cm (ultval).
    pub threshold_cm: i16,
}

/// The side of the threshold on which a reading ends a tuple; both comparisons are strict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum When {
    /// A reading larger than the threshold.
    Larger,
    /// A reading smaller than the threshold.
    Smaller,
}

/// Motor commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motors {
    /// Command of the left motor, -100..=100.
    pub left: i8,
    /// Command of the right motor, -100..=100.
    pub right: i8,
}

/// The status of a controller's run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// A tuple is being held.
    Running,
    /// The sixth tuple's test held; the motors are stopped.
    Finished,
    /// The step limit was reached; the motors are stopped.
    TimedOut,
}

/// Why a controller cannot be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum InvalidController {
    /// A speed of this tuple (from 0) is outside -100..=100.
    Speed(usize),
    /// The threshold of this tuple (from 0) is outside 0..=255 cm.
    Threshold(usize),
    /// The step time is zero.
    StepTime,
    /// The step limit is zero.
    StepLimit,
}

/// The state of a controller's run: the current tuple and the number of steps taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    tuple: u8,
    steps: u16,
    status: Status,
}

impl Controller {
    /// Checks the ranges that the types leave open.
    ///
    /// # Errors
    /// [`InvalidController`] names the first number out of range.
    pub fn check(&self) -> Result<(), InvalidController> {
        for (i, tuple) in self.tuples.iter().enumerate() {
            let limit = -FULL_SPEED..=FULL_SPEED;
            if !limit.contains(&tuple.left) || !limit.contains(&tuple.right) {
                return Err(InvalidController::Speed(i));
            }
            if !(0..=MAX_THRESHOLD_CM).contains(&tuple.threshold_cm) {
                return Err(InvalidController::Threshold(i));
            }
        }
        if self.step_ms == 0 {
            return Err(InvalidController::StepTime);
        }
        if self.max_steps == 0 {
            return Err(InvalidController::StepLimit);
        }
        Ok(())
    }
}

impl Machine {
    /// A run at its start: the first tuple's motors are on and nothing has been read.
    pub fn start() -> Self {
        Machine { tuple: 0, steps: 0, status: Status::Running }
    }

    /// Takes a step with its one reading, `None` when the sensor produced no value. A NaN ends no tuple.
    /// Once stopped, a run stays stopped.
    pub fn step<R: PartialOrd + From<i16>>(&mut self, controller: &Controller, reading_cm: Option<R>) -> Status {
        if self.status != Status::Running {
            return self.status;
        }
        self.steps = self.steps.saturating_add(1);
        let holds = match (controller.tuples.get(usize::from(self.tuple)), reading_cm) {
            (Some(tuple), Some(reading_cm)) => tuple.ends_at(reading_cm),
            _ => false,
        };
        if holds {
            self.tuple = self.tuple.saturating_add(1);
        }
        if usize::from(self.tuple) >= TUPLES {
            self.status = Status::Finished;
        } else if self.steps >= controller.max_steps {
            self.status = Status::TimedOut;
        }
        self.status
    }

    /// Takes `steps` steps at once whose readings end no tuple, as [`step`](Machine::step) would one by one.
    pub fn hold(&mut self, controller: &Controller, steps: u16) {
        if self.status == Status::Running && steps > 0 {
            let left = controller.max_steps.saturating_sub(self.steps).max(1);
            self.steps = self.steps.saturating_add(steps.min(left));
            if self.steps >= controller.max_steps {
                self.status = Status::TimedOut;
            }
        }
    }

    /// The current motor commands; zero once stopped.
    pub fn motors(&self, controller: &Controller) -> Motors {
        match (self.status, controller.tuples.get(usize::from(self.tuple))) {
            (Status::Running, Some(tuple)) => Motors {
                left: tuple.left.clamp(-FULL_SPEED, FULL_SPEED),
                right: tuple.right.clamp(-FULL_SPEED, FULL_SPEED),
            },
            _ => Motors { left: 0, right: 0 },
        }
    }

    /// Index of the current tuple, from 0; six once finished.
    pub fn tuple(&self) -> usize {
        usize::from(self.tuple)
    }

    /// Number of steps taken so far.
    pub fn steps(&self) -> u16 {
        self.steps
    }

    /// The status of the run.
    pub fn status(&self) -> Status {
        self.status
    }
}

impl Tuple {
    /// Whether a reading ends this tuple.
    pub fn ends_at<R: PartialOrd + From<i16>>(&self, reading_cm: R) -> bool {
        let threshold_cm = R::from(self.threshold_cm);
        match self.when {
            When::Larger => reading_cm > threshold_cm,
            When::Smaller => reading_cm < threshold_cm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tuple(left: i8, when: When, threshold_cm: i16) -> Tuple {
        Tuple { left, right: -left, when, threshold_cm }
    }

    fn controller(max_steps: u16) -> Controller {
        let when = |i: i8| if i % 2 == 0 { When::Smaller } else { When::Larger };
        let tuples = core::array::from_fn(|i| tuple(i as i8 * 10, when(i as i8), 50));
        Controller { step_ms: 400, max_steps, tuples }
    }

    #[test]
    fn six_tests_finish_and_stop_the_motors() {
        let c = controller(100);
        let mut m = Machine::start();
        for (i, reading) in [49i16, 51, 0, 255, 49].into_iter().enumerate() {
            assert_eq!(m.step(&c, Some(reading)), Status::Running);
            assert_eq!(m.motors(&c).left, (i as i8 + 1) * 10);
        }
        assert_eq!(m.step(&c, Some(51i16)), Status::Finished);
        assert_eq!(m.motors(&c), Motors { left: 0, right: 0 });
        assert_eq!((m.tuple(), m.steps()), (6, 6));
        assert_eq!(m.step(&c, Some(0i16)), Status::Finished, "a stopped run stays stopped");
    }

    #[test]
    fn comparisons_are_strict_and_nan_ends_nothing() {
        for when in [When::Larger, When::Smaller] {
            assert!(!tuple(1, when, 50).ends_at(50.0f32));
            assert!(!tuple(1, when, 50).ends_at(f32::NAN));
        }
    }

    #[test]
    fn the_step_limit_stops_after_exactly_that_many_steps() {
        let c = controller(3);
        let mut m = Machine::start();
        assert_eq!(m.step(&c, None::<i16>), Status::Running);
        assert_eq!(m.step(&c, None::<i16>), Status::Running);
        assert_eq!(m.step(&c, None::<i16>), Status::TimedOut);
        assert_eq!(m.motors(&c), Motors { left: 0, right: 0 });
    }

    #[test]
    fn finishing_in_the_last_step_counts_as_finished() {
        let c = controller(6);
        let mut m = Machine::start();
        let last = [49i16, 51, 49, 51, 49, 51].map(|r| m.step(&c, Some(r)))[5];
        assert_eq!(last, Status::Finished);
    }

    #[test]
    fn holding_is_stepping_without_a_reading() {
        for max_steps in [1, 5, 100] {
            let c = controller(max_steps);
            for steps in 0..8 {
                let (mut held, mut stepped) = (Machine::start(), Machine::start());
                for machine in [&mut held, &mut stepped] {
                    machine.step(&c, Some(49i16));
                }
                held.hold(&c, steps);
                (0..steps).for_each(|_| _ = stepped.step(&c, None::<i16>));
                assert_eq!(held, stepped, "{steps} of {max_steps} steps");
            }
        }
    }

    #[test]
    fn check_names_the_tuple() {
        let mut c = controller(1);
        assert_eq!(c.check(), Ok(()));
        c.tuples[4].right = -101;
        assert_eq!(c.check(), Err(InvalidController::Speed(4)));
        c.tuples[4].right = 0;
        c.tuples[5].threshold_cm = 256;
        assert_eq!(c.check(), Err(InvalidController::Threshold(5)));
    }

    proptest! {
        #[test]
        fn motors_follow_the_tuple_and_never_leave_their_range(
            lefts in prop::array::uniform6(any::<i8>()), readings in prop::collection::vec(any::<Option<f32>>(), 0..40),
        ) {
            let c = Controller { tuples: lefts.map(|l| Tuple { left: l, right: l, when: When::Larger, threshold_cm: 20 }), ..controller(20) };
            let mut m = Machine::start();
            let mut expected = 0;
            for r in readings {
                let running = m.status() == Status::Running;
                expected += usize::from(running && r.is_some_and(|r| r > 20.0));
                m.step(&c, r);
                prop_assert_eq!(m.tuple(), expected);
                prop_assert!(m.motors(&c).left.unsigned_abs() <= 100);
                prop_assert!(m.steps() <= 20);
            }
        }
    }
}
