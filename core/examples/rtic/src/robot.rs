//! Filters implausible readings and steps the controller.

use mindgap_core::controller::{Controller, Machine, Motors, Status, Tuple, When};
use mindgap_core::fixed::types::I16F16;

use crate::networks::{ECHO_PROBABILITY, FORWARD};

/// A controller in the form that `mindgap export --format rust` writes.
pub static CONTROLLER: Controller = Controller {
    step_ms: 400,
    max_steps: 150,
    tuples: [
        Tuple { left: 60, right: 60, when: When::Smaller, threshold_cm: 60 },
        Tuple { left: -50, right: -50, when: When::Larger, threshold_cm: 80 },
        Tuple { left: 60, right: 60, when: When::Smaller, threshold_cm: 60 },
        Tuple { left: -50, right: -50, when: When::Larger, threshold_cm: 80 },
        Tuple { left: 60, right: 60, when: When::Smaller, threshold_cm: 60 },
        Tuple { left: -50, right: -50, when: When::Larger, threshold_cm: 80 },
    ],
};

/// Difference by which a reading has to be shorter than the simulator predicts to count as a ghost echo.
const GHOST_CM: I16F16 = I16F16::const_from_int(30);
/// Probability of an echo below which the simulator's prediction is not trusted.
const MIN_PROBABILITY: I16F16 = I16F16::lit("0.25");

/// The controller's run, and the state from which the simulator predicts the next reading.
pub struct Robot {
    machine: Machine<'static>,
    previous: Motors,
    last_cm: Option<I16F16>,
}

impl Robot {
    /// Returns a robot at its start.
    pub fn start() -> Self {
        Robot { machine: Machine::start(&CONTROLLER), previous: Motors { left: 0, right: 0 }, last_cm: None }
    }

    /// Takes the reading of a step. Returns the next motor commands.
    pub fn step(&mut self, reading_cm: Option<I16F16>) -> Motors {
        let current = self.motors();
        let commands = [current.left, current.right, self.previous.left, self.previous.right].map(I16F16::from);
        let moved_cm = FORWARD.evaluate(commands).value;
        let expected_cm = self.last_cm.map(|last_cm| last_cm.saturating_sub(moved_cm));
        let accepted_cm = reading_cm.filter(|reading_cm| expected_cm.is_none_or(|e| is_plausible(*reading_cm, e)));
        self.last_cm = accepted_cm.or(expected_cm);
        self.previous = current;
        self.machine.step(accepted_cm);
        self.motors()
    }

    /// Returns the current motor commands.
    pub fn motors(&self) -> Motors {
        self.machine.motors()
    }

    /// Returns the index of the current tuple, from 0.
    pub fn tuple(&self) -> usize {
        self.machine.tuple()
    }

    /// Returns the status of the run.
    pub fn status(&self) -> Status {
        self.machine.status()
    }
}

/// Returns whether a reading is plausible. One far shorter than predicted is a ghost echo, unless no echo was predicted.
fn is_plausible(reading_cm: I16F16, expected_cm: I16F16) -> bool {
    let echo = ECHO_PROBABILITY.evaluate([expected_cm, I16F16::ZERO]);
    echo.value < MIN_PROBABILITY || reading_cm > expected_cm.saturating_sub(GHOST_CM)
}
