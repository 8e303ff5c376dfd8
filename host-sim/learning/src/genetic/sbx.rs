//! Simulated binary crossover (SBX; Deb and Agrawal 1995): children are distributed about their parents as by one-point
//! crossover of bit strings.

use mindgap_core::maths;
use mindgap_core::scalar::Scalar;
use pulp::{Arch, Simd, WithSimd};
use rand::RngExt;

use mindgap_foundations::lanes::{Lanes, WIDEST};
use mindgap_foundations::random::Generator;

/// Crosses two parents in place, each gene with its own spread factor and without bounds, as in the original.
/// `index` is the distribution index η.
pub fn cross(a: &mut [f32], b: &mut [f32], index: f32, rng: &mut Generator) {
    for (a, b) in a.chunks_mut(WIDEST).zip(b.chunks_mut(WIDEST)) {
        let mut draws = [0.0; WIDEST];
        draws[..a.len()].fill_with(|| rng.random());
        Arch::new().dispatch(Cross { a, b, draws, index });
    }
}

/// Genes of two parents, and a uniform draw in [0, 1) for each.
struct Cross<'a> {
    a: &'a mut [f32],
    b: &'a mut [f32],
    draws: [f32; WIDEST],
    index: f32,
}

impl WithSimd for Cross<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let width = Lanes::<S>::WIDTH;
        let genes = self.a.chunks_mut(width).zip(self.b.chunks_mut(width));
        for ((a, b), draws) in genes.zip(self.draws.chunks(width)) {
            let parents = [Lanes::load(simd, a), Lanes::load(simd, b)];
            let [daughter, son] = children(parents, spread(Lanes::load(simd, draws), self.index));
            daughter.store(a);
            son.store(b);
        }
    }
}

/// Returns the spread factor β for a uniform draw in [0, 1): below one the children lie between their parents, above one
/// outside. A larger index keeps them nearer to the parents.
#[inline(always)]
fn spread<S: Simd>(draw: Lanes<S>, index: f32) -> Lanes<S> {
    let number = |value| draw.constant(value);
    let outside = number(0.5) / (number(1.0) - draw);
    let base = draw.less(number(0.5)).select(number(2.0) * draw, outside);
    maths::exp2(maths::log2(base) * number(1.0 / (index + 1.0)))
}

/// The two children of one gene; their mean is their parents' mean.
#[inline(always)]
fn children<S: Simd>([a, b]: [Lanes<S>; 2], spread: Lanes<S>) -> [Lanes<S>; 2] {
    let half = a.constant(0.5);
    let (middle, distance) = (half * (a + b), half * spread * (b - a));
    [middle - distance, middle + distance]
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::random::generator;
    use proptest::prelude::*;

    fn spread(draw: f32, index: f32) -> f32 {
        let mut factor = [0.0];
        super::spread(Lanes::splat(pulp::Scalar::new(), draw), index).store(&mut factor);
        factor[0]
    }

    fn children(a: f32, b: f32, spread: f32) -> (f32, f32) {
        let [a, b, spread] = [a, b, spread].map(|x| Lanes::splat(pulp::Scalar::new(), x));
        let mut stored = [[0.0]; 2];
        super::children([a, b], spread).iter().zip(&mut stored).for_each(|(child, place)| child.store(place));
        (stored[0][0], stored[1][0])
    }

    proptest! {
        #[test]
        fn every_instruction_set_gives_the_same_bits(
            a in prop::collection::vec(-10f32..10.0, 1..=WIDEST), b in -10f32..10.0, index in 1f32..30.0, seed in any::<u64>(),
        ) {
            let mut rng = generator(seed, &[]);
            let draws = std::array::from_fn(|_| rng.random());
            let (mut a, mut b) = ([a.clone(), a.clone()], [vec![b; a.len()], vec![b; a.len()]]);
            pulp::Scalar::new().vectorize(Cross { a: &mut a[0], b: &mut b[0], draws, index });
            Arch::new().dispatch(Cross { a: &mut a[1], b: &mut b[1], draws, index });
            prop_assert_eq!(&a[0], &a[1]);
            prop_assert_eq!(&b[0], &b[1]);
        }

        #[test]
        fn children_keep_their_parents_mean(a in -10f32..10.0, b in -10f32..10.0, draw in 0f32..1.0, index in 1f32..30.0) {
            let (c, d) = children(a, b, spread(draw, index));
            prop_assert!(((c + d) - (a + b)).abs() <= 1e-5 * (1.0 + c.abs() + d.abs()));
        }

        #[test]
        fn distance_of_the_children_is_the_spread_times_their_parents(a in -10f32..10.0, b in -10f32..10.0, draw in 0f32..1.0) {
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
    fn spread_follows_the_index() {
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
