//! Gaussian mutation: "normally distributed random values were added to each component" (paper, section VII).

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use mindgap_foundations::random::Generator;

/// Parameters of Gaussian mutation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mutation {
    /// Probability of a mutation (paper: 0.05).
    pub probability: f64,
    /// What mutates with that probability.
    pub unit: Unit,
    /// Standard deviation of the added noise, in units of the gene (open; 0.1).
    pub deviation: f32,
}

/// What a mutation probability applies to; the paper, section VII, leaves it open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Each gene mutates independently.
    Gene,
    /// An individual mutates as a whole, every gene of it.
    Individual,
}

impl Default for Mutation {
    fn default() -> Self {
        Mutation { probability: 0.05, unit: Unit::Gene, deviation: 0.1 }
    }
}

impl Mutation {
    /// Mutates a child in place.
    pub fn apply(&self, genes: &mut [f32], rng: &mut Generator) {
        let everything = self.unit == Unit::Individual && rng.random_bool(self.probability);
        for gene in genes {
            if everything || (self.unit == Unit::Gene && rng.random_bool(self.probability)) {
                let step: f32 = StandardNormal.sample(rng);
                *gene += self.deviation * step;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::random::generator;

    const CHILDREN: usize = 2000;
    const GENES: usize = 20;

    /// Mutations of zero genes, child by child.
    fn steps(unit: Unit) -> Vec<Vec<f32>> {
        let mut rng = generator(4, &[]);
        let mutation = Mutation { unit, ..Mutation::default() };
        (0..CHILDREN)
            .map(|_| {
                let mut child = vec![0.0; GENES];
                mutation.apply(&mut child, &mut rng);
                child
            })
            .collect()
    }

    #[test]
    fn one_gene_in_twenty_moves_by_a_tenth() {
        let moved: Vec<f32> = steps(Unit::Gene).concat().into_iter().filter(|g| *g != 0.0).collect();
        let share = moved.len() as f32 / (CHILDREN * GENES) as f32;
        assert!((share - 0.05).abs() < 0.005, "{share}");
        let mean = moved.iter().sum::<f32>() / moved.len() as f32;
        let variance = moved.iter().map(|g| (g - mean) * (g - mean)).sum::<f32>() / moved.len() as f32;
        assert!(mean.abs() < 0.01 && (variance.sqrt() - 0.1).abs() < 0.005, "{mean} {variance}");
    }

    #[test]
    fn by_individual_all_genes_move_or_none() {
        let counts: Vec<usize> =
            steps(Unit::Individual).iter().map(|c| c.iter().filter(|g| **g != 0.0).count()).collect();
        assert!(counts.iter().all(|c| *c == 0 || *c == GENES));
        let share = counts.iter().filter(|c| **c > 0).count() as f32 / CHILDREN as f32;
        assert!((share - 0.05).abs() < 0.02, "{share}");
    }
}
