//! A cache of predicted steps: all runs of a controller need the same ones, and so do effects that change commands over time,
//! at the same time of each run.

use std::collections::HashMap;

use super::motion::{MotionNetworks, PredictedStep, Speeds};

/// [Steps as training knew them](MotionNetworks::trained_step), cached.
pub(super) struct KnownSteps<'a> {
    networks: &'a MotionNetworks<'a>,
    steps: HashMap<[u32; 4], PredictedStep>,
}

/// Entries that take some four megabytes.
const CAPACITY: usize = 1 << 16;

impl<'a> KnownSteps<'a> {
    /// Returns an empty cache.
    pub fn new(networks: &'a MotionNetworks<'a>) -> Self {
        KnownSteps { networks, steps: HashMap::new() }
    }

    /// Predicts a step.
    pub fn step(&mut self, speeds: Speeds<f32>) -> PredictedStep {
        if self.steps.len() == CAPACITY {
            self.steps.clear();
        }
        *self.steps.entry(speeds.map(f32::to_bits)).or_insert_with(|| self.networks.trained_step(speeds))
    }
}
