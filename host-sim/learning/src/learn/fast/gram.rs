//! The Gram matrix of a table's columns: all that least squares needs of the samples, whatever their number.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

use mindgap_foundations::lanes;

/// Number of rows that are added to the sums at once, so that sums are read and written less often.
const BLOCK: usize = 4;
/// Number of f64 lanes of the widest vector; rows are padded to a multiple of it.
const WIDEST: usize = lanes::WIDEST / 2;

/// Returns the weighted Gram matrix, `width` by `width`, of a table that has one row for each weight.
///
/// `fill` writes the row of an index into a slice of `width` numbers. Each sum adds the rows in their order, so that the
/// result is the same to the bit whatever the instruction set.
pub fn inner_products(width: usize, weights: &[f64], fill: impl Fn(usize, &mut [f64])) -> DMatrix<f64> {
    let stride = width.next_multiple_of(WIDEST);
    let mut sums = vec![0.0; width * stride];
    let mut rows = vec![0.0; BLOCK * stride];
    let arch = Arch::new();
    for (block, weights) in weights.chunks(BLOCK).enumerate() {
        for (place, row) in rows.chunks_exact_mut(stride).enumerate().take(weights.len()) {
            fill(block * BLOCK + place, &mut row[..width]);
        }
        let weights = std::array::from_fn(|place| weights.get(place).copied().unwrap_or(0.0));
        arch.dispatch(Add { sums: &mut sums, rows: &rows, weights, stride });
    }
    DMatrix::from_fn(width, width, |i, j| sums[i.min(j) * stride + i.max(j)])
}

/// Adds a block of rows to the sums on and right of the diagonal.
struct Add<'a> {
    sums: &'a mut [f64],
    rows: &'a [f64],
    weights: [f64; BLOCK],
    stride: usize,
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let row = |place: usize| &self.rows[place * self.stride..(place + 1) * self.stride];
        let rows: [&[f64]; BLOCK] = std::array::from_fn(row);
        for (i, sums) in self.sums.chunks_exact_mut(self.stride).enumerate() {
            let first = i / WIDEST * WIDEST;
            let factors: [S::f64s; BLOCK] =
                std::array::from_fn(|place| simd.splat_f64s(self.weights[place] * rows[place][i]));
            let [a, b, c, d]: [&[S::f64s]; BLOCK] = rows.map(|row| S::as_simd_f64s(&row[first..]).0);
            let sums = S::as_mut_simd_f64s(&mut sums[first..]).0;
            for ((((sum, a), b), c), d) in sums.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                for (factor, numbers) in factors.iter().zip([a, b, c, d]) {
                    *sum = simd.add_f64s(*sum, simd.mul_f64s(*factor, *numbers));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Bit for bit what a plain loop gives, for any width and any number of rows.
        #[test]
        fn products_equal_those_of_a_plain_loop(width in 1usize..40, seed in any::<u64>(), count in 0usize..11) {
            let number = |i: usize, j: usize| {
                let hashed = mindgap_foundations::random::derive(seed, &[i as u64, j as u64]);
                hashed as f64 / u64::MAX as f64 - 0.5
            };
            let weights: Vec<f64> = (0..count).map(|i| number(i, width).abs()).collect();
            let fill = |i: usize, row: &mut [f64]| row.iter_mut().enumerate().for_each(|(j, x)| *x = number(i, j));
            let sums = inner_products(width, &weights, fill);
            for (a, b) in (0..width).flat_map(|a| (a..width).map(move |b| (a, b))) {
                let plain = (0..count).fold(0.0, |sum, i| sum + weights[i] * number(i, a) * number(i, b));
                prop_assert_eq!(sums[(a, b)].to_bits(), f64::to_bits(plain));
                prop_assert_eq!(sums[(b, a)].to_bits(), f64::to_bits(plain));
            }
        }
    }
}
