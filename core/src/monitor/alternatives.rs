//! Alternatives to an unchanged robot, and their evidence.

use super::{CHANNELS, INNOVATION_BITS, Law, NAT_BITS};

/// Largest number of directions.
pub const MOST_DIRECTIONS: usize = 10;
/// Sizes in which each direction is tried: one, two and four times its unit.
pub const SIZES: usize = 3;
/// Number of alternatives: directions in all sizes, and wider residuals of each channel.
pub const ALTERNATIVES: usize = MOST_DIRECTIONS * SIZES + CHANNELS;
/// The most that one step adds to evidence, nats.
pub const MOST_NATS: i32 = 6;
/// The largest factor of a direction, so that sums of products have room.
pub const MOST_FACTOR: i16 = 8191;
/// Factor by which residuals scatter more under the alternative that says only that.
pub const WIDER: f64 = 2.0;

/// Innovations count at most this much.
const CLIP: i32 = 6 << INNOVATION_BITS;
/// No direction predicts a larger shift, so that squares have room.
const MOST_SHIFT: i32 = 8 << INNOVATION_BITS;
/// In wider residuals innovations count at most this much.
const WIDER_CLIP: i32 = 4 << INNOVATION_BITS;
/// (1 - 1/2²)/2 and ln 2, with 10 and 20 fractional bits.
const WIDER_SLOPE: i32 = 384;
const WIDER_NATS: i32 = 726_817;

/// A way in which the robot may change, and by how many units of residuals its smallest alternative then shifts them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction {
    /// What the shift is proportional to.
    pub response: Response,
    /// Shift of forward by the response of the left and of the right wheel, with 12 fractional bits; at most
    /// [`MOST_FACTOR`].
    pub forward: [i16; 2],
    /// The same of the turn.
    pub turn: [i16; 2],
    /// Whether the shift grows with the time since the run began: it is that after 64 steps.
    pub grows: bool,
    /// Whether this is the opposite of the direction before, whose other fields it has. It is cheaper that way.
    pub is_opposite: bool,
}

/// What the shift of a direction is proportional to, for each wheel. Travel at full speed is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// Its travel.
    Travel,
    /// The change of its travel since the step before.
    Change,
    /// The sign of its travel.
    Sign,
}

/// An alternative by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Alternative {
    /// A direction, and its size as a power of two.
    Direction(u8, u8),
    /// Residuals of a channel scatter more.
    Wider(u8),
}

/// The evidence of one alternative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Track {
    /// In nats, with [`NAT_BITS`] fractional bits.
    pub evidence: u16,
    /// Number of measured steps, modulo 2^16, before those that the evidence is from.
    pub restarted: u16,
}

/// The state of all alternatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternatives {
    pub tracks: [Track; ALTERNATIVES],
    /// Shifts of the last innovations by the smallest alternative of each direction.
    last_shifts: [[i16; CHANNELS]; MOST_DIRECTIONS],
    /// Number of measured steps, modulo 2^16.
    steps: u16,
}

/// How an innovation follows from residuals, and so its shift from theirs; with 14 fractional bits.
#[derive(Clone, Copy)]
pub struct Weights {
    /// Of the shift of this residual.
    pub residual: i32,
    /// Of the shift of the last innovation.
    pub last: i32,
}

impl Weights {
    /// Returns by how much a shift of the residual shifts the innovation, and remembers it in `last`.
    #[inline(always)]
    fn shift(&self, residual: i32, last: &mut i16) -> i32 {
        let shift = (residual * self.residual + i32::from(*last) * self.last) >> 14;
        let shift = shift.clamp(-MOST_SHIFT, MOST_SHIFT);
        *last = shift as i16;
        shift
    }
}

/// What directions depend on: for each response that of the left and of the right wheel, with 12 fractional bits.
pub struct Responses {
    wheels: [[i32; 2]; 3],
    run_steps: i32,
}

impl Alternatives {
    /// Returns the state without evidence.
    pub fn new() -> Self {
        let (tracks, last_shifts) = ([Track::default(); ALTERNATIVES], [[0; CHANNELS]; MOST_DIRECTIONS]);
        Alternatives { tracks, last_shifts, steps: 0 }
    }
}

impl Alternative {
    /// Returns its place among all alternatives.
    pub fn index(self) -> usize {
        match self {
            Alternative::Direction(direction, size) => usize::from(direction) * SIZES + usize::from(size),
            Alternative::Wider(channel) => MOST_DIRECTIONS * SIZES + usize::from(channel),
        }
    }
}

