//! A monitor on board: evidence, step by step, that the robot is no longer what its simulator knows.
//!
//! # Statistics
//!
//! **Null.** An unchanged robot follows the simulator's predictive law, which includes the simulator's own error. The
//! residual of a step is that error (fixed while a command is held), the robot's process noise (independent in each step)
//! and the tracker's noise (it enters two consecutive steps with opposite signs). [`Whitening`] is the Kalman filter of
//! this model, so an innovation is close to standard normal given the past.
//!
//! **Alternatives.** A direction predicts by how many standard deviations λ a change of the robot would shift the
//! innovations. λ depends on commands and predictions alone, so it is known before the measurement. It is proportional to
//! one of the [`SIGNALS`], which becomes weaker, or stronger where that makes sense. Each direction is tried in two
//! [`SIZES`]. Each channel also has an alternative that says only that its residuals are [wider](Alternative::Wider).
//!
//! **Evidence.** One step multiplies the evidence of an alternative by the likelihood ratio exp(λz - λ²/2), whose
//! expectation is at most one under the null. Innovations are clipped and a step counts at most [`MOST_NATS`], which only
//! lowers that expectation, so heavy tails and single failures of a tracker cannot raise an alarm. An alternative is
//! restarted when its evidence is below one (Page 1954, Biometrika 41). Its evidence is then at most the sum of the
//! e-processes that begin at each step (Shiryaev and Roberts; as e-detector: Shin, Ramdas and Rinaldo 2024, New England
//! Journal of Statistics in Data Science 2). With K alternatives this bounds the probability that an unchanged robot
//! raises an alarm within N steps by K N exp(-threshold), however often anyone looks (Ville's inequality), and the mean
//! time between false alarms by exp(threshold)/K steps.
//!
//! **When.** The restart before an alarm is the maximum-likelihood estimate of the step at which the change began.
//!
//! **Pauses.** A step without a measurement, or with one that is absurdly far from its prediction, adds no evidence. After
//! [`Law::most_paused_steps`] absurd ones they count as clipped evidence: then it is the robot that changed. The allowance
//! grows again by one step for each [`REGAINED_AFTER`] measured ones.
//!
//! # Costs
//!
//! Everything is in integers, and no product is wider than 32 bits: numbers first lose as many bits as their [`Factor`] does
//! not need. Each response of the wheels is filtered once per channel, and directions share the results. Functions that are
//! not inlined keep their numbers in the few registers of a small processor. A [`Law`] is a constant in flash; a
//! [`Monitor`] is the state in RAM, 256 bytes at most.

mod alternatives;
mod correction;
mod factor;
mod whitening;

use fixed::types::I16F16;

pub use alternatives::{
    ALTERNATIVES, Alternative, DIRECTIONS, HAS_OPPOSITE, LARGER, MOST_FACTOR, MOST_NATS, MOST_SIGN, RESPONSES, SIGNALS,
    SIZES,
};
pub use correction::{Correction, FUNCTIONS, MOST_SHIFT, POINTS};
pub use factor::{FACTOR_BITS, Factor};
pub use whitening::{Gains, HELD, TRAVELS, Whitening};

use alternatives::{Alternatives, MOST_RUN_STEPS, Travel};
use whitening::Filter;

/// Channels that the monitor compares: the way forward and the turn.
pub const CHANNELS: usize = 2;
/// Fractional bits of innovations, and of the shifts that directions predict for them.
pub const INNOVATION_BITS: u32 = 10;
/// Fractional bits of shares of full speed.
pub const SHARE_BITS: u32 = 14;
/// Fractional bits of residuals, in cm and degrees.
pub const RESIDUAL_BITS: u32 = 14;
/// Fractional bits of the travel of wheels.
pub const TRAVEL_BITS: u32 = 12;
/// Fractional bits of evidence, in nats.
pub const NAT_BITS: u32 = 10;
/// Number of measured steps after which one more step may be paused.
pub const REGAINED_AFTER: u8 = 32;
/// An innovation beyond this many standard deviations is absurd.
const ABSURD: i32 = 12 << INNOVATION_BITS;

