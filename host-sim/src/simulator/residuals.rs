//! Residual noise about a network: the paper's simulators leave all of it out but the failing echoes.

use serde::{Deserialize, Serialize};

use crate::statistics::summary::mean;

/// Cells along each of the two context variables.
pub const CELLS: usize = 4;
/// Equally likely residuals that stand for a cell.
pub const LEVELS: usize = 32;

/// Of a residual at least this fraction is the robot's, where the tracker seems to make all of it.
const LEAST_SHARE: f64 = 0.2;

/// Residuals of a network by context: turning and driving command for motion, D and α for the sonar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualQuantiles {
    /// Inner borders of the cells along the two context variables, ascending.
    pub edges: [[f32; CELLS - 1]; 2],
    /// [`LEVELS`] residuals a cell, ascending; cell (i, j) is entry i · [`CELLS`] + j.
    #[serde(rename = "residuals")]
    pub quantiles: Vec<Vec<f32>>,
    /// What of a residual a simulated robot has, one entry a cell.
    #[serde(rename = "shares")]
    pub components: Vec<VarianceComponents>,
}

/// Components of a residual, as fractions of its standard deviation: their squares add up to one at most. The rest is
/// the tracker's error, which a simulated robot does not have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VarianceComponents {
    /// Drawn anew in each step.
    pub step: f32,
    /// Lasts as long as a command is held: a network's misfit there, or a matter of the place.
    pub held: f32,
}

/// Residuals multiplied by their components' fractions, so that a step looks them up and adds.
#[derive(Clone, Debug)]
pub struct ResidualNoise {
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

impl VarianceComponents {
    /// All of a residual is drawn anew in each step.
    pub const STEP: VarianceComponents = VarianceComponents { step: 1.0, held: 0.0 };

    fn is_sound(&self) -> bool {
        [self.step, self.held].iter().all(|share| (0.0..=1.0).contains(share))
    }
}

impl ResidualQuantiles {
    /// One of the [`LEVELS`] equally likely residuals of a context.
    pub fn residual(&self, context: [f32; 2], level: usize) -> f32 {
        self.quantiles[self.cell(context)][level]
    }

    /// The cell of a context.
    pub fn cell(&self, context: [f32; 2]) -> usize {
        let place = |i: usize| self.edges[i].iter().filter(|edge| context[i] >= **edge).count();
        place(0) * CELLS + place(1)
    }

    /// The variance of what a robot adds in a step drawn anew, in a context.
    pub fn process_variance(&self, context: [f32; 2]) -> f64 {
        let cell = self.cell(context);
        let share = f64::from(self.components[cell].step).max(LEAST_SHARE);
        share * share * self.variance(cell)
    }

    /// The variance of the tracker's error in one pose: half of what is neither the step's nor the held command's.
    pub fn tracker_variance(&self) -> f64 {
        let of_cell = |cell: usize| {
            let VarianceComponents { step, held } = self.components[cell];
            f64::from((1.0 - step * step - held * held).max(0.0)) * self.variance(cell) / 2.0
        };
        mean((0..CELLS * CELLS).map(of_cell))
    }

    fn variance(&self, cell: usize) -> f64 {
        mean(self.quantiles[cell].iter().map(|residual| f64::from(residual * residual)))
    }

    /// Whether a file could have held this.
    pub fn is_sound(&self) -> bool {
        let finite = |values: &[f32]| values.iter().all(|v| v.is_finite());
        self.edges.iter().all(|e| finite(e))
            && self.components.len() == CELLS * CELLS
            && self.components.iter().all(VarianceComponents::is_sound)
            && self.quantiles.len() == CELLS * CELLS
            && self.quantiles.iter().all(|r| r.len() == LEVELS && finite(r))
    }
}

impl ResidualNoise {
    /// Of residuals that are sound.
    pub fn new(residuals: &ResidualQuantiles) -> Self {
        let times = |share: fn(&VarianceComponents) -> f32| -> [[f32; LEVELS]; CELLS * CELLS] {
            std::array::from_fn(|cell| {
                std::array::from_fn(|l| share(&residuals.components[cell]) * residuals.quantiles[cell][l])
            })
        };
        ResidualNoise { step: times(|s| s.step), held: times(|s| s.held) }
    }

    /// The same in another unit.
    pub fn times(mut self, factor: f32) -> Self {
        self.step.iter_mut().chain(&mut self.held).flatten().for_each(|residual| *residual *= factor);
        self
    }

    /// The same where what lasts while a command is held is so many times what a step adds.
    pub fn with_lasting(self, share: f32) -> Self {
        ResidualNoise { held: self.step.map(|cell| cell.map(|residual| share * residual)), ..self }
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
