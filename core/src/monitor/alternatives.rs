//! Alternatives to an unchanged robot, and their evidence.
//!
//! Each response of the wheels is filtered once per channel. Directions add and scale what comes out.

use core::ptr;

use fixed::types::I16F16;

use super::whitening::Innovation;
use super::{Alarm, CHANNELS, INNOVATION_BITS, Law, NAT_BITS};

/// Signals that a change of the robot may be proportional to, by number: travel of the left wheel, of the right wheel and of
/// both, the turn that this makes, change of the travel of both since the step before, its sign, and the travel of both times
/// the time since the run began, which is one after 32 steps.
pub const SIGNALS: usize = 7;
/// Number of directions: each signal becomes weaker; those of both wheels, of the turn and of the change also stronger, which
/// is the next direction.
pub const DIRECTIONS: usize = 10;
/// Whether a signal may also become stronger.
pub const HAS_OPPOSITE: [bool; SIGNALS] = [false, false, true, true, true, false, false];
/// Sizes in which each direction is tried.
pub const SIZES: usize = 2;
/// Ratio of the larger size to the smaller one.
pub const LARGER: i32 = 3;
/// Number of alternatives: directions in all sizes, and wider residuals of each channel.
pub const ALTERNATIVES: usize = DIRECTIONS * SIZES + CHANNELS;
/// The most that one step adds to evidence, nats.
pub const MOST_NATS: i32 = 6;
/// Responses of the wheels with a factor, by number: their travel, and its change since the step before.
pub const RESPONSES: usize = 2;
/// The largest factor of a response, so that sums of products have room.
pub const MOST_FACTOR: i16 = 8191;
/// The largest sign of a travel, for the same reason.
pub const MOST_SIGN: i16 = 8191;
/// [`MOST_NATS`] with [`NAT_BITS`].
const MOST: i32 = MOST_NATS << NAT_BITS;

/// No response shifts innovations more, so that squares have room.
const MOST_SHIFT: i32 = 2 << INNOVATION_BITS;
/// A signal that grows does so for this number of steps, for the same reason.
pub const MOST_RUN_STEPS: u8 = 127;
/// Number of steps after which it is as large as the travel of both wheels, as a power of two.
const FADING_BITS: u32 = 5;
/// In wider residuals, which scatter twice as much, innovations count at most this much, as a square.
const WIDER_SQUARE: i32 = 1 << (4 + 2 * INNOVATION_BITS);
/// (1 - 1/2²)/2 with 3 fractional bits.
const WIDER_SLOPE: i32 = 3;
const WIDER_BITS: u32 = 3 + 2 * INNOVATION_BITS;
/// ln 2 with these.
const WIDER_NATS: i32 = 5_814_540;

/// An alternative by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Alternative {
    /// A direction, and the number of its size.
    Direction(u8, u8),
    /// Residuals of a channel scatter twice as much.
    Wider(u8),
}

/// The evidence of one alternative. It is copied as one word.
#[repr(align(4))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Track {
    /// In nats, with [`NAT_BITS`] fractional bits.
    pub evidence: u16,
    /// Number of measured steps, modulo 2^16, before those that the evidence is from.
    restarted: u16,
}

/// Responses, filtered for a channel or not: change of both wheels, travel of the left and of the right one, and sign of both.
type Responses<T> = [T; 4];

/// The state of all alternatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternatives {
    /// By direction and size; in the end those of wider residuals, by channel.
    tracks: [[Track; SIZES]; DIRECTIONS + 1],
    /// Shifts of the last innovations by each response.
    shifts: [Responses<i16>; CHANNELS],
    /// Number of measured steps, modulo 2^16.
    steps: u16,
}

/// Predicted travel of the wheels in a step, with [`TRAVEL_BITS`].
pub struct Travel {
    /// What it shifts in each channel.
    responses: [Responses<i32>; CHANNELS],
    /// Sum of both wheels, without sign.
    pub along: i32,
    /// Difference of both wheels, without sign.
    pub across: i32,
    /// Difference in the step before, with its sign.
    pub across_before: i32,
}

