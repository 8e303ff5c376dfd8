//! The six-tuple threshold controller (paper, section IX) and the machine that steps through it.

use core::fmt;

#[cfg(feature = "schemars")]
use schemars::JsonSchema;
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// The number of tuples in a controller.
pub const TUPLES: usize = 6;
/// The strongest motor command, in percent of full power.
pub const FULL_SPEED: i8 = 100;
/// The largest threshold, in cm: an NXT ultrasonic sensor reports whole centimetres up to 254, and 255 for no echo.
pub const MAX_THRESHOLD_CM: i16 = 255;

/// Six tuples that are run one after the other.
///
/// ```
/// use mindgap_core::controller::{Controller, Machine, Motors, Status, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// assert!(controller.check().is_ok());
///
/// let mut machine = Machine::start(&controller);
/// assert_eq!(machine.motors(), Motors { left: 55, right: 48 });
/// // A missing echo changes nothing, and neither does a reading that is not below the threshold.
/// assert_eq!(machine.step(None::<f32>), Status::Running);
/// assert_eq!(machine.step(Some(42.0)), Status::Running);
/// assert_eq!(machine.tuple(), 0);
/// machine.step(Some(41.0));
/// assert_eq!(machine.tuple(), 1);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Controller {
    /// Time between two sensor readings, in ms.
    pub step_ms: u16,
    /// Number of steps after which the controller gives up.
    pub max_steps: u16,
    /// The tuples, in the order in which they are run.
    #[cfg_attr(feature = "serde", serde(rename = "tuple"))]
    pub tuples: [Tuple; TUPLES],
}

/// Motor commands that are held until a reading lies on the stated side of the threshold.
///
/// The names in brackets are those of the paper.
///
/// ```
/// use mindgap_core::controller::{Tuple, When};
///
/// let tuple = Tuple { left: 55, right: 48, when: When::Larger, threshold_cm: 42 };
/// assert!(tuple.ends_at(43));
/// assert!(!tuple.ends_at(42), "the comparison is strict");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct Tuple {
    /// Command of the left motor, -100..=100 (mot1).
    pub left: i8,
    /// Command of the right motor, -100..=100 (mot2).
    pub right: i8,
    /// Side of the threshold on which a reading ends the tuple (bigorsmall).
    pub when: When,
    /// Threshold, 0..=255 cm (ultval).
    pub threshold_cm: i16,
}

/// The side of the threshold on which a reading ends a tuple. Both comparisons are strict.
///
/// ```
/// use mindgap_core::controller::{Tuple, When};
///
/// let tuple = |when| Tuple { left: 0, right: 0, when, threshold_cm: 42 };
/// assert!(tuple(When::Smaller).ends_at(41) && !tuple(When::Larger).ends_at(41));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize), serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub enum When {
    /// A reading larger than the threshold ends the tuple.
    Larger,
    /// A reading smaller than the threshold ends the tuple.
    Smaller,
}

/// A pair of motor commands, in percent of full power; negative is backward.
///
/// ```
/// use mindgap_core::controller::Motors;
///
/// let spin_left = Motors { left: -30, right: 30 };
/// assert_eq!(spin_left.left, -spin_left.right);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motors {
    /// Command of the left motor, -100..=100.
    pub left: i8,
    /// Command of the right motor, -100..=100.
    pub right: i8,
}

/// The status of a controller's run.
///
/// ```
/// use mindgap_core::controller::{Controller, Machine, Status, Tuple, When};
///
/// let tuple = Tuple { left: 50, right: 50, when: When::Smaller, threshold_cm: 0 };
/// let controller = Controller { step_ms: 400, max_steps: 1, tuples: [tuple; 6] };
/// assert_eq!(Machine::start(&controller).step(Some(100)), Status::TimedOut);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// A tuple is being held.
    Running,
    /// A reading ended the sixth tuple; the motors are stopped.
    Finished,
    /// The step limit was reached; the motors are stopped.
    TimedOut,
}

