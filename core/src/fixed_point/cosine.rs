//! The cosine of half turns.

use fixed::FixedI32;

use super::Format;
use super::product::upper_product;

/// Returns cos(π `x`), for `x` in half turns.
///
/// ```
/// use mindgap_core::fixed::types::I16F16;
/// use mindgap_core::fixed_point::cos_pi;
///
/// assert_eq!(cos_pi(I16F16::ONE), -I16F16::ONE);
/// ```
pub fn cos_pi<F: Format>(x: FixedI32<F>) -> FixedI32<F> {
    // With 31 fractional bits a whole turn is 2^32, so whole turns overflow and vanish.
    const HALF_TURN: u32 = 1 << 31;
    let turned = (x.to_bits() as u32) << (31 - F::U32);
    let angle = turned.min(turned.wrapping_neg());
    let mirrored = angle.min(HALF_TURN - angle);
    let magnitude = (sin_of_quarter_turn(HALF_TURN - 2 * mirrored) + (1 << (29 - F::U32))) >> (30 - F::U32);
    FixedI32::from_bits(if mirrored == angle { magnitude as i32 } else { -(magnitude as i32) })
}

/// Returns sin(π/2 `s`) with 30 fractional bits, for `s` in [0, 1] with 31 of them. The error is below 2^-27.
fn sin_of_quarter_turn(s: u32) -> u32 {
    // s (C1 - s² (C3 - s² (C5 - s² (C7 - s² C9)))) within 3.4e-9; C1 with 31 fractional bits, the others with 32.
    const C1: u32 = 3_373_259_347;
    const C3: u32 = 2_774_391_505;
    const C5: u32 = 342_259_418;
    const C7: u32 = 20_067_066;
    const C9: u32 = 647_769;
    let square = 2 * upper_product(s, s);
    let inner = C5 - 2 * upper_product(square, C7 - 2 * upper_product(square, C9));
    upper_product(s, C1 - upper_product(square, C3 - 2 * upper_product(square, inner)))
}
