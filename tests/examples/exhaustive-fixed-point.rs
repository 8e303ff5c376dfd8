//! Checks the functions of `mindgap_core::fixed_point` at every input, in four minutes of processor time:
//! `cargo run --release -p mindgap-tests --example exhaustive-fixed-point`. Exits with 1 if a bound is exceeded.

use std::ops::RangeInclusive;
use std::process::ExitCode;

use fixed::FixedI32;
use fixed::types::extra::{U16, U26};
use mindgap_core::fixed_point::{Format, exp2, log2};
use mindgap_tests::fixed_point_error::{cos_pi_error_ulp, exp2_error_ulp, log2_error_ulp};
use rayon::prelude::*;

fn main() -> ExitCode {
    let held = [check::<U16>("Q16.16"), check::<U26>("Q6.26")];
    if held.contains(&false) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Prints the result for every function and returns whether all bounds hold.
fn check<F: Format + Sync>(format: &str) -> bool {
    println!("{format}");
    let one = FixedI32::<F>::ONE.to_bits();
    // Below the first number the result is under half an ulp; from the second on it does not fit.
    let zero_below = (-F::I32 - 1) * one;
    let saturates_from = (31 - F::I32) * one;
    let held = [
        bound::<F>(
            "exp2 where it neither vanishes nor saturates",
            zero_below..=saturates_from - 1,
            exp2_error_ulp::<F>,
        ),
        every("exp2 below that", i32::MIN..=zero_below - 1, exp2::<F>, FixedI32::ZERO),
        every("exp2 above that", saturates_from..=i32::MAX, exp2::<F>, FixedI32::MAX),
        bound::<F>("log2 of positive numbers", 1..=i32::MAX, log2_error_ulp::<F>),
        every("log2 of all others", i32::MIN..=0, log2::<F>, FixedI32::from_num(-F::I32)),
        // Whole turns are shifted out, so one turn covers every input.
        bound::<F>("cos_pi of one turn", -one..=one - 1, cos_pi_error_ulp::<F>),
    ];
    !held.contains(&false)
}

/// Prints the largest error over the inputs with these bits and returns whether it is within 1 ulp.
fn bound<F: Format>(name: &str, bits: RangeInclusive<i32>, error_ulp: fn(i32) -> f64) -> bool {
    let inputs = bits.clone().count();
    let larger = |a: (f64, i32), b: (f64, i32)| if b.0 > a.0 { b } else { a };
    let (worst_ulp, at) = bits.into_par_iter().map(|b| (error_ulp(b), b)).reduce(|| (0.0, 0), larger);
    println!("  {name}: {inputs} inputs, largest error {worst_ulp:.4} ulp, at {}", FixedI32::<F>::from_bits(at));
    worst_ulp <= 1.0
}

/// Prints and returns whether a function has the same result at all inputs with these bits.
fn every<F: Format + Sync>(
    name: &str,
    bits: RangeInclusive<i32>,
    function: fn(FixedI32<F>) -> FixedI32<F>,
    expected: FixedI32<F>,
) -> bool {
    let inputs = bits.clone().count();
    let held = bits.into_par_iter().all(|b| function(FixedI32::from_bits(b)) == expected);
    println!("  {name}: {inputs} inputs, {} {expected}", if held { "all" } else { "NOT all" });
    held
}