/// The reason why a controller cannot be run. Tuples are counted from 0 in the data and from 1 in the message.
///
/// ```
/// use mindgap_core::controller::InvalidController;
///
/// let error = InvalidController::Speed(2);
/// assert_eq!(error.to_string(), "tuple 3: a motor command is outside -100..100");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum InvalidController {
    /// A motor command of this tuple is outside -100..=100.
    Speed(usize),
    /// The threshold of this tuple is outside 0..=255 cm.
    Threshold(usize),
    /// The step time is zero.
    StepTime,
    /// The step limit is zero.
    StepLimit,
}

impl fmt::Display for InvalidController {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InvalidController::Speed(i) => {
                write!(f, "tuple {}: a motor command is outside -100..100", i.saturating_add(1))
            }
            InvalidController::Threshold(i) => {
                write!(f, "tuple {}: threshold_cm is outside 0..255", i.saturating_add(1))
            }
            InvalidController::StepTime => f.write_str("step_ms is 0"),
            InvalidController::StepLimit => f.write_str("max_steps is 0"),
        }
    }
}

impl core::error::Error for InvalidController {}

/// One run of a controller: the tuple that is held, and the number of steps taken.
///
/// A machine borrows its controller, so the controller cannot change during a run. A controller in a `static` gives a
/// `Machine<'static>`, which a task can own.
///
/// ```
/// use mindgap_core::controller::{Controller, Machine, Status, Tuple, When};
///
/// const SMALLER: Tuple = Tuple { left: 60, right: 60, when: When::Smaller, threshold_cm: 30 };
/// static CONTROLLER: Controller = Controller { step_ms: 400, max_steps: 150, tuples: [SMALLER; 6] };
///
/// let mut machine: Machine<'static> = Machine::start(&CONTROLLER);
/// while machine.step(Some(20)) == Status::Running {}
/// assert_eq!((machine.status(), machine.steps()), (Status::Finished, 6));
/// assert_eq!(machine.motors().left, 0, "a stopped machine stops the motors");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine<'c> {
    controller: &'c Controller,
    tuple: u8,
    steps: u16,
    status: Status,
}

impl Controller {
    /// Checks the ranges that the types leave open.
    ///
    /// # Errors
    /// Returns an [`InvalidController`] that names the first number out of range.
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

impl<'c> Machine<'c> {
    /// Starts a run: the first tuple's motors are on and nothing has been read.
    pub fn start(controller: &'c Controller) -> Self {
        Machine { controller, tuple: 0, steps: 0, status: Status::Running }
    }

    /// Takes one step with its reading in cm, or `None` if the sensor produced no value, and returns the new status.
    ///
    /// A NaN ends no tuple. A stopped run stays stopped.
    pub fn step<R: PartialOrd + From<i16>>(&mut self, reading_cm: Option<R>) -> Status {
        if self.status != Status::Running {
            return self.status;
        }
        self.steps = self.steps.saturating_add(1);
        let ends = match (self.held(), reading_cm) {
            (Some(tuple), Some(reading_cm)) => tuple.ends_at(reading_cm),
            _ => false,
        };
        if ends {
            self.tuple = self.tuple.saturating_add(1);
        }
        if usize::from(self.tuple) >= TUPLES {
            self.status = Status::Finished;
        } else if self.steps >= self.controller.max_steps {
            self.status = Status::TimedOut;
        }
        self.status
    }

    /// Takes `steps` steps at once, with the same result as [`step`](Machine::step) on readings that end no tuple.
    pub fn hold(&mut self, steps: u16) {
        if self.status == Status::Running && steps > 0 {
            let max_steps = self.controller.max_steps;
            let left = max_steps.saturating_sub(self.steps).max(1);
            self.steps = self.steps.saturating_add(steps.min(left));
            if self.steps >= max_steps {
                self.status = Status::TimedOut;
            }
        }
    }

    /// Returns the current motor commands, clamped to -100..=100; zero once stopped.
    pub fn motors(&self) -> Motors {
        match (self.status, self.held()) {
            (Status::Running, Some(tuple)) => Motors {
                left: tuple.left.clamp(-FULL_SPEED, FULL_SPEED),
                right: tuple.right.clamp(-FULL_SPEED, FULL_SPEED),
            },
            _ => Motors { left: 0, right: 0 },
        }
    }

    /// Returns the index of the current tuple, from 0; six once finished.
    pub fn tuple(&self) -> usize {
        usize::from(self.tuple)
    }

