//! The stagnation criterion: under 0.1 % improvement of the fittest over 300 generations (paper, section VII).

/// Ends a run when the best fitness has grown too little over a number of generations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StagnationCriterion {
    /// Number of generations over which growth is measured (paper: 300).
    pub generations: usize,
    /// Least relative growth of the best fitness over them (paper: 0.001).
    pub improvement: f64,
}

impl Default for StagnationCriterion {
    fn default() -> Self {
        StagnationCriterion { generations: 300, improvement: 0.001 }
    }
}

impl StagnationCriterion {
    /// Returns whether the best fitness, one entry per generation, has stopped growing. Fitness must be positive, as an
    /// inverse error is; an infinite fitness cannot grow.
    pub fn has_stalled(&self, best: &[f64]) -> bool {
        let Some(now) = best.last() else { return false };
        let Some(then) = best.len().checked_sub(self.generations + 1).map(|i| best[i]) else { return false };
        now.is_infinite() || *now < then * (1.0 + self.improvement)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SHORT: StagnationCriterion = StagnationCriterion { generations: 3, improvement: 0.001 };

    #[test]
    fn waits_for_the_whole_period() {
        assert!(!SHORT.has_stalled(&[]));
        assert!(!SHORT.has_stalled(&[1.0; 3]));
        assert!(SHORT.has_stalled(&[1.0; 4]));
    }

    #[test]
    fn exactly_a_tenth_of_a_percent_goes_on() {
        assert!(!SHORT.has_stalled(&[1000.0, 1000.0, 1000.0, 1001.0]));
        assert!(SHORT.has_stalled(&[1000.0, 1000.0, 1000.0, 1000.9]));
    }

    #[test]
    fn perfect_fit_stops() {
        assert!(SHORT.has_stalled(&[1.0, 2.0, 3.0, f64::INFINITY]));
    }

    proptest! {
        #[test]
        fn steady_growth_stops_exactly_when_it_is_too_slow(rate in 0.9990f64..1.0020) {
            let history: Vec<f64> = (0..8).scan(1.0, |f, _| { *f *= rate; Some(*f) }).collect();
            let grown = rate * rate * rate;
            prop_assume!((grown - 1.001).abs() > 1e-9);
            prop_assert_eq!(SHORT.has_stalled(&history), grown < 1.001);
        }
    }
}
