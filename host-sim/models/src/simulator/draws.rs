//! Random draws in lanes: Xoshiro128++ (Blackman and Vigna 2019), one stream a robot.

use pulp::Simd;
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use mindgap_foundations::lanes::{Lanes, WIDEST};

/// The generators of a vector of robots.
pub struct Draws<S: Simd> {
    simd: S,
    state: [S::u32s; 4],
}

/// The states of as many generators, one lane after the other, so that single lanes can be reseeded.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seeds([[u32; WIDEST]; 4]);

impl Seeds {
    /// Seeds one lane as `Xoshiro128PlusPlus::seed_from_u64` does.
    pub fn set(&mut self, lane: usize, seed: u64) {
        let mut bytes = [0; 16];
        SplitMix64::seed_from_u64(seed).fill_bytes(&mut bytes);
        for (word, bytes) in self.0.iter_mut().zip(bytes.chunks_exact(4)) {
            word[lane] = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        }
    }
}

impl<S: Simd> Draws<S> {
    /// Generators with these states.
    #[inline(always)]
    pub fn load(simd: S, seeds: &Seeds) -> Self {
        let mut state = [simd.splat_u32s(0); 4];
        for (state, word) in state.iter_mut().zip(&seeds.0) {
            *state = simd.partial_load_u32s(&word[..S::U32_LANES]);
        }
        Draws { simd, state }
    }

    /// Keeps the states.
    #[inline(always)]
    pub fn store(&self, seeds: &mut Seeds) {
        for (word, state) in seeds.0.iter_mut().zip(self.state) {
            self.simd.partial_store_u32s(&mut word[..S::U32_LANES], state);
        }
    }

    /// The next 32 bits of every generator.
    #[inline(always)]
    pub fn bits(&mut self) -> S::u32s {
        let s = self.simd;
        let [mut a, mut b, mut c, mut d] = self.state;
        let result = s.add_u32s(self.rotate_left(s.add_u32s(a, d), 7), a);
        let t = s.wrapping_dyn_shl_u32s(b, s.splat_u32s(9));
        c = s.xor_u32s(c, a);
        d = s.xor_u32s(d, b);
        b = s.xor_u32s(b, c);
        a = s.xor_u32s(a, d);
        c = s.xor_u32s(c, t);
        d = self.rotate_left(d, 11);
        self.state = [a, b, c, d];
        result
    }

    /// The same as a row.
    #[inline(always)]
    pub fn bits_row(&mut self) -> [u32; WIDEST] {
        let mut row = [0; WIDEST];
        let bits = self.bits();
        self.simd.partial_store_u32s(&mut row[..S::U32_LANES], bits);
        row
    }

    /// A uniform draw from [0, 1) for every lane: the top 23 of the next 32 bits.
    #[inline(always)]
    pub fn uniform(&mut self) -> Lanes<S> {
        let s = self.simd;
        let fraction = s.wrapping_dyn_shr_u32s(self.bits(), s.splat_u32s(9));
        // In the low bits of one the fraction makes a number of [1, 2).
        let one_and = s.transmute_f32s_u32s(s.or_u32s(fraction, s.splat_u32s(1.0f32.to_bits())));
        Lanes::new(s, s.sub_f32s(one_and, s.splat_f32s(1.0)))
    }

    #[inline(always)]
    fn rotate_left(&self, x: S::u32s, by: u32) -> S::u32s {
        let s = self.simd;
        let (left, right) = (s.splat_u32s(by), s.splat_u32s(32 - by));
        s.or_u32s(s.wrapping_dyn_shl_u32s(x, left), s.wrapping_dyn_shr_u32s(x, right))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, WithSimd};
    use rand_xoshiro::Xoshiro128PlusPlus;

    /// A hundred draws of every lane.
    struct Hundred(Seeds);

    impl WithSimd for Hundred {
        type Output = Vec<Vec<u32>>;

        #[inline(always)]
        fn with_simd<S: Simd>(mut self, simd: S) -> Self::Output {
            let mut rows = Vec::new();
            for _ in 0..100 {
                let mut draws = Draws::load(simd, &self.0);
                let mut row = vec![0; S::U32_LANES];
                simd.partial_store_u32s(&mut row, draws.bits());
                draws.store(&mut self.0);
                rows.push(row);
            }
            rows
        }
    }

    #[test]
    fn every_lane_is_the_well_known_generator() {
        let mut seeds = Seeds::default();
        (0..WIDEST).for_each(|lane| seeds.set(lane, 1000 + lane as u64));
        let rows = Arch::new().dispatch(Hundred(seeds));
        for lane in 0..rows[0].len() {
            let mut reference = Xoshiro128PlusPlus::seed_from_u64(1000 + lane as u64);
            assert!(rows.iter().all(|row| row[lane] == reference.next_u32()), "lane {lane}");
        }
    }
}