    /// Returns the number of steps taken so far.
    pub fn steps(&self) -> u16 {
        self.steps
    }

    /// Returns the status of the run.
    pub fn status(&self) -> Status {
        self.status
    }

    /// The tuple that is held; `None` once finished.
    fn held(&self) -> Option<&'c Tuple> {
        self.controller.tuples.get(usize::from(self.tuple))
    }
}

impl Tuple {
    /// Returns whether a reading in cm ends this tuple. A NaN does not.
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
    fn sixth_tuple_ends_the_run_and_stops_the_motors() {
        let c = controller(100);
        let mut m = Machine::start(&c);
        for (i, reading) in [49i16, 51, 0, 255, 49].into_iter().enumerate() {
            assert_eq!(m.step(Some(reading)), Status::Running);
            assert_eq!(m.motors().left, (i as i8 + 1) * 10);
        }
        assert_eq!(m.step(Some(51i16)), Status::Finished);
        assert_eq!(m.motors(), Motors { left: 0, right: 0 });
        assert_eq!((m.tuple(), m.steps()), (6, 6));
        assert_eq!(m.step(Some(0i16)), Status::Finished, "a stopped run stays stopped");
    }

    #[test]
    fn comparisons_are_strict_and_nan_ends_no_tuple() {
        for when in [When::Larger, When::Smaller] {
            assert!(!tuple(1, when, 50).ends_at(50.0f32));
            assert!(!tuple(1, when, 50).ends_at(f32::NAN));
        }
    }

    #[test]
    fn step_limit_stops_the_run_after_exactly_that_many_steps() {
        let c = controller(3);
        let mut m = Machine::start(&c);
        assert_eq!(m.step(None::<i16>), Status::Running);
        assert_eq!(m.step(None::<i16>), Status::Running);
        assert_eq!(m.step(None::<i16>), Status::TimedOut);
        assert_eq!(m.motors(), Motors { left: 0, right: 0 });
    }

    #[test]
    fn run_that_finishes_in_its_last_step_has_not_timed_out() {
        let c = controller(6);
        let mut m = Machine::start(&c);
        let last = [49i16, 51, 49, 51, 49, 51].map(|r| m.step(Some(r)))[5];
        assert_eq!(last, Status::Finished);
    }

    #[test]
    fn hold_equals_steps_without_a_reading() {
        for max_steps in [1, 5, 100] {
            let c = controller(max_steps);
            for steps in 0..8 {
                let (mut held, mut stepped) = (Machine::start(&c), Machine::start(&c));
                for machine in [&mut held, &mut stepped] {
                    machine.step(Some(49i16));
                }
                held.hold(steps);
                (0..steps).for_each(|_| _ = stepped.step(None::<i16>));
                assert_eq!(held, stepped, "{steps} of {max_steps} steps");
            }
        }
    }

    #[test]
    fn check_names_the_tuple_and_messages_count_from_one() {
        let mut c = controller(1);
        assert_eq!(c.check(), Ok(()));
        c.tuples[4].right = -101;
        assert_eq!(c.check(), Err(InvalidController::Speed(4)));
        c.tuples[4].right = 0;
        c.tuples[5].threshold_cm = 256;
        assert_eq!(c.check(), Err(InvalidController::Threshold(5)));
        assert_eq!(InvalidController::Threshold(5).to_string(), "tuple 6: threshold_cm is outside 0..255");
    }

    proptest! {
        #[test]
        fn motors_follow_the_tuple_and_stay_in_range(
            lefts in prop::array::uniform6(any::<i8>()), readings in prop::collection::vec(any::<Option<f32>>(), 0..40),
        ) {
            let c = Controller { tuples: lefts.map(|l| Tuple { left: l, right: l, when: When::Larger, threshold_cm: 20 }), ..controller(20) };
            let mut m = Machine::start(&c);
            let mut expected = 0;
            for r in readings {
                let running = m.status() == Status::Running;
                expected += usize::from(running && r.is_some_and(|r| r > 20.0));
                m.step(r);
                prop_assert_eq!(m.tuple(), expected);
                prop_assert!(m.motors().left.unsigned_abs() <= 100);
                prop_assert!(m.steps() <= 20);
            }
        }
    }
}
