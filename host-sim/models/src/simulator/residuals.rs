//! Residual noise about a network: the paper's simulators leave all of it out but the failing echoes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Cells along each of the two context variables.
pub const CELLS: usize = 4;
/// Equally likely residuals that stand for a cell.
pub const LEVELS: usize = 32;

/// The upper half of as many equally likely values of a normal distribution, with a standard deviation of one.
const NORMAL: [f32; LEVELS / 2] = [
    0.03996, 0.120126, 0.201043, 0.283247, 0.367335, 0.454002, 0.544082, 0.638626, 0.739011, 0.847128, 0.965725,
    1.099075, 1.254466, 1.446165, 1.709472, 2.19697,
];

/// Residuals of a network by context: turning and driving command for motion, D and α for the sonar.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ResidualQuantiles {
    /// Inner borders of the cells along the two context variables, ascending.
    pub edges: [[f32; CELLS - 1]; 2],
    /// Equally likely residuals of each cell, ascending; cell (i, j) is entry i · n + j, where n is the number of cells along an
    /// axis.
    #[serde(rename = "residuals")]
    pub quantiles: Vec<Vec<f32>>,
    /// Share of a residual that a simulated robot has, one entry per cell.
    #[serde(rename = "shares")]
    pub components: Vec<VarianceComponents>,
}

/// Components of a residual, as fractions of its standard deviation: their squares add up to one at most. The rest is
/// the tracker's error, which a simulated robot does not have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VarianceComponents {
    /// Drawn independently in each step.
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConstantReading {
    /// The reading, cm.
    pub value_cm: f32,
    /// Probability that a reading is this one.
    pub probability: f32,
}

impl VarianceComponents {
    /// All of a residual is drawn independently in each step.
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

    /// Returns whether all numbers are possible.
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

    /// Normal residuals with a standard deviation of one in every cell.
    pub fn normal() -> Self {
        let level = |level: usize| match level.checked_sub(LEVELS / 2) {
            Some(above) => NORMAL[above],
            None => -NORMAL[LEVELS / 2 - 1 - level],
        };
        let cells = [std::array::from_fn(level); CELLS * CELLS];
        ResidualNoise { step: cells, held: cells }
    }

    /// Returns the noise in a cell: one of the [`LEVELS`] drawn for this step and one drawn when the command began, each times its
    /// factor.
    #[inline(always)]
    pub fn residual(&self, cell: usize, step: usize, held: usize, times: [f32; 2]) -> f32 {
        times[0] * self.step[cell][step] + times[1] * self.held[cell][held]
    }
}

/// Returns the context of a motion network: how much the commands turn the robot, and how much they drive it forward. Tyres slip
/// more in a turn than on the straight.
pub fn motion_context(speeds: &[f32; 4]) -> [f32; 2] {
    let [left, right, ..] = *speeds;
    [0.5 * (right - left).abs(), 0.5 * (right + left).abs()]
}