impl Responses {
    /// Returns the responses for the travel of the wheels in this step and the one before.
    pub fn new([left, right]: [i32; 2], before: [i32; 2], run_steps: u16) -> Self {
        const MOVES: i32 = 1 << 6;
        let sign = |travel: i32| if travel.abs() < MOVES { 0 } else { travel.signum() << 12 };
        let wheels = [[left, right], [left - before[0], right - before[1]], [sign(left), sign(right)]];
        Responses { wheels, run_steps: i32::from(run_steps.min(255)) }
    }

    /// Returns by how much a direction shifts the residuals of each channel, in units of residuals.
    #[inline(always)]
    fn shifts(&self, direction: &Direction) -> [i32; CHANNELS] {
        let [mut left, mut right] = match direction.response {
            Response::Travel => self.wheels[0],
            Response::Change => self.wheels[1],
            Response::Sign => self.wheels[2],
        };
        if direction.grows {
            (left, right) = ((left * self.run_steps) >> 6, (right * self.run_steps) >> 6);
        }
        let shift = |factors: [i16; 2]| {
            (left * i32::from(factors[0]) + right * i32::from(factors[1])) >> (24 - INNOVATION_BITS)
        };
        [shift(direction.forward), shift(direction.turn)]
    }
}

/// Returns an innovation as far as it counts.
pub fn clipped(innovation: i32) -> i32 {
    innovation.clamp(-CLIP, CLIP)
}

/// Adds a step to the evidence of all alternatives. Returns the strongest of those above the threshold, if any, and the
/// number of steps since it was restarted. `held_steps` is the number of steps for which the command has been held: where the
/// networks are wrong about a command, they are wrong in all its steps, so each adds at most half as much to the evidence of
/// wider residuals as the one before.
pub fn gather(
    state: &mut Alternatives,
    law: &Law,
    responses: &Responses,
    innovations: [i32; CHANNELS],
    weights: [Weights; CHANNELS],
    held_steps: u8,
) -> Option<(Alternative, u16)> {
    let now = state.steps.wrapping_add(1);
    state.steps = now;
    let mut strongest = Strongest { evidence: law.threshold, alternative: None };
    let (of_directions, of_channels) = state.tracks.split_at_mut(MOST_DIRECTIONS * SIZES);
    let of_directions = of_directions.as_chunks_mut::<SIZES>().0.iter_mut().zip(&mut state.last_shifts);
    let (mut score, mut half) = (0, 0);
    for (d, (direction, (tracks, last_shifts))) in law.directions.iter().zip(of_directions).enumerate() {
        if direction.is_opposite {
            score = -score;
        } else {
            let ([forward, turn], [last_forward, last_turn]) = (responses.shifts(direction), last_shifts);
            let forward = weights[0].shift(forward, last_forward);
            let turn = weights[1].shift(turn, last_turn);
            score = forward * innovations[0] + turn * innovations[1];
            half = (forward * forward + turn * turn) >> 1;
        }
        if score <= half && tracks.iter().all(|track| track.evidence == 0) {
            continue;
        }
        for (size, track) in tracks.iter_mut().enumerate() {
            // Half of the square grows twice as fast.
            let nats = (score - (half << size)) >> (2 * INNOVATION_BITS - NAT_BITS - size as u32);
            if track.add(nats, now) >= strongest.evidence {
                strongest.set(track, Alternative::Direction(d as u8, size as u8), now);
            }
        }
    }
    for (channel, (track, innovation)) in of_channels.iter_mut().zip(innovations).enumerate() {
        let z = innovation.clamp(-WIDER_CLIP, WIDER_CLIP);
        let nats = (((z * z) >> 10) * WIDER_SLOPE - WIDER_NATS) >> (2 * INNOVATION_BITS - NAT_BITS);
        let nats = if nats > 0 { nats >> held_steps } else { nats };
        if track.add(nats, now) >= strongest.evidence {
            strongest.set(track, Alternative::Wider(channel as u8), now);
        }
    }
    strongest.alternative
}

/// The strongest alternative so far.
struct Strongest {
    evidence: u16,
    alternative: Option<(Alternative, u16)>,
}

impl Strongest {
    #[inline(never)]
    fn set(&mut self, track: &Track, alternative: Alternative, now: u16) {
        let steps = now.wrapping_sub(track.restarted);
        *self = Strongest { evidence: track.evidence, alternative: Some((alternative, steps)) };
    }
}

impl Track {
    /// Adds nats, and restarts at zero. Returns the evidence.
    #[inline(always)]
    fn add(&mut self, nats: i32, now: u16) -> u16 {
        let before = i32::from(self.evidence);
        let sum = before + nats;
        if sum <= 0 {
            self.evidence = 0;
            return 0;
        }
        if before == 0 {
            self.restarted = now.wrapping_sub(1);
        }
        self.evidence = sum.min(before + (MOST_NATS << NAT_BITS)).min(i32::from(u16::MAX)) as u16;
        self.evidence
    }
}
