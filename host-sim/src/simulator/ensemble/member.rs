//! One robot of a distribution over robots.

use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};

use super::basis::weights;
use crate::chance::generator;

/// What one robot does, the same in all its runs. Channels are forward (cm), lateral (cm) and turn
/// (degrees), of one step.
#[derive(Clone, Debug)]
pub struct Member {
    nodes: [Vec<f64>; 3],
    /// What was known of it in training; none where that is all that is known.
    trained: Option<Arc<Member>>,
    first_step: [f64; 3],
    lasting: [f64; 3],
    seed: u64,
}

impl Member {
    /// The robot with these motions of the nodes; `seed` fixes what its first steps do, with standard deviations
    /// `first_step`.
    pub(super) fn new(nodes: [Vec<f64>; 3], first_step: [f64; 3], lasting: [f64; 3], seed: u64) -> Self {
        Member { nodes, trained: None, first_step, lasting, seed }
    }

    /// The same one, of which this was known in training.
    pub(super) fn known_as(self, trained: &Arc<Member>) -> Self {
        Member { trained: Some(trained.clone()), ..self }
    }

    /// Its motion in every step of a command that is held, but for chance.
    pub fn motion(&self, command: [f64; 2]) -> [f64; 3] {
        let weights = weights(command);
        self.nodes.each_ref().map(|nodes| weights.iter().map(|(node, weight)| nodes[*node] * weight).sum())
    }

    /// The same of the robot in the middle of what training logs say: effects act on that, and what runs tell of this one
    /// since then comes on top.
    pub fn trained(&self, command: [f64; 2]) -> [f64; 3] {
        self.trained.as_deref().unwrap_or(self).motion(command)
    }

    /// What the first step of a command after another one does beyond what networks say of that.
    pub fn first_step(&self, command: [i8; 2], before: [i8; 2]) -> [f64; 3] {
        let key = [command[0], command[1], before[0], before[1]].map(|c| c as u8);
        let mut rng = generator(self.seed, &[u64::from(u32::from_le_bytes(key))]);
        self.first_step.map(|deviation| deviation * Distribution::<f64>::sample(&StandardNormal, &mut rng))
    }

    /// Of chance: the standard deviation of what lasts while a command is held, as a share of what a step adds.
    pub fn lasting(&self) -> [f64; 3] {
        self.lasting
    }
}