/// Everything that a monitor knows about an unchanged robot besides its networks. A host computes it from a simulator file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law<'a> {
    /// Converts a command (percent of full power, Q16.16) to a fraction of full speed with [`SHARE_BITS`]; the result is below one.
    pub share_of_command: Factor,
    /// Convert predictions in Q16.16 (forward in cm, turn in degrees) to wheel travel as a fraction of the travel at full speed, with
    /// [`TRAVEL_BITS`], at most one: half the forward motion, and the arc of the turn at a wheel. By channel.
    pub travel: [Factor; CHANNELS],
    /// Difference of both wheels' travel, with [`TRAVEL_BITS`], up to which a robot has gone straight.
    pub straight_travel: i16,
    /// Nominal duration of a step, ms.
    pub step_ms: u16,
    /// 2^19 divided by `step_ms`.
    pub per_step_ms: i16,
    /// What is added to the predictions of the networks.
    pub correction: Correction<'a>,
    /// How residuals become innovations, by channel.
    pub whitening: [Whitening; CHANNELS],
    /// Shift of the residual of each channel per unit response of one wheel, under the smaller size of the alternative; in units of
    /// the residual, with [`TRAVEL_BITS`]; at most [`MOST_FACTOR`]. Indexed `[channel][response]`. In the turn channel, the left
    /// wheel has the opposite sign.
    pub factors: [[i16; RESPONSES]; CHANNELS],
    /// The sign of a wheel's travel, which has the factor of that, with [`TRAVEL_BITS`]; at most [`MOST_SIGN`]. It is less
    /// where a wheel hardly moves.
    pub sign: i16,
    /// Steps without evidence in a row that a failing tracker may cause.
    pub most_paused_steps: u8,
    /// Evidence at which the monitor raises an alarm, in nats with [`NAT_BITS`] fractional bits.
    pub threshold: u16,
}

/// What happened in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Left, right, previous left and previous right command, in percent of full power (-100..=100), Q16.16.
    pub commands: [I16F16; 4],
    /// Forward motion in cm and counter-clockwise turn in degrees during the step, as predicted by the networks; Q16.16.
    pub predicted: [I16F16; CHANNELS],
    /// The same as measured; `None` if the tracker lost the robot.
    pub measured: Option<[I16F16; CHANNELS]>,
    /// Duration of the step, ms.
    pub duration_ms: u16,
}

const _: () = assert!(core::mem::size_of::<Monitor>() <= 256, "the state of a monitor is too large");

/// The state of the monitor of one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Monitor {
    alternatives: Alternatives,
    filters: [Filter; CHANNELS],
    /// Sum and difference of the travel of both wheels in the step before.
    travel_before: [i16; 2],
    /// Steps since the run began, as far as they count.
    run_steps: u8,
    /// Steps for which the present command has been held.
    held_steps: u8,
    /// Whether nothing is known of the tracker's error.
    is_fresh: bool,
    pauses_left: u8,
    until_regained: u8,
    alarm: Option<Alarm>,
}

/// The first alarm of a monitor. It is copied as two words.
#[repr(align(4))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Alarm {
    /// What changed.
    pub alternative: Alternative,
    /// Number of measured steps from the beginning of the change to the alarm, at most 65535.
    pub after_steps: u16,
}

/// What the monitor made of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// The step was compared, and there has been no alarm.
    Quiet,
    /// The step added no evidence: it had no measurement, or an implausible one.
    Paused,
    /// There has been an alarm, in this step or before.
    Changed(Alarm),
}

impl Monitor {
    /// Returns the monitor of a robot that stands still at the beginning of a run.
    pub fn new(law: &Law) -> Self {
        Monitor {
            alternatives: Alternatives::new(),
            filters: [Filter::default(); CHANNELS],
            travel_before: [0; 2],
            run_steps: 0,
            held_steps: 0,
            is_fresh: true,
            pauses_left: law.most_paused_steps,
            until_regained: REGAINED_AFTER,
            alarm: None,
        }
    }

    /// Starts a new run, from rest. Keeps the evidence and the alarm.
    pub fn start_run(&mut self) {
        self.lose_track();
        self.travel_before = [0; 2];
        self.run_steps = 0;
    }

    /// Compares a step with the law.
    #[inline(never)]
    pub fn step(&mut self, law: &Law, step: &Step) -> Outcome {
        let is_compared = self.compare(law, step);
        match self.alarm {
            Some(alarm) => Outcome::Changed(alarm),
            None if is_compared => Outcome::Quiet,
            None => Outcome::Paused,
        }
    }

