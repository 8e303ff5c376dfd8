//! What is added to the networks' predictions: piecewise linear functions of single commands and of their differences,
//! about which a network of few units is biased.

use super::{CHANNELS, SHARE_BITS};

/// Points of the function of a command; those of a difference lie twice as far apart.
pub const POINTS: usize = 33;
/// Points per share of full speed, as a power of two.
const POINTS_PER_SHARE: u32 = 4;
/// Functions: of left, right, previous left and previous right command, and of both differences.
const FUNCTIONS: usize = 6;

/// The correction of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction<'a> {
    /// Values at equidistant shares of full speed from -1 to 1, of differences from -2 to 2.
    pub functions: &'a [[i16; POINTS]; FUNCTIONS],
    /// Power of two that makes Q16.16 of the values.
    pub shift: u8,
}

/// Returns the corrections in Q16.16 for commands as shares of full speed.
pub(super) fn corrections(
    corrections: &[Correction; CHANNELS],
    [l, r, l_before, r_before]: [i32; 4],
) -> [i32; CHANNELS] {
    let places = [l, r, l_before, r_before, (r - l) >> 1, (r_before - l_before) >> 1];
    let mut sums = [0i32; CHANNELS];
    for (function, share) in places.into_iter().enumerate() {
        const ONE: i32 = 1 << SHARE_BITS;
        const BITS: u32 = SHARE_BITS - POINTS_PER_SHARE;
        // The last point is reached but not passed.
        let from_first = (share + ONE).clamp(0, 2 * ONE - 1);
        let point = (from_first >> BITS) as usize;
        let beyond = from_first & ((1 << BITS) - 1);
        for (sum, correction) in sums.iter_mut().zip(corrections) {
            let Some(values) = correction.functions.get(function) else { continue };
            if let Some([low, high]) = values.get(point..).and_then(|values| values.first_chunk()) {
                let (low, high) = (i32::from(*low), i32::from(*high));
                *sum += low + (((high - low) * beyond) >> BITS);
            }
        }
    }
    for (sum, correction) in sums.iter_mut().zip(corrections) {
        *sum <<= correction.shift.min(13);
    }
    sums
}