impl Travel {
    /// Returns the travel of a step, and replaces that of the wheels in the step before.
    #[inline(never)]
    pub fn new(law: &Law, [forward, turn]: [I16F16; CHANNELS], before: &mut [i16; 2]) -> Self {
        let [along, across] = [law.travel[0].times(forward.to_bits()), law.travel[1].times(turn.to_bits())];
        let (left, right) = (along - across, along + across);
        let [along_before, across_before] = [before[0], before[1]].map(i32::from);
        let (along, across) = (right + left, right - left);
        *before = [along as i16, across as i16];
        let most = i32::from(law.sign);
        let sign = |travel: i32| (travel << 6).min(most).max(-most);
        let (left_sign, right_sign) = (sign(left), sign(right));
        Travel {
            // In the turn the left wheel has the opposite sign.
            responses: [
                [along - along_before, left, right, right_sign + left_sign],
                [across - across_before, -left, right, right_sign - left_sign],
            ],
            along: along.abs(),
            across: across.abs(),
            across_before,
        }
    }
}

impl Alternative {
    /// Returns all alternatives, by number.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..ALTERNATIVES).map(Self::at)
    }

    fn at(index: usize) -> Self {
        let (row, column) = ((index / SIZES) as u8, (index % SIZES) as u8);
        if usize::from(row) < DIRECTIONS { Alternative::Direction(row, column) } else { Alternative::Wider(column) }
    }

    fn place(self) -> (usize, usize) {
        match self {
            Alternative::Direction(direction, size) => (direction.into(), size.into()),
            Alternative::Wider(channel) => (DIRECTIONS, channel.into()),
        }
    }
}

impl Alternatives {
    /// Returns the state without evidence.
    pub fn new() -> Self {
        let tracks = [[Track::default(); SIZES]; DIRECTIONS + 1];
        Alternatives { tracks, shifts: [[0; 4]; CHANNELS], steps: 0 }
    }

    /// Returns the evidence of an alternative, if it exists.
    pub fn evidence(&self, alternative: Alternative) -> Option<u16> {
        let (row, column) = alternative.place();
        let is_direction = matches!(alternative, Alternative::Direction(..));
        let row = self.tracks.get(row).filter(|_| is_direction == (row < DIRECTIONS))?;
        Some(row.get(column)?.evidence)
    }

    fn alarm(&self, strongest: &Strongest) -> Alarm {
        let first = ptr::from_ref(&self.tracks).addr();
        let alternative = Alternative::at(strongest.address.wrapping_sub(first) / size_of::<Track>());
        Alarm { alternative, after_steps: self.steps.wrapping_sub(strongest.restarted) }
    }

    /// Adds a step to the evidence of all alternatives. Returns an alarm for the strongest of those that reach the threshold.
    /// `held_steps` is the number of steps for which the command has been held: where the networks are wrong about a command, they
    /// are wrong in all its steps, so each adds at most half as much to the evidence of wider residuals as the one before.
    #[inline(never)]
    pub fn gather(
        &mut self,
        law: &Law,
        travel: &Travel,
        run_steps: u8,
        [forward, turn]: [&Innovation; CHANNELS],
        held_steps: u8,
    ) -> Option<Alarm> {
        filter(&mut self.shifts[0], law.factors[0], forward, &travel.responses[0]);
        filter(&mut self.shifts[1], law.factors[1], turn, &travel.responses[1]);
        self.steps = self.steps.wrapping_add(1);
        let mut step = Gathered {
            innovations: [forward.clipped, turn.clipped],
            restarted: Track { evidence: 0, restarted: self.steps },
            strongest: Strongest { evidence: law.threshold, restarted: 0, address: 0 },
        };
        let [left, right, with_opposite @ .., friction, fades, wider] = &mut self.tracks;
        let ([of_both, of_turn, of_change], _) = with_opposite.as_chunks_mut() else { return None };
        step.add_wider(&mut wider[0], forward.clipped, held_steps);
        step.add_wider(&mut wider[1], turn.clipped, held_steps);
        let [forward, turn] = &self.shifts;
        step.weaker_or_stronger(of_change, forward[0].into(), turn[0].into());
        step.weaker(left, forward[1].into(), turn[1].into());
        step.weaker(right, forward[2].into(), turn[2].into());
        step.weaker(friction, forward[3].into(), turn[3].into());
        let (forward, turn) = (sum(forward[1], forward[2]), sum(turn[1], turn[2]));
        step.weaker_or_stronger(of_both, forward, turn);
        step.weaker_or_stronger(of_turn, 0, turn);
        let run_steps = i32::from(run_steps);
        step.weaker(fades, (forward * run_steps) >> FADING_BITS, (turn * run_steps) >> FADING_BITS);
        (step.strongest.address != 0).then(|| self.alarm(&step.strongest))
    }
}

