//! One robot of a distribution over robots.

use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};

use super::basis::weights;
use super::evidence::cell;
use super::nugget::Nuggets;
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_foundations::random::generator;

/// What one robot does, the same in all its runs.
#[derive(Clone, Debug)]
pub struct Member {
    nodes: Motion<Vec<f64>>,
    nuggets: Arc<Nuggets>,
    /// Seeds its nuggets; none for the mean robot.
    drawn: Option<u64>,
    /// What training knew of it; none where nothing more is known.
    trained: Option<Arc<Member>>,
}

impl Member {
    /// Returns the robot with these motions of the nodes.
    pub(super) fn new(nodes: Motion<Vec<f64>>, nuggets: Arc<Nuggets>, drawn: Option<u64>) -> Self {
        Member { nodes, nuggets, drawn, trained: None }
    }

    /// Returns the robot with what training knew of it.
    pub(super) fn known_as(self, trained: &Arc<Member>) -> Self {
        Member { trained: Some(trained.clone()), ..self }
    }

    /// Returns its motion in every step of a held command, without noise.
    pub fn motion(&self, command: [f64; 2]) -> Motion<f64> {
        let drawn = self.drawn.map_or(Motion::ZERO, |seed| normals(seed, cell(self.nuggets.scale.percent(command))));
        let [process, nugget, deviation] = self.parts(command);
        process + nugget + drawn.zip_with(deviation, |drawn, deviation| drawn * deviation)
    }

    /// Returns that motion for the mean robot of the training logs: effects act on it, and what later runs say of this robot is
    /// added.
    pub fn trained(&self, command: [f64; 2]) -> Motion<f64> {
        self.trained.as_deref().unwrap_or(self).motion(command)
    }

    /// Returns what the first step of a command after another one does beyond the networks' prediction.
    pub fn first_step(&self, command: [i8; 2], before: [i8; 2]) -> Motion<f64> {
        let Some(seed) = self.drawn else { return Motion::ZERO };
        let pair = [command, before].map(|[left, right]| i32::from(left) << 8 | i32::from(right) & 0xff);
        self.nuggets
            .noise
            .first_step
            .zip_with(normals(seed ^ FIRST_STEPS, pair), |deviation, normal| deviation * normal)
    }

    /// Returns the standard deviations of the noise under a command: per step, and for as long as it is held. For the mean
    /// robot the latter is what is not known of the command.
    pub fn scatter(&self, command: [f64; 2]) -> Motion<[f64; 2]> {
        let [process, nugget, deviation] = self.parts(command);
        let motion = process + nugget;
        Motion::from_fn(|axis| {
            let step = self.nuggets.noise.step_variance(motion, axis).sqrt();
            [step, if self.drawn.is_some() { 0.0 } else { deviation[axis] }]
        })
    }

    /// Returns the smooth process at a command, the mean of the nugget, and its standard deviation.
    fn parts(&self, command: [f64; 2]) -> [Motion<f64>; 3] {
        let command = self.nuggets.scale.percent(command);
        let place = weights(command);
        let process = Motion::from_fn(|axis| self.process(&place, axis));
        let known = self.nuggets.known(command, process);
        let mean = Motion::from_fn(|axis| {
            let of = &known[axis];
            of.share * (of.motion - self.process(of.place, axis))
        });
        [process, mean, known.map(|of| of.deviation)]
    }

    /// Returns the smooth process at a place.
    fn process(&self, weights: &[(usize, f64)], axis: Axis) -> f64 {
        weights.iter().map(|(node, weight)| self.nodes[axis][*node] * weight).sum()
    }
}

/// Separates the draws of first steps from those of commands.
const FIRST_STEPS: u64 = 1 << 63;

/// Draws a robot's normal numbers, always the same for one key.
fn normals(seed: u64, key: [i32; 2]) -> Motion<f64> {
    let mut rng = generator(seed, &key.map(|part| u64::from(part as u32)));
    Motion::from_fn(|_| Distribution::<f64>::sample(&StandardNormal, &mut rng))
}
