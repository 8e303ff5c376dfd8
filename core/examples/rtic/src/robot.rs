//! What the robot does with a reading.

use fixed::types::I16F16;
use mindgap_core::controller::{Controller, Machine, Motors, Status, Tuple, When};

use crate::networks::{ECHO_PROBABILITY, FORWARD};

/// A controller as `mindgap export --format rust` writes it.
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

/// How much shorter a reading may be than the simulator expects before it is taken for a ghost.
const GHOST_CM: I16F16 = I16F16::const_from_int(30);
/// Where the sensor can be trusted to hear anything.
const LEAST_PROBABILITY: I16F16 = I16F16::lit("0.25");

/// The controller's place in its run, and what the simulator needs to expect the next reading.
pub struct Robot {
    machine: Machine,
    previous: Motors,
    last_cm: Option<I16F16>,
}

impl Robot {
    /// A robot at its start.
    pub fn start() -> Self {
        Robot { machine: Machine::start(), previous: Motors { left: 0, right: 0 }, last_cm: None }
    }

    /// Takes the reading of a step; what the motors are told next.
    pub fn step(&mut self, reading_cm: Option<I16F16>) -> Motors {
        let current = self.motors();
        let commands = [current.left, current.right, self.previous.left, self.previous.right].map(I16F16::from);
        let moved_cm = FORWARD.evaluate(commands).value;
        let expected_cm = self.last_cm.map(|last_cm| last_cm.saturating_sub(moved_cm));
        let believed_cm = reading_cm.filter(|reading_cm| expected_cm.is_none_or(|e| is_plausible(*reading_cm, e)));
        self.last_cm = believed_cm.or(expected_cm);
        self.previous = current;
        self.machine.step(&CONTROLLER, believed_cm);
        self.motors()
    }

    /// What the motors are told now.
    pub fn motors(&self) -> Motors {
        self.machine.motors(&CONTROLLER)
    }

    /// The tuple that is held, from 0.
    pub fn tuple(&self) -> usize {
        self.machine.tuple()
    }

    /// Where the run stands.
    pub fn status(&self) -> Status {
        self.machine.status()
    }
}

/// A reading far shorter than expected is a ghost, unless no echo was to be expected from there anyway.
fn is_plausible(reading_cm: I16F16, expected_cm: I16F16) -> bool {
    let echo = ECHO_PROBABILITY.evaluate([expected_cm, I16F16::ZERO]);
    echo.value < LEAST_PROBABILITY || reading_cm > expected_cm.saturating_sub(GHOST_CM)
}
