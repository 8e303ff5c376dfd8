//! Tournament selection: the fittest of several individuals drawn without replacement wins.

use rand::RngExt;

use mindgap_foundations::random::Generator;

/// Returns the indices of individuals from the fittest to the least fit; NaN comes last, and ties keep their order.
pub fn ranking(fitness: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..fitness.len()).collect();
    let key = |i: &usize| if fitness[*i].is_nan() { f64::NEG_INFINITY } else { fitness[*i] };
    order.sort_by(|a, b| key(b).total_cmp(&key(a)));
    order
}

/// Tournaments within a population.
pub struct Tournament<'a> {
    ranking: &'a [usize],
    places: Vec<u32>,
}

impl<'a> Tournament<'a> {
    /// Tournaments among the individuals of a [`ranking`].
    pub fn new(ranking: &'a [usize]) -> Self {
        Tournament { ranking, places: (0..ranking.len() as u32).collect() }
    }

    /// Returns the index of the fittest of `size` different individuals; `size` is clamped to one and the population.
    pub fn winner(&mut self, size: usize, rng: &mut Generator) -> usize {
        let total = self.places.len() as u32;
        let mut best = total - 1;
        for drawn in 0..size.clamp(1, self.places.len()) as u32 {
            let other = rng.random_range(drawn..total);
            self.places.swap(drawn as usize, other as usize);
            best = best.min(self.places[drawn as usize]);
        }
        self.ranking[best as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::random::generator;

    /// Drawn without replacement, the individual of rank r (from 0) wins with probability C(n-1-r, k-1) / C(n, k).
    #[test]
    fn win_rates_are_those_of_draws_without_replacement() {
        let fitness: Vec<f64> = (0..10).map(f64::from).collect();
        let ranking = ranking(&fitness);
        let mut arena = Tournament::new(&ranking);
        let mut rng = generator(2, &[]);
        let mut wins = [0u32; 10];
        for _ in 0..50_000 {
            wins[arena.winner(3, &mut rng)] += 1;
        }
        for rank in 0..10u32 {
            let left = f64::from(9 - rank);
            let expected = left * (left - 1.0) / 2.0 / 120.0;
            let seen = f64::from(wins[9 - rank as usize]) / 50_000.0;
            assert!((seen - expected).abs() < 0.01, "rank {rank}: {seen} against {expected}");
        }
    }

    #[test]
    fn tournament_of_all_is_won_by_the_best_and_of_one_by_anyone() {
        let ranking = ranking(&[1.0, 7.0, 3.0]);
        let mut arena = Tournament::new(&ranking);
        let mut rng = generator(3, &[]);
        assert!((0..50).all(|_| arena.winner(3, &mut rng) == 1 && arena.winner(99, &mut rng) == 1));
        let seen: std::collections::BTreeSet<usize> = (0..200).map(|_| arena.winner(1, &mut rng)).collect();
        assert_eq!(seen.len(), 3);
    }

    #[test]
    fn nan_ranks_last_and_equals_keep_their_order() {
        assert_eq!(ranking(&[f64::NAN, 1.0, 2.0, 2.0, f64::NEG_INFINITY]), [2, 3, 1, 0, 4]);
    }
}
