//! Rows of logs as a diagnosis uses them: those that explanations are fitted to, and those held out from every fit.
//!
//! The two are different types, so that nothing can be fitted to held-out rows, and no score of a fitted row can be mistaken
//! for a prediction.

use std::ops::Deref;

use super::scores::{Blocks, Scores};
use mindgap_foundations::channel::Channel;
use mindgap_learning::evaluation::observations::{Observation, Observations};
use mindgap_learning::evaluation::predictions::residual;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::simulator::baseline::Baseline;

/// Rows of logs and the simulator that they are compared with.
pub struct Sample<'a> {
    /// The simulator.
    pub baseline: &'a Baseline<'a>,
    observations: Observations,
    row_blocks: Blocks,
}

/// The rows on which effects are identified. Explanations are fitted to them and cross-validated between their blocks.
pub struct Identification<'a> {
    sample: Sample<'a>,
    sketch: Option<Sketch<'a>>,
}

/// Every n-th of many rows, for the first iterations of a fit.
pub struct Sketch<'a> {
    /// These rows.
    pub sample: Sample<'a>,
    /// The n.
    pub every: usize,
}

/// The rows that no explanation is fitted to. They confirm an explanation or refute it.
pub struct HoldOut<'a>(Sample<'a>);

/// Rows on which an explanation is scored: by cross-validation or by prediction.
#[derive(Clone, Copy)]
pub enum RowSet<'r> {
    /// The rows that it was fitted to.
    Fitted(&'r Identification<'r>),
    /// Rows that it predicts.
    HeldOut(&'r HoldOut<'r>),
}

/// A fit begins on at most this many rows, evenly spread; 24 runs of one minute have as many.
const MOST_SKETCHED_ROWS: usize = 1500;

impl<'a> Sample<'a> {
    fn new(baseline: &'a Baseline<'a>, observations: Observations) -> Self {
        Sample { baseline, row_blocks: Blocks::of(&observations), observations }
    }

    /// Returns the block of every row.
    pub fn row_blocks(&self) -> &Blocks {
        &self.row_blocks
    }

    /// Returns scores with one channel of every row, zero in the others.
    pub fn scores_of(&self, channel: Channel, column: &[f64]) -> Scores {
        Scores::zero(&self.row_blocks).with(channel, column)
    }

    /// Returns logged minus predicted motion with these effects: forward (cm), lateral (cm) and turn (rad) of every row.
    pub fn residuals(&self, effects: &EffectChain) -> Vec<Option<[f64; 3]>> {
        self.residuals_of(&self.rows, effects)
    }

    /// Returns the same for some of the rows.
    pub fn residuals_of(&self, rows: &[Observation], effects: &EffectChain) -> Vec<Option<[f64; 3]>> {
        let Some(drive) = &self.baseline.motion else { return vec![None; rows.len()] };
        rows.iter().map(|row| residual(effects, drive, row)).collect()
    }
}

impl<'a> Identification<'a> {
    /// Takes rows for identification, with the simulator that they are compared with.
    pub fn new(baseline: &'a Baseline<'a>, observations: Observations) -> Self {
        let every = observations.rows.len().div_ceil(MOST_SKETCHED_ROWS);
        let sketch = (every > 1).then(|| Sketch { sample: Sample::new(baseline, observations.every(every)), every });
        Identification { sample: Sample::new(baseline, observations), sketch }
    }

    /// Returns some of the rows if there are many.
    pub fn sketch(&self) -> Option<&Sketch<'a>> {
        self.sketch.as_ref()
    }
}

impl<'a> HoldOut<'a> {
    /// Takes rows for confirmation, with the simulator that they are compared with.
    pub fn new(baseline: &'a Baseline<'a>, observations: Observations) -> Self {
        HoldOut(Sample::new(baseline, observations))
    }
}

impl<'r> RowSet<'r> {
    /// Returns the rows, without their role.
    pub fn sample(&self) -> &'r Sample<'r> {
        match self {
            RowSet::Fitted(rows) => rows,
            RowSet::HeldOut(rows) => rows,
        }
    }
}

impl Deref for Sample<'_> {
    type Target = Observations;

    fn deref(&self) -> &Observations {
        &self.observations
    }
}

impl<'a> Deref for Identification<'a> {
    type Target = Sample<'a>;

    fn deref(&self) -> &Sample<'a> {
        &self.sample
    }
}

impl<'a> Deref for HoldOut<'a> {
    type Target = Sample<'a>;

    fn deref(&self) -> &Sample<'a> {
        &self.0
    }
}