/// Computes by how much each response shifts the innovation of a channel, with [`INNOVATION_BITS`].
#[inline(never)]
fn filter(shifts: &mut Responses<i16>, factors: [i16; RESPONSES], innovation: &Innovation, responses: &Responses<i32>) {
    let [travel, change] = factors.map(|factor| (i32::from(factor) * innovation.of_residual) >> 14);
    for ((shift, response), of_response) in shifts.iter_mut().zip(responses).zip([change, travel, travel, travel]) {
        let shifted = (response * of_response + i32::from(*shift) * innovation.of_last) >> 14;
        *shift = shifted.clamp(-MOST_SHIFT, MOST_SHIFT) as i16;
    }
}

/// Returns what the larger size adds. The drift is that of a square.
#[inline(always)]
fn larger(score: i32, drift: i32) -> i32 {
    LARGER * (score + LARGER * drift)
}

fn sum(left: i16, right: i16) -> i32 {
    i32::from(left) + i32::from(right)
}

/// What a step adds to evidence.
struct Gathered {
    innovations: [i32; CHANNELS],
    /// What is restarted in this step.
    restarted: Track,
    strongest: Strongest,
}

/// The strongest alternative so far of those that reach the threshold.
struct Strongest {
    /// Its evidence, or the threshold.
    evidence: u16,
    restarted: u16,
    /// Where its track is in memory, or zero. Its number would cost instructions in each step.
    address: usize,
}

impl Gathered {
    #[inline(never)]
    fn weaker(&mut self, tracks: &mut [Track; SIZES], forward: i32, turn: i32) {
        let (score, drift) = self.score(forward, turn);
        self.add(tracks, -score, drift);
    }

    #[inline(never)]
    fn weaker_or_stronger(&mut self, [weaker, stronger]: &mut [[Track; SIZES]; 2], forward: i32, turn: i32) {
        let (score, drift) = self.score(forward, turn);
        self.add(weaker, -score, drift);
        self.add(stronger, score, drift);
    }

    /// Returns the logarithm of the likelihood ratio for the smaller size in two parts with [`NAT_BITS`]: what the innovations say
    /// for shifts to this side, and what is expected of an unchanged robot.
    #[inline(always)]
    fn score(&self, forward: i32, turn: i32) -> (i32, i32) {
        const BITS: u32 = 2 * INNOVATION_BITS - NAT_BITS;
        let score = forward * self.innovations[0] + turn * self.innovations[1];
        let square = forward * forward + turn * turn;
        (score >> BITS, -square >> (BITS + 1))
    }

    #[inline(always)]
    fn add(&mut self, tracks: &mut [Track; SIZES], score: i32, drift: i32) {
        if score > MOST / LARGER {
            self.add_at_most(tracks, score, drift);
        } else {
            // No size gains more, since the drift is not positive.
            self.add_to(&mut tracks[0], score + drift);
            self.add_to(&mut tracks[1], larger(score, drift));
        }
    }

    #[inline(never)]
    fn add_at_most(&mut self, [small, large]: &mut [Track; SIZES], score: i32, drift: i32) {
        self.add_to(small, (score + drift).min(MOST));
        self.add_to(large, larger(score, drift).min(MOST));
    }

    #[inline(never)]
    fn add_wider(&mut self, track: &mut Track, innovation: i32, held_steps: u8) {
        // These are less than the most that a step adds.
        let square = (innovation * innovation).min(WIDER_SQUARE);
        let nats = (square * WIDER_SLOPE - WIDER_NATS) >> (WIDER_BITS - NAT_BITS);
        self.add_to(track, if nats > 0 { nats >> held_steps } else { nats });
    }

    /// Adds nats to an alternative, which restarts at zero.
    #[inline(always)]
    fn add_to(&mut self, track: &mut Track, nats: i32) {
        let sum = i32::from(track.evidence) + nats;
        if sum <= 0 {
            *track = self.restarted;
        } else if sum < i32::from(self.strongest.evidence) {
            track.evidence = sum as u16;
        } else {
            self.set_strongest(track, sum);
        }
    }

    #[inline(never)]
    fn set_strongest(&mut self, track: &mut Track, sum: i32) {
        track.evidence = sum.min(i32::from(u16::MAX)) as u16;
        let Track { evidence, restarted } = *track;
        self.strongest = Strongest { evidence, restarted, address: ptr::from_ref(track).addr() };
    }
}
