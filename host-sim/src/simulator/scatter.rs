//! How reality scatters about a network: what the paper's simulators leave out beyond the firing of the sensor.

use serde::{Deserialize, Serialize};

/// Cells along each of the two context variables.
pub const CELLS: usize = 4;
/// Equally likely residuals that stand for a cell.
pub const LEVELS: usize = 32;

/// Residuals of a network by context: turning and driving command for motion, D and α for the sonar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Inner borders of the cells along the two context variables, ascending.
    pub edges: [[f32; CELLS - 1]; 2],
    /// [`LEVELS`] residuals a cell, ascending; cell (i, j) is entry i · [`CELLS`] + j.
    pub residuals: Vec<Vec<f32>>,
    /// What of a residual a simulated robot has, one entry a cell.
    pub shares: Vec<Shares>,
}

/// What a residual's size is made of, as shares of it whose squares add up to one at most. What is missing is the
/// tracker's error, which a simulated robot has none of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shares {
    /// Drawn anew in each step.
    pub step: f32,
    /// Lasts as long as a command is held: a network's misfit there, or a matter of the place.
    pub held: f32,
}

/// A spread's residuals multiplied by their shares, so that a step looks them up and adds.
#[derive(Clone, Debug)]
pub struct Scatter {
    step: [[f32; LEVELS]; CELLS * CELLS],
    held: [[f32; LEVELS]; CELLS * CELLS],
}

/// A wrong reading that the sensor produces now and then wherever it looks ("roughly 20cm", paper, section VIII).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstantReading {
    /// The reading, cm.
    pub value_cm: f32,
    /// The chance that a reading is this one.
    pub probability: f32,
}

impl Shares {
    /// All of a residual is drawn anew in each step.
    pub const STEP: Shares = Shares { step: 1.0, held: 0.0 };

    fn is_sound(&self) -> bool {
        [self.step, self.held].iter().all(|share| (0.0..=1.0).contains(share))
    }
}

impl Spread {
    /// One of the [`LEVELS`] equally likely residuals of a context.
    pub fn residual(&self, context: [f32; 2], level: usize) -> f32 {
        self.residuals[self.cell(context)][level]
    }

    /// The cell of a context.
    pub fn cell(&self, context: [f32; 2]) -> usize {
        let place = |i: usize| self.edges[i].iter().filter(|edge| context[i] >= **edge).count();
        place(0) * CELLS + place(1)
    }

    /// Whether a file could have held this.
    pub fn is_sound(&self) -> bool {
        let finite = |values: &[f32]| values.iter().all(|v| v.is_finite());
        self.edges.iter().all(|e| finite(e))
            && self.shares.len() == CELLS * CELLS
            && self.shares.iter().all(Shares::is_sound)
            && self.residuals.len() == CELLS * CELLS
            && self.residuals.iter().all(|r| r.len() == LEVELS && finite(r))
    }
}

impl Scatter {
    /// Of a spread that is sound.
    pub fn new(spread: &Spread) -> Self {
        let times = |share: fn(&Shares) -> f32| -> [[f32; LEVELS]; CELLS * CELLS] {
            std::array::from_fn(|cell| std::array::from_fn(|l| share(&spread.shares[cell]) * spread.residuals[cell][l]))
        };
        Scatter { step: times(|s| s.step), held: times(|s| s.held) }
    }

    /// The same in another unit.
    pub fn times(mut self, factor: f32) -> Self {
        self.step.iter_mut().chain(&mut self.held).flatten().for_each(|residual| *residual *= factor);
        self
    }

    /// What a robot adds in a cell: one of the [`LEVELS`] drawn for this step, and one drawn when the command began.
    #[inline(always)]
    pub fn residual(&self, cell: usize, step: usize, held: usize) -> f32 {
        self.step[cell][step] + self.held[cell][held]
    }
}

/// The context of a motion network: how much the commands turn the robot, and how much they drive it on. Tyres slip
/// more in a turn than on the straight.
pub fn motion_context(speeds: &[f32; 4]) -> [f32; 2] {
    let [left, right, ..] = *speeds;
    [0.5 * (right - left).abs(), 0.5 * (right + left).abs()]
}
