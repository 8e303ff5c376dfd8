//! Where random generators come from: one a purpose, seeded by the run's seed and the purpose's place in it, never by
//! a thread.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

/// The generator that everything on the host draws from.
pub type Generator = Xoshiro256PlusPlus;

/// The generator for one purpose of a run. `place` tells purposes apart: for an individual it may be
/// `[restart, generation, individual]`. Other places give unrelated streams.
pub fn generator(seed: u64, place: &[u64]) -> Generator {
    Generator::seed_from_u64(derive(seed, place))
}

/// The seed for one purpose of a run.
pub fn derive(seed: u64, place: &[u64]) -> u64 {
    place.iter().fold(mix(seed), |state, part| mix(state.rotate_left(29) ^ mix(*part)))
}

/// The finaliser of SplitMix64: every bit of the input moves every bit of the output.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use std::collections::HashSet;

    #[test]
    fn places_give_their_own_streams_again_and_again() {
        let first = |seed, place: &[u64]| generator(seed, place).next_u64();
        let mut seen = HashSet::new();
        for seed in 0..20 {
            for a in 0..20 {
                assert!(seen.insert(first(seed, &[a])));
                for b in 0..20 {
                    assert!(seen.insert(first(seed, &[a, b])));
                }
            }
        }
        assert_eq!(first(7, &[1, 2]), first(7, &[1, 2]));
    }
}
