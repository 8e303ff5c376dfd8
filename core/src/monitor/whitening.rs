//! From residuals to innovations: the Kalman filter of the simulator's own error and the tracker's noise.

use super::INNOVATION_BITS;
use super::alternatives::Weights;
use crate::fixed_point::product;

/// Number of steps of a held command with gains of their own; later ones have those of the last.
pub const HELD: usize = 8;

/// Number of travels with a noise of their own.
pub const TRAVELS: usize = 8;

/// The filter of one channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whitening {
    /// One over the unit of residuals, from Q16.16 to [`INNOVATION_BITS`]: `scale` / 2^(32 + `shift`).
    pub scale: i32,
    /// See `scale`, at most 31.
    pub shift: u8,
    /// Gains where the tracker's error at the beginning of the step is known from the step before, and where it is not; each by the
    /// number of steps for which the present command has been held.
    pub gains: [[Gains; HELD]; 2],
    /// Factors on innovations and shifts by the predicted travel in this channel, in eighths of full speed, with 14 fractional
    /// bits: the noise of a step grows with its travel.
    pub by_travel: [i16; TRAVELS],
}

/// The gains of the filter in a step. All have 14 fractional bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gains {
    /// One over the standard deviation of the innovation, in units of residuals.
    pub precision: i16,
    /// What an innovation of one standard deviation says of the error for this command.
    pub error: i16,
    /// What it says of the tracker's error at the end of the step.
    pub tracker: i16,
    /// What is left of a lasting shift of residuals once the error for this command has taken in what earlier steps showed.
    pub shift: i16,
}

/// What the filter knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// The simulator's error for the present command, in units of residuals with [`INNOVATION_BITS`] fractional bits.
    error: i16,
    /// The last innovation.
    last: i16,
    /// What that says of the tracker's error at the beginning of this step, with 14 fractional bits; zero if nothing.
    tracker: i16,
}

impl Whitening {
    /// Returns a residual in Q16.16 in units of residuals, at most 31 of them.
    pub(super) fn standardised(&self, residual: i32) -> i32 {
        const MOST: i32 = 31 << INNOVATION_BITS;
        ((product(residual, self.scale) >> 32) as i32 >> self.shift.min(31)).clamp(-MOST, MOST)
    }

    /// Returns the factor on innovations and shifts for a travel with 12 fractional bits, whose sum over both wheels is two at
    /// full speed.
    pub(super) fn width(&self, travel: i32) -> i32 {
        let eighth = ((travel >> 10) as usize).min(TRAVELS - 1);
        self.by_travel.get(eighth).map_or(1 << 14, |factor| i32::from(*factor))
    }
}

impl Filter {
    /// The tracker's error is not known any more.
    pub fn forget_tracker(&mut self) {
        self.tracker = 0;
    }

    /// Another command has another error.
    pub fn change_command(&mut self) {
        self.error = 0;
    }

    /// Returns the weights of the residual and of the last innovation in this one, whose precision is that of the gains times
    /// `width`.
    pub fn weights(&self, gains: &Gains, width: i32) -> Weights {
        let precision = (i32::from(gains.precision) * width) >> 14;
        Weights { residual: precision, last: (precision * i32::from(self.tracker)) >> 14 }
    }

    /// Returns how far a residual is from what the filter expects, in standard deviations.
    pub fn innovation(&self, residual: i32, weights: Weights) -> i32 {
        ((residual - i32::from(self.error)) * weights.residual + i32::from(self.last) * weights.last) >> 14
    }

    /// Learns from an innovation.
    pub fn update(&mut self, innovation: i32, gains: &Gains) {
        let error = i32::from(self.error) + ((innovation * i32::from(gains.error)) >> 14);
        const MOST: i32 = 8 << INNOVATION_BITS;
        self.error = error.clamp(-MOST, MOST) as i16;
        self.last = innovation as i16;
        self.tracker = gains.tracker;
    }
}
