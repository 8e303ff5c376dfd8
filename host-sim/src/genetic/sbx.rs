//! Simulated binary crossover (SBX; Deb and Agrawal 1995): children lie about their parents as one-point crossover of
//! bit strings would put them.

use mindgap_core::maths;
use rand::RngExt;

use crate::chance::Generator;

/// Crosses two parents in place, every gene with its own spread and without bounds, as in the original.
pub fn cross(a: &mut [f32], b: &mut [f32], index: f32, rng: &mut Generator) {
    for (a, b) in a.iter_mut().zip(b) {
        (*a, *b) = children(*a, *b, spread(rng.random(), index));
    }
}

/// The spread factor for a uniform draw in [0, 1): below one the children lie between their parents, above one
/// outside. A larger index keeps them nearer to the parents.
pub fn spread(draw: f32, index: f32) -> f32 {
    let base = if draw < 0.5 { 2.0 * draw } else { 0.5 / (1.0 - draw) };
    maths::exp2(maths::log2(base) * (1.0 / (index + 1.0)))
}

/// The two children of one gene; their mean is their parents' mean.
pub fn children(a: f32, b: f32, spread: f32) -> (f32, f32) {
    let (middle, half) = (0.5 * (a + b), 0.5 * spread * (b - a));
    (middle - half, middle + half)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::generator;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_children_keep_their_parents_mean(a in -10f32..10.0, b in -10f32..10.0, draw in 0f32..1.0, index in 1f32..30.0) {
            let (c, d) = children(a, b, spread(draw, index));
            prop_assert!(((c + d) - (a + b)).abs() <= 1e-5 * (1.0 + c.abs() + d.abs()));
        }

        #[test]
        fn the_distance_of_the_children_is_the_spread_times_their_parents(a in -10f32..10.0, b in -10f32..10.0, draw in 0f32..1.0) {
            let factor = spread(draw, 15.0);
            let (c, d) = children(a, b, factor);
            prop_assert!((((d - c) - factor * (b - a)).abs()) <= 1e-4 * (1.0 + factor * (b - a).abs()));
        }

        #[test]
        fn equal_parents_have_equal_children(a in -10f32..10.0, draw in 0f32..1.0) {
            prop_assert_eq!(children(a, a, spread(draw, 2.0)), (a, a));
        }
    }

    /// By the definition of SBX half of the factors lie below one, and below one their cube-like distribution function
    /// is ½ β^(η+1).
    #[test]
    fn the_spread_follows_the_index() {
        let mut rng = generator(1, &[]);
        for index in [2.0f32, 15.0] {
            let factors: Vec<f32> = (0..40_000).map(|_| spread(rng.random(), index)).collect();
            for level in [0.7f32, 0.9, 1.0] {
                let expected = 0.5 * libm::powf(level, index + 1.0);
                let seen = factors.iter().filter(|f| **f < level).count() as f32 / factors.len() as f32;
                assert!((seen - expected).abs() < 0.01, "index {index}, level {level}: {seen} against {expected}");
            }
            let outside = factors.iter().filter(|f| **f > 1.2).count() as f32 / factors.len() as f32;
            let expected = 0.5 * libm::powf(1.2, -(index + 1.0));
            assert!((outside - expected).abs() < 0.01);
        }
    }
}
