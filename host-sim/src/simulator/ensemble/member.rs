//! One robot of a distribution over robots.

use rand_distr::{Distribution, StandardNormal};

use super::basis::weights;
use crate::chance::generator;

/// What one robot does beyond the networks, the same in all its runs. Channels are forward (cm), lateral (cm) and turn
/// (degrees), of one step.
#[derive(Clone, Debug)]
pub struct Member {
    nodes: [Vec<f64>; 3],
    first_step: [f64; 3],
    seed: u64,
}

impl Member {
    /// The robot with these biases of the nodes; `seed` fixes what its first steps do, with standard deviations
    /// `first_step`.
    pub(super) fn new(nodes: [Vec<f64>; 3], first_step: [f64; 3], seed: u64) -> Self {
        Member { nodes, first_step, seed }
    }

    /// Its bias in every step of a command that is held.
    pub fn bias(&self, command: [f64; 2]) -> [f64; 3] {
        let weights = weights(command);
        self.nodes.each_ref().map(|nodes| weights.iter().map(|(node, weight)| nodes[*node] * weight).sum())
    }

    /// What the first step of a command after another one does beyond that.
    pub fn first_step(&self, command: [i8; 2], before: [i8; 2]) -> [f64; 3] {
        let key = [command[0], command[1], before[0], before[1]].map(|c| c as u8);
        let mut rng = generator(self.seed, &[u64::from(u32::from_le_bytes(key))]);
        self.first_step.map(|deviation| deviation * Distribution::<f64>::sample(&StandardNormal, &mut rng))
    }
}
