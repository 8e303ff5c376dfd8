//! Motions worked out ahead: a controller holds at most twelve different pairs of commands now and before, so the
//! motion networks are asked twelve times a controller and not once a step.

use mindgap_core::controller::{Controller, TUPLES};

use super::scatter::{Spread, motion_context};
use super::{Learned, Simulator};
use crate::problem::Result;

/// The three motion networks of a simulator.
#[derive(Clone, Copy)]
pub struct MotionNetworks<'s> {
    forward: &'s Learned<4>,
    lateral: &'s Learned<4>,
    turn: &'s Learned<4>,
}

/// What one step does, in the robot's own frame, before scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Way forward, cm.
    pub forward_cm: f32,
    /// Way to the left, cm.
    pub lateral_cm: f32,
    /// Turn to the left.
    pub turn_rad: f32,
    /// Cells of the forward, lateral and turn networks' spreads.
    pub cells: [usize; 3],
}

/// The motions of a controller: for each tuple the step after it began, and every later one.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionTable {
    first: [Motion; TUPLES],
    steady: [Motion; TUPLES],
}

impl<'s> MotionNetworks<'s> {
    /// The networks of a simulator.
    ///
    /// # Errors
    /// Names the one that is missing.
    pub fn of(simulator: &'s Simulator) -> Result<Self> {
        Ok(MotionNetworks {
            forward: simulator.need(&simulator.forward, "forward")?,
            lateral: simulator.need(&simulator.lateral, "lateral")?,
            turn: simulator.need(&simulator.turn, "turn")?,
        })
    }

    /// What a step does for left, right, previous left and previous right command.
    pub fn step(&self, speeds: [f32; 4]) -> Motion {
        let context = motion_context(&speeds);
        let ask = |learned: &Learned<4>| (learned.network.evaluate(speeds), learned.spread.cell(context));
        let (forward_cm, forward_cell) = ask(self.forward);
        let (lateral_cm, lateral_cell) = ask(self.lateral);
        let (turn_deg, turn_cell) = ask(self.turn);
        let cells = [forward_cell, lateral_cell, turn_cell];
        Motion { forward_cm, lateral_cm, turn_rad: turn_deg.to_radians(), cells }
    }

    /// The motions of a controller that starts from rest.
    pub fn table(&self, controller: &Controller) -> MotionTable {
        let command = |tuple: usize| [controller.tuples[tuple].left, controller.tuples[tuple].right].map(f32::from);
        let step = |now: [f32; 2], before: [f32; 2]| self.step([now[0], now[1], before[0], before[1]]);
        MotionTable {
            first: std::array::from_fn(|t| step(command(t), if t == 0 { [0.0; 2] } else { command(t - 1) })),
            steady: std::array::from_fn(|t| step(command(t), command(t))),
        }
    }

    /// Adds to a motion one of the residuals of each network, as far as it is the robot's own.
    pub fn scatter(&self, motion: &Motion, levels: [usize; 3]) -> Motion {
        let residual = |spread: &Spread, i: usize| {
            let cell = motion.cells[i];
            spread.own_share[cell] * spread.residuals[cell][levels[i]]
        };
        Motion {
            forward_cm: motion.forward_cm + residual(&self.forward.spread, 0),
            lateral_cm: motion.lateral_cm + residual(&self.lateral.spread, 1),
            turn_rad: motion.turn_rad + residual(&self.turn.spread, 2).to_radians(),
            cells: motion.cells,
        }
    }
}

impl MotionTable {
    /// The motion of a step in which a tuple is held, its first step or a later one.
    pub fn motion(&self, tuple: usize, first: bool) -> &Motion {
        if first { &self.first[tuple] } else { &self.steady[tuple] }
    }
}
