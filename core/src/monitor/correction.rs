//! What is added to the networks' predictions: piecewise linear functions of single commands and of their differences,
//! about which a network of few units is biased.

use fixed::types::I16F16;

use super::factor::Factor;
use super::{CHANNELS, SHARE_BITS};

/// Points of the function of a command; those of a difference lie twice as far apart.
pub const POINTS: usize = 33;
/// Points per share of full speed, as a power of two.
const POINTS_PER_SHARE: u32 = 4;
/// Functions: of left, right, previous left and previous right command, and of both differences.
pub const FUNCTIONS: usize = 6;
/// The largest power of two by which values are multiplied.
pub const MOST_SHIFT: u8 = 11;
/// Bits of a share beyond a point.
const BITS: u32 = SHARE_BITS - POINTS_PER_SHARE;

/// The correction of both channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction<'a> {
    /// Values for each channel at equidistant shares of full speed from -1 to 1, of differences from -2 to 2.
    pub functions: &'a [[[i16; CHANNELS]; POINTS]; FUNCTIONS],
    /// Left shift that converts the values of each channel to [`RESIDUAL_BITS`](super::RESIDUAL_BITS) fractional bits (cm, degrees),
    /// at most [`MOST_SHIFT`].
    pub shifts: [u8; CHANNELS],
}

impl Correction<'_> {
    /// Returns the corrections with [`RESIDUAL_BITS`](super::RESIDUAL_BITS) for commands and their factor to shares of full speed.
    pub(super) fn of(&self, share: Factor, commands: &[I16F16; 4]) -> [i32; CHANNELS] {
        let [l, r, l_before, r_before] = commands.map(|command| share.times(command.to_bits()));
        let places = [(l, r), (l_before, r_before), ((r - l) >> 1, (r_before - l_before) >> 1)];
        let (mut forward, mut turn) = (0, 0);
        for (functions, (a, b)) in self.functions.as_chunks().0.iter().zip(places) {
            let sums = at(functions, a, b);
            (forward, turn) = (forward + sums.0, turn + sums.1);
        }
        [(forward >> BITS) << self.shifts[0].min(MOST_SHIFT), (turn >> BITS) << self.shifts[1].min(MOST_SHIFT)]
    }
}

type Function = [[i16; CHANNELS]; POINTS];

/// Returns the sums of two functions for both channels at places below one, with [`BITS`] more fractional bits than the values.
#[inline(never)]
fn at([a, b]: &[Function; 2], at_a: i32, at_b: i32) -> (i32, i32) {
    let (of_a, of_b) = (value(a, at_a), value(b, at_b));
    (of_a.0 + of_b.0, of_a.1 + of_b.1)
}

#[inline(always)]
fn value(function: &Function, place: i32) -> (i32, i32) {
    let from_first = place + (1 << SHARE_BITS);
    let beyond = from_first & ((1 << BITS) - 1);
    // The remainder, which never matters, shows the compiler that there is such a point.
    let point = (from_first >> BITS) as usize % (POINTS - 1);
    let Some(&[low, high]) = function.get(point..).and_then(|values| values.first_chunk()) else { return (0, 0) };
    let between = |low: i16, high: i16| (i32::from(low) << BITS) + (i32::from(high) - i32::from(low)) * beyond;
    (between(low[0], high[0]), between(low[1], high[1]))
}
