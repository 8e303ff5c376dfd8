//! From residuals to innovations: the Kalman filter of the simulator's own error and the tracker's noise.

use super::INNOVATION_BITS;
use super::factor::Factor;

/// Number of steps under a held command that have separate gains. Later steps use the gains of the last one.
pub const HELD: usize = 8;

/// Number of travel bins with separate noise levels.
pub const TRAVELS: usize = 8;

/// The filter of one channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whitening {
    /// One over the unit of residuals, from [`RESIDUAL_BITS`](super::RESIDUAL_BITS) to [`INNOVATION_BITS`]; at most 31 units.
    pub scale: Factor,
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
    /// What is left of a lasting shift of residuals once the error for this command has taken in what earlier steps showed;
    /// at most one.
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

/// How far a residual is from what the filter expects, and how that follows from residuals.
pub struct Innovation {
    /// In standard deviations, with [`INNOVATION_BITS`], as far as it counts.
    pub clipped: i32,
    /// By how much a shift of the residual shifts it, with 14 fractional bits.
    pub of_residual: i32,
    /// By how much a shift of the last innovation shifts it, with 14 fractional bits.
    pub of_last: i32,
}

impl Whitening {
    /// Returns the factor on innovations and shifts for a travel with 12 fractional bits, whose sum over both wheels is two at
    /// full speed.
    fn width(&self, travel: i32) -> i32 {
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

    /// Returns how far a residual is from what the filter expects, in standard deviations, and the precision of that. `travel` is
    /// what [`Whitening::width`] takes.
    #[inline(never)]
    pub fn innovation(&self, whitening: &Whitening, gains: &Gains, travel: i32, residual: i32) -> (i32, i32) {
        let residual = whitening.scale.times(residual) - i32::from(self.error);
        let precision = (i32::from(gains.precision) * whitening.width(travel)) >> 14;
        let of_last = (precision * i32::from(self.tracker)) >> 14;
        ((residual * precision + i32::from(self.last) * of_last) >> 14, precision)
    }

    /// Learns from an innovation, and returns how alternatives would have shifted it.
    #[inline(never)]
    pub fn update(&mut self, (innovation, precision): (i32, i32), gains: &Gains) -> Innovation {
        const CLIP: i32 = 6 << INNOVATION_BITS;
        let innovation = innovation.clamp(-CLIP, CLIP);
        let of_last = (precision * i32::from(self.tracker)) >> 14;
        let error = i32::from(self.error) + ((innovation * i32::from(gains.error)) >> 14);
        const MOST: i32 = 8 << INNOVATION_BITS;
        self.error = error.clamp(-MOST, MOST) as i16;
        self.last = innovation as i16;
        self.tracker = gains.tracker;
        // A lasting shift is partly taken for the simulator's own error.
        Innovation { clipped: innovation, of_residual: (precision * i32::from(gains.shift)) >> 14, of_last }
    }
}
