//! Steps that were asked for before: runs of one controller ask for the same ones, and so do effects that change commands as
//! time passes, at the same time of each run.

use std::collections::HashMap;

use super::motion::{Motion, MotionNetworks, Speeds};

/// [Steps as they were known in training](MotionNetworks::trained_step), remembered.
pub(super) struct KnownSteps<'a> {
    networks: &'a MotionNetworks<'a>,
    motions: HashMap<[u32; 4], Motion>,
}

/// Some four megabytes, whatever is asked.
const MOST: usize = 1 << 16;

impl<'a> KnownSteps<'a> {
    /// None of them.
    pub fn new(networks: &'a MotionNetworks<'a>) -> Self {
        KnownSteps { networks, motions: HashMap::new() }
    }

    /// What a step does.
    pub fn step(&mut self, speeds: Speeds<f32>) -> Motion {
        if self.motions.len() == MOST {
            self.motions.clear();
        }
        *self.motions.entry(speeds.map(f32::to_bits)).or_insert_with(|| self.networks.trained_step(speeds))
    }
}
