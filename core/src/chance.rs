//! Random draws on the robot, in fixed point: whether an echo returns, and how far a reading is from its mean.
//!
//! Every draw takes its random numbers from a generator that the caller passes in. [`Generator`] needs 16 bytes and no
//! multiplication.

use fixed::Saturating;
use fixed::types::{I6F26, I16F16};
use rand_core::Rng;

use crate::fixed_point::{cos_pi, exp2, log2};

/// A random number generator that suits a 32-bit processor.
///
/// ```
/// use mindgap_core::chance::Generator;
/// use mindgap_core::rand_core::{Rng, SeedableRng};
///
/// let [mut one, mut other] = [Generator::seed_from_u64(1), Generator::seed_from_u64(1)];
/// assert_eq!(one.next_u32(), other.next_u32());
/// ```
pub type Generator = rand_xoshiro::Xoshiro128PlusPlus;

/// Returns `true` with the given probability: a Bernoulli draw with a resolution of 2^-16.
///
/// ```
/// use mindgap_core::chance::{Generator, happens};
/// use mindgap_core::fixed::types::I16F16;
/// use mindgap_core::rand_core::SeedableRng;
///
/// let mut generator = Generator::seed_from_u64(1);
/// assert!(happens(I16F16::ONE, &mut generator));
/// assert!(!happens(I16F16::ZERO, &mut generator));
/// ```
pub fn happens<R: Rng>(probability: I16F16, generator: &mut R) -> bool {
    i64::from(generator.next_u32()) < i64::from(probability.to_bits()) << 16
}

/// Returns a normally distributed number, at most 6.56 standard deviations from the mean (Box and Muller, 1958).
///
/// A result that does not fit saturates.
///
/// ```
/// use mindgap_core::chance::{Generator, normal};
/// use mindgap_core::fixed::types::I16F16;
/// use mindgap_core::rand_core::SeedableRng;
///
/// let (mean_cm, deviation_cm) = (I16F16::from_num(40), I16F16::from_num(2));
/// let reading_cm = normal(mean_cm, deviation_cm, &mut Generator::seed_from_u64(1));
/// assert!((reading_cm - mean_cm).abs() < 7 * deviation_cm);
/// ```
pub fn normal<R: Rng>(mean: I16F16, deviation: I16F16, generator: &mut R) -> I16F16 {
    let standard = standard_normal(generator.next_u32(), generator.next_u32());
    (Saturating(mean) + Saturating(deviation) * Saturating(standard)).0
}

/// Returns √(-2 ln u) cos(2π v) for two uniform numbers in [0, 1): the upper 31 bits of one word and 27 of another. The
/// error is below 2^-12.
fn standard_normal(u: u32, v: u32) -> I16F16 {
    // The radius is 2^(log2(-log2 u)/2 + log2(2 ln 2)/2).
    const HALF_LOG2_2_LN_2: I6F26 = I6F26::from_bits(15_811_977);
    // Read as Q6.26 the number is 2^5 times too large. `log2` takes zero for the smallest positive number.
    let minus_log2_u = I6F26::const_from_int(5).saturating_sub(log2(I6F26::from_bits((u >> 1) as i32)));
    let radius = exp2((log2(minus_log2_u) / 2).saturating_add(HALF_LOG2_2_LN_2));
    let cosine = cos_pi(I6F26::from_bits((v >> 5) as i32));
    I16F16::from_bits(radius.saturating_mul(cosine).to_bits() >> (I6F26::FRAC_NBITS - I16F16::FRAC_NBITS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand_core::SeedableRng;

    const DRAWS: i32 = 200_000;

    #[test]
    fn events_have_the_frequency_of_their_probability() {
        let mut generator = Generator::seed_from_u64(1);
        for probability in [0.02, 0.5, 0.8] {
            let probability = I16F16::from_num(probability);
            let happened = (0..DRAWS).filter(|_| happens(probability, &mut generator)).count() as f64;
            let p = f64::from(probability);
            let deviation = libm::sqrt(f64::from(DRAWS) * p * (1.0 - p));
            assert!((happened - f64::from(DRAWS) * p).abs() < 4.0 * deviation, "{happened} at {p}");
        }
        for (never, always) in [(I16F16::ZERO, I16F16::ONE), (I16F16::MIN, I16F16::MAX)] {
            assert!((0..1000).all(|_| !happens(never, &mut generator) && happens(always, &mut generator)));
        }
    }

    #[test]
    fn draws_follow_the_normal_distribution() {
        let mut generator = Generator::seed_from_u64(2);
        let (mean, deviation) = (I16F16::from_num(40), I16F16::from_num(2.5));
        let standard = |x: I16F16| (f64::from(x) - 40.0) / 2.5;
        let mut draws: Vec<f64> = (0..DRAWS).map(|_| standard(normal(mean, deviation, &mut generator))).collect();
        draws.sort_by(f64::total_cmp);
        // The Kolmogorov distance. One correct sample in a thousand exceeds 1.95/√n.
        let distance = draws.iter().enumerate().map(|(i, x)| {
            let exact = 0.5 * libm::erfc(-x / core::f64::consts::SQRT_2);
            (exact - (i as f64 + 0.5) / f64::from(DRAWS)).abs()
        });
        let distance = distance.fold(0.0, f64::max);
        assert!(distance < 1.95 / libm::sqrt(f64::from(DRAWS)), "{distance}");
    }

    #[test]
    fn draw_that_does_not_fit_saturates() {
        let mut generator = Generator::seed_from_u64(3);
        let mut at =
            |mean, deviation| -> Vec<I16F16> { (0..1000).map(|_| normal(mean, deviation, &mut generator)).collect() };
        // About the largest number, a draw above the mean saturates and one below it does not; about the smallest number
        // likewise. Half of a thousand draws are on either side, within four standard deviations of 16.
        for (mean, deviation) in [(I16F16::MAX, I16F16::MAX), (I16F16::MIN, I16F16::MIN)] {
            let draws = at(mean, deviation);
            let saturated = draws.iter().filter(|draw| **draw == mean).count();
            assert!((436..=564).contains(&saturated), "{saturated} of 1000 draws about {mean}");
        }
        // No draw is more than seven deviations away, so none wraps around.
        assert!(at(I16F16::MAX, I16F16::ONE).iter().all(|draw| *draw >= I16F16::MAX - I16F16::from_num(7)));
        assert!(at(I16F16::MIN, I16F16::ONE).iter().all(|draw| *draw <= I16F16::MIN + I16F16::from_num(7)));
    }

    proptest! {
        #[test]
        fn standard_normal_follows_the_formula(
            u in prop_oneof![any::<u32>(), 0u32..100, u32::MAX - 100..=u32::MAX], v in any::<u32>(),
        ) {
            let uniform = f64::from((u >> 1).max(1)) / libm::exp2(31.0);
            let turns = f64::from(v >> 5) / libm::exp2(27.0);
            let exact = libm::sqrt(-2.0 * libm::log(uniform)) * libm::cos(2.0 * core::f64::consts::PI * turns);
            let error = (f64::from(standard_normal(u, v)) - exact).abs();
            prop_assert!(error <= 1.0 / 4096.0, "{} off", error);
        }
    }
}
