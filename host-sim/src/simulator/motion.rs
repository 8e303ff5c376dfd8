//! Motions worked out ahead: a controller holds at most twelve different pairs of commands now and before, so the
//! motion networks are asked twelve times a controller and not once a step.

use mindgap_core::controller::{Controller, TUPLES};

use super::reference::MotionReference;
use super::scatter::{Spread, motion_context};
use super::{Learned, Simulator};
use crate::problem::Result;

/// The three motion networks of a simulator, as they are or with what the logs say beyond them.
#[derive(Clone, Copy)]
pub struct MotionNetworks<'s> {
    forward: &'s Learned<4>,
    lateral: &'s Learned<4>,
    turn: &'s Learned<4>,
    reference: Option<&'s MotionReference>,
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
            reference: None,
        })
    }

    /// The networks with the misfit that `reference` knows of put right: a robot that turns two degrees less than its
    /// network says does so in every step and every run, which no zero-mean scatter stands for.
    pub fn corrected(self, reference: Option<&'s MotionReference>) -> Self {
        MotionNetworks { reference, ..self }
    }

    /// What a step does for left, right, previous left and previous right command.
    pub fn step(&self, speeds: [f32; 4]) -> Motion {
        let context = motion_context(&speeds);
        let ask = |learned: &Learned<4>| (learned.network.evaluate(speeds), learned.spread.cell(context));
        let (forward_cm, forward_cell) = ask(self.forward);
        let (lateral_cm, lateral_cell) = ask(self.lateral);
        let (turn_deg, turn_cell) = ask(self.turn);
        let cells = [forward_cell, lateral_cell, turn_cell];
        let correction = self.reference.map_or([0.0; 3], |r| r.correction(&speeds.map(f64::from)));
        Motion {
            forward_cm: forward_cm + correction[0] as f32,
            lateral_cm: lateral_cm + correction[1] as f32,
            turn_rad: turn_deg.to_radians() + correction[2] as f32,
            cells,
        }
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

    /// Adds to a motion what the robot itself adds: for each network one of the residuals drawn for this step, and one
    /// drawn when the command began.
    pub fn scatter(&self, motion: &Motion, step: [usize; 3], held: [usize; 3]) -> Motion {
        let residual = |spread: &Spread, i: usize| {
            let cell = motion.cells[i];
            let (residuals, shares) = (&spread.residuals[cell], spread.shares[cell]);
            shares.step * residuals[step[i]] + shares.held * residuals[held[i]]
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
