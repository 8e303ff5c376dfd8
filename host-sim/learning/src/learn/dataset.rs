//! Training and evaluation data of the five networks (paper, section VI).

use std::ops::RangeInclusive;

use super::drive_filter;
use mindgap_logs::{Logs, samples};
use mindgap_models::effects::drive_filter::DriveFilter;

/// Samples for one network with `N` inputs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dataset<const N: usize> {
    /// The inputs, in the units of the logs.
    pub inputs: Vec<[f32; N]>,
    /// The target outputs, one per sample.
    pub targets: Vec<f32>,
    /// The index of the run that each sample comes from.
    pub runs: Vec<usize>,
}

/// The data sets of the five networks.
#[derive(Clone, Debug, PartialEq)]
pub struct Datasets {
    /// From left, right, previous left and previous right command to the turn in a step, degrees.
    pub turn: Dataset<4>,
    /// From the same to the displacement forward, cm.
    pub forward: Dataset<4>,
    /// From the same to the displacement to the left, cm.
    pub lateral: Dataset<4>,
    /// From D (cm) and α (degrees) to 1 if the sensor produced a value, else 0.
    pub echo_probability: Dataset<2>,
    /// From D and α to the reading, cm, of those samples that have one.
    pub echo_value: Dataset<2>,
}

impl Datasets {
    /// Extracts the samples from logs.
    pub fn from_logs(logs: &Logs) -> Self {
        Datasets::behind(DriveFilter::default(), logs)
    }

    /// Extracts the samples from logs, with commands as they come out of a filter.
    pub fn behind(filter: DriveFilter, logs: &Logs) -> Self {
        let [mut turn, mut forward, mut lateral] = std::array::from_fn(|_| Dataset::default());
        for step in drive_filter::steps(filter, logs) {
            let inputs = step.speeds.map(|v| v as f32);
            turn.push(inputs, step.turn_rad.to_degrees() as f32, step.run);
            forward.push(inputs, step.forward_cm as f32, step.run);
            lateral.push(inputs, step.lateral_cm as f32, step.run);
        }
        let mut echo_probability = Dataset::default();
        let mut echo_value = Dataset::default();
        for sample in samples::readings(logs) {
            let inputs = [sample.distance_cm as f32, sample.alpha_deg() as f32];
            echo_probability.push(inputs, f32::from(u8::from(sample.echo_cm.is_some())), sample.run);
            if let Some(echo_cm) = sample.echo_cm {
                echo_value.push(inputs, echo_cm as f32, sample.run);
            }
        }
        Datasets { turn, forward, lateral, echo_probability, echo_value }
    }
}

impl<const N: usize> Dataset<N> {
    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.targets.len()
    }

    /// Returns whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty()
    }

    /// Adds a sample.
    pub fn push(&mut self, inputs: [f32; N], target: f32, run: usize) {
        self.inputs.push(inputs);
        self.targets.push(target);
        self.runs.push(run);
    }

    /// Returns the samples of the runs whose index satisfies `keep`.
    pub fn of_runs(&self, keep: impl Fn(usize) -> bool) -> Self {
        let mut kept = Dataset::default();
        for ((inputs, target), run) in self.inputs.iter().zip(&self.targets).zip(&self.runs) {
            if keep(*run) {
                kept.push(*inputs, *target, *run);
            }
        }
        kept
    }

    /// Returns the least and largest value of each input.
    pub fn ranges(&self) -> [RangeInclusive<f32>; N] {
        std::array::from_fn(|i| range(self.inputs.iter().map(|x| x[i])))
    }

    /// Returns the least and largest target.
    pub fn target_range(&self) -> RangeInclusive<f32> {
        range(self.targets.iter().copied())
    }
}

fn range(values: impl Iterator<Item = f32>) -> RangeInclusive<f32> {
    let (low, high) = values.fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    low..=high
}
