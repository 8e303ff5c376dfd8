//! Steps that were asked for before: runs of one controller ask for the same ones, and so do effects that change commands as
//! time passes, at the same time of each run.

use std::collections::HashMap;

use super::motion::{Motion, MotionNetworks, MotionVector, Speeds, whole};

/// [Steps as they were known in training](MotionNetworks::trained_step), each asked of the networks once.
pub(super) struct KnownSteps<'a> {
    networks: &'a MotionNetworks<'a>,
    motions: HashMap<[u32; 4], Motion>,
    beyond: HashMap<[i16; 2], MotionVector>,
}

/// Some four megabytes, whatever is asked.
const MOST: usize = 1 << 16;

impl<'a> KnownSteps<'a> {
    /// None of them.
    pub fn new(networks: &'a MotionNetworks<'a>) -> Self {
        KnownSteps { networks, motions: HashMap::new(), beyond: HashMap::new() }
    }

    /// What a step does.
    pub fn step(&mut self, speeds: Speeds<f32>) -> Motion {
        if self.motions.len() == MOST {
            self.motions.clear();
        }
        *self.motions.entry(speeds.map(f32::to_bits)).or_insert_with(|| {
            let command = whole([speeds[0], speeds[1]]);
            let beyond = self.beyond.entry(command).or_insert_with(|| self.networks.trained_beyond(command));
            self.networks.step(speeds).plus(beyond)
        })
    }
}
