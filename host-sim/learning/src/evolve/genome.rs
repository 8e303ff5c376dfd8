//! Direct encoding of controllers: "the different tuples of the controllers were directly encoded" (paper, section IX).

use mindgap_core::controller::{Controller, MAX_THRESHOLD_CM, TUPLES, Tuple, When};
use rand::RngExt;

use mindgap_foundations::random::Generator;
use mindgap_models::simulator::Simulator;

/// Number of genes per tuple: left, right, larger or smaller, threshold.
const GENES_PER_TUPLE: usize = 4;

/// Decodes genotypes into controllers. Every gene runs from 0 to 1 over its range, so that one mutation step suits all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GenotypeDecoder {
    /// Least and largest motor command, those of the training logs.
    pub commands: [f32; 2],
    /// Least and largest threshold, cm: the range of the sensor.
    pub thresholds_cm: [f32; 2],
    /// Duration of a step, ms.
    pub step_ms: u16,
    /// Maximum number of steps of a run, since a threshold may never be met.
    pub max_steps: u16,
}

impl GenotypeDecoder {
    /// Number of genes of a controller.
    pub const GENES: usize = TUPLES * GENES_PER_TUPLE;

    /// Returns the decoder for a simulator's robot.
    pub fn new(simulator: &Simulator, max_steps: u16) -> Self {
        let [min_cm, max_cm] = simulator.robot.ultrasonic.map_or([0.0; 2], |sensor| sensor.range_cm());
        GenotypeDecoder {
            commands: simulator.commands,
            thresholds_cm: [min_cm as f32, (max_cm as f32).min(f32::from(MAX_THRESHOLD_CM))],
            step_ms: simulator.robot.step_ms.round() as u16,
            max_steps,
        }
    }

    /// Returns a random genotype: [`Self::GENES`] uniform genes.
    pub fn random(&self, rng: &mut Generator) -> Vec<f32> {
        (0..Self::GENES).map(|_| rng.random()).collect()
    }

    /// Clamps genes to 0..=1.
    pub fn repair(&self, genes: &mut [f32]) {
        genes.iter_mut().for_each(|gene| *gene = gene.clamp(0.0, 1.0));
    }

    /// Returns the controller that a genotype encodes; commands and thresholds are rounded to integers, as a brick takes
    /// them.
    pub fn controller(&self, genes: &[f32]) -> Controller {
        let within = |[low, high]: [f32; 2], gene: f32| (low + gene * (high - low)).round();
        let tuple = |g: &[f32]| Tuple {
            left: within(self.commands, g[0]) as i8,
            right: within(self.commands, g[1]) as i8,
            when: if g[2] < 0.5 { When::Smaller } else { When::Larger },
            threshold_cm: within(self.thresholds_cm, g[3]) as i16,
        };
        self.with_tuples(std::array::from_fn(|t| tuple(&genes[t * GENES_PER_TUPLE..])))
    }

    /// Returns the controller with these tuples.
    pub fn with_tuples(&self, tuples: [Tuple; TUPLES]) -> Controller {
        Controller { step_ms: self.step_ms, max_steps: self.max_steps, tuples }
    }

    /// Returns a genotype that encodes a controller, with values clamped to the ranges.
    pub fn genes(&self, controller: &Controller) -> Vec<f32> {
        let share = |[low, high]: [f32; 2], value: f32| ((value - low) / (high - low)).clamp(0.0, 1.0);
        let of_tuple = |t: &Tuple| {
            let when = if t.when == When::Smaller { 0.25 } else { 0.75 };
            let [left, right] = [t.left, t.right].map(|c| share(self.commands, f32::from(c)));
            [left, right, when, share(self.thresholds_cm, f32::from(t.threshold_cm))]
        };
        controller.tuples.iter().flat_map(of_tuple).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DECODER: GenotypeDecoder =
        GenotypeDecoder { commands: [-70.0, 80.0], thresholds_cm: [4.0, 240.0], step_ms: 400, max_steps: 150 };

    proptest! {
        #[test]
        fn any_genotype_decodes_to_a_controller_within_the_ranges(mut genes in prop::collection::vec(-2f32..3.0, GenotypeDecoder::GENES)) {
            DECODER.repair(&mut genes);
            let controller = DECODER.controller(&genes);
            prop_assert_eq!(controller.check(), Ok(()));
            for t in controller.tuples {
                prop_assert!((-70..=80).contains(&t.left) && (-70..=80).contains(&t.right));
                prop_assert!((4..=240).contains(&t.threshold_cm));
            }
        }
    }

    proptest! {
        #[test]
        fn genes_encode_their_controller(genes in prop::collection::vec(0f32..1.0, GenotypeDecoder::GENES)) {
            let controller = DECODER.controller(&genes);
            prop_assert_eq!(DECODER.controller(&DECODER.genes(&controller)), controller);
        }
    }

    #[test]
    fn genes_are_read_in_the_papers_order() {
        let mut genes = vec![0.0; GenotypeDecoder::GENES];
        genes[4..8].copy_from_slice(&[1.0, 0.0, 0.7, 0.5]);
        let expected = Tuple { left: 80, right: -70, when: When::Larger, threshold_cm: 122 };
        assert_eq!(DECODER.controller(&genes).tuples[1], expected);
    }
}
