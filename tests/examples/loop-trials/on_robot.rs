//! Evolution on the robot itself instead of a simulator, with thousands of runs: an upper bound on what any procedure can find.

use mindgap_core::controller::Controller;
use mindgap_foundations::random::generator;
use mindgap_learning::evolve::genome::GenotypeDecoder;
use mindgap_learning::genetic::mutation::{Mutation, Unit};
use mindgap_models::simulator::rollout::REACHED_CM;
use rand::RngExt;

use crate::cases::Case;

const GENERATIONS: u64 = 40;
/// Controllers that a generation keeps, and mutants of them that it tries.
const KEPT: usize = 8;
const MUTANTS: usize = 30;
/// Runs of each controller in each generation. Controllers that stay are driven again, which averages out luck.
const RUNS: u64 = 10;
/// Probability that a gene of a mutant differs, and the standard deviations of the differences.
const PROBABILITY: f64 = 0.15;
const DEVIATIONS: [f32; 3] = [0.01, 0.03, 0.08];
/// Number of the first run. No other procedure drives these runs.
const FIRST: u64 = 1_000_000;

/// Score of a run that comes near the target, relative to one that reaches it.
const NEARNESS: f64 = 0.1;

/// A controller, the number of its runs, and their score.
struct Driven {
    genes: Vec<f32>,
    runs: u64,
    worth: f64,
}

/// Returns the best controller that selection on the robot makes of these, and the number of runs.
pub fn evolved(case: &Case, decoder: &GenotypeDecoder, from: &[Controller], seed: u64) -> (Controller, usize) {
    let mut rng = generator(seed, &[]);
    let driven = |genes: Vec<f32>| Driven { genes, runs: 0, worth: 0.0 };
    let mut kept: Vec<Driven> = from.iter().map(|controller| driven(decoder.genes(controller))).collect();
    let mut runs = 0;
    for generation in 0..GENERATIONS {
        let mutants: Vec<Vec<f32>> = (0..MUTANTS)
            .map(|_| {
                let mut genes = kept[rng.random_range(0..kept.len())].genes.clone();
                let deviation = DEVIATIONS[rng.random_range(0..DEVIATIONS.len())];
                Mutation { probability: PROBABILITY, unit: Unit::Gene, deviation }.apply(&mut genes, &mut rng);
                decoder.repair(&mut genes);
                genes
            })
            .collect();
        kept.extend(mutants.into_iter().map(driven));
        let first = FIRST + generation * RUNS;
        for one in &mut kept {
            let controller = decoder.controller(&one.genes);
            let worth = |run: u64| {
                let missed_cm = case.missed_cm(&case.drive(&controller, run));
                if missed_cm <= REACHED_CM { 1.0 } else { NEARNESS * REACHED_CM / missed_cm }
            };
            one.worth += (first..first + RUNS).map(worth).sum::<f64>();
            one.runs += RUNS;
            runs += RUNS as usize;
        }
        kept.sort_by(|a, b| b.expected().total_cmp(&a.expected()));
        kept.truncate(KEPT);
    }
    (decoder.controller(&kept[0].genes), runs)
}

impl Driven {
    /// Returns the expected score of a run, by Laplace's rule of succession.
    fn expected(&self) -> f64 {
        (self.worth + 1.0) / (self.runs + 2) as f64
    }
}