    /// Returns whether the step added evidence.
    fn compare(&mut self, law: &Law, step: &Step) -> bool {
        let [left, right, left_before, right_before] = step.commands;
        let is_held = left == left_before && right == right_before;
        let held_steps = if is_held { self.held_steps.wrapping_add(1).min(HELD as u8 - 1) } else { 0 };
        self.held_steps = held_steps;
        self.run_steps = self.run_steps.wrapping_add(1).min(MOST_RUN_STEPS);
        let travel = Travel::new(law, step.predicted, &mut self.travel_before);
        if !is_held {
            self.filters.iter_mut().for_each(Filter::change_command);
        }
        let is_fresh = self.is_fresh;
        self.is_fresh = false;
        let straight = i32::from(law.straight_travel);
        let has_turned = is_fresh || !(-straight..=straight).contains(&travel.across_before);
        if has_turned {
            // The turn itself has no axis that could turn.
            self.filters[0].forget_tracker();
        }
        let held = usize::from(held_steps);
        let gains = [
            &law.whitening[0].gains[usize::from(has_turned)][held],
            &law.whitening[1].gains[usize::from(is_fresh)][held],
        ];
        let Some(residuals) = residuals(law, step) else {
            self.lose_track();
            return false;
        };
        let [forward, turn] = &self.filters;
        let forward = forward.innovation(&law.whitening[0], gains[0], travel.along, residuals[0]);
        let turn = turn.innovation(&law.whitening[1], gains[1], travel.across, residuals[1]);
        let is_absurd = |innovation: i32| !(-ABSURD..=ABSURD).contains(&innovation);
        if self.pauses_left > 0 && (is_absurd(forward.0) || is_absurd(turn.0)) {
            self.pauses_left -= 1;
            self.lose_track();
            return false;
        }
        self.regain(law);
        let forward = self.filters[0].update(forward, gains[0]);
        let turn = self.filters[1].update(turn, gains[1]);
        let alarm = self.alternatives.gather(law, &travel, self.run_steps, [&forward, &turn], held_steps);
        if self.alarm.is_none() {
            self.alarm = alarm;
        }
        true
    }

    /// Returns the evidence of an alternative in nats, with [`NAT_BITS`] fractional bits; zero for one that does not exist.
    pub fn evidence(&self, alternative: Alternative) -> u16 {
        self.alternatives.evidence(alternative).unwrap_or(0)
    }

    /// Returns the first alarm, if there has been one.
    pub fn alarm(&self) -> Option<Alarm> {
        self.alarm
    }

    /// Forgets what was known of the tracker's error.
    #[inline(never)]
    fn lose_track(&mut self) {
        self.filters = [Filter::default(); CHANNELS];
        self.held_steps = 0;
        self.is_fresh = true;
    }

    fn regain(&mut self, law: &Law) {
        self.until_regained = self.until_regained.wrapping_sub(1);
        if self.until_regained == 0 {
            self.until_regained = REGAINED_AFTER;
            self.pauses_left = self.pauses_left.saturating_add(1).min(law.most_paused_steps);
        }
    }
}

/// Returns the residuals of a step with [`RESIDUAL_BITS`]; `None` without a measurement, or if its duration is far off.
#[inline(never)]
fn residuals(law: &Law, step: &Step) -> Option<[i32; CHANNELS]> {
    let late = i32::from(law.step_ms) - i32::from(step.duration_ms);
    let measured = step.measured?;
    let most_late = i32::from(law.step_ms / 2);
    if !(-most_late..=most_late).contains(&late) {
        return None;
    }
    let mut residuals = law.correction.of(law.share_of_command, &step.commands);
    // First order in the deviation of the duration, which is small.
    let stretch = (late * i32::from(law.per_step_ms)) >> 7;
    for (residual, (measured, predicted)) in residuals.iter_mut().zip(measured.into_iter().zip(step.predicted)) {
        let (measured, predicted) = (measured.to_bits(), predicted.to_bits());
        let stretched = ((measured >> 12) * stretch) >> (16 - RESIDUAL_BITS);
        *residual = (measured >> (16 - RESIDUAL_BITS)) - (predicted >> (16 - RESIDUAL_BITS)) + stretched - *residual;
    }
    Some(residuals)
}

#[cfg(test)]
mod tests;
