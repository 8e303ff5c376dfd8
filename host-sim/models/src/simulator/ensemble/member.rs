//! One robot of a distribution over robots.

use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};

use super::basis::weights;
use super::evidence::cell;
use super::nugget::Nuggets;
use mindgap_foundations::chance::generator;

/// What one robot does, the same in all its runs. Channels are forward (cm), lateral (cm) and turn
/// (degrees), of one step.
#[derive(Clone, Debug)]
pub struct Member {
    nodes: [Vec<f64>; 3],
    nuggets: Arc<Nuggets>,
    /// Fixes what is its own of each command; none for the robot in the middle.
    drawn: Option<u64>,
    /// What was known of it in training; none where that is all that is known.
    trained: Option<Arc<Member>>,
}

impl Member {
    /// The robot with these motions of the nodes.
    pub(super) fn new(nodes: [Vec<f64>; 3], nuggets: Arc<Nuggets>, drawn: Option<u64>) -> Self {
        Member { nodes, nuggets, drawn, trained: None }
    }

    /// The same one, of which this was known in training.
    pub(super) fn known_as(self, trained: &Arc<Member>) -> Self {
        Member { trained: Some(trained.clone()), ..self }
    }

    /// Its motion in every step of a command that is held, but for chance.
    pub fn motion(&self, command: [f64; 2]) -> [f64; 3] {
        let drawn = self.drawn.map_or([0.0; 3], |seed| normals(seed, cell(self.nuggets.scale.percent(command))));
        let [process, nugget, deviation] = self.parts(command);
        [0, 1, 2].map(|channel| process[channel] + nugget[channel] + drawn[channel] * deviation[channel])
    }

    /// The same of the robot in the middle of what training logs say: effects act on that, and what runs tell of this one
    /// since then comes on top.
    pub fn trained(&self, command: [f64; 2]) -> [f64; 3] {
        self.trained.as_deref().unwrap_or(self).motion(command)
    }

    /// What the first step of a command after another one does beyond what networks say of that.
    pub fn first_step(&self, command: [i8; 2], before: [i8; 2]) -> [f64; 3] {
        let Some(seed) = self.drawn else { return [0.0; 3] };
        let pair = [command, before].map(|[left, right]| i32::from(left) << 8 | i32::from(right) & 0xff);
        let normals = normals(seed ^ FIRST_STEPS, pair);
        [0, 1, 2].map(|channel| self.nuggets.noise.first_step[channel] * normals[channel])
    }

    /// Standard deviations of what chance adds under a command: in a step, and for as long as it is held. For the robot in
    /// the middle that is what is not known of the command.
    pub fn scatter(&self, command: [f64; 2]) -> [[f64; 2]; 3] {
        let [process, nugget, deviation] = self.parts(command);
        let motion = [0, 1, 2].map(|channel| process[channel] + nugget[channel]);
        [0, 1, 2].map(|channel| {
            let step = self.nuggets.noise.step_variance(motion, channel).sqrt();
            [step, if self.drawn.is_some() { 0.0 } else { deviation[channel] }]
        })
    }

    /// What the smooth process says of a command, the mean of what is the command's own, and the standard deviation of that.
    fn parts(&self, command: [f64; 2]) -> [[f64; 3]; 3] {
        let command = self.nuggets.scale.percent(command);
        let process = [0, 1, 2].map(|channel| self.process(&weights(command), channel));
        let known = self.nuggets.known(command, process);
        let mean = [0, 1, 2].map(|channel| {
            let of = &known[channel];
            of.share * (of.motion - self.process(of.place, channel))
        });
        [process, mean, known.map(|of| of.deviation)]
    }

    /// The smooth process in a place.
    fn process(&self, weights: &[(usize, f64)], channel: usize) -> f64 {
        weights.iter().map(|(node, weight)| self.nodes[channel][*node] * weight).sum()
    }
}

/// Sets what first steps draw apart from what commands do.
const FIRST_STEPS: u64 = 1 << 63;

/// Normal numbers that are a robot's, always the same for one key.
fn normals(seed: u64, key: [i32; 2]) -> [f64; 3] {
    let mut rng = generator(seed, &key.map(|part| u64::from(part as u32)));
    [(); 3].map(|()| Distribution::<f64>::sample(&StandardNormal, &mut rng))
}
