//! A monitor on board: evidence, step by step, that the robot is no longer what its simulator knows.
//!
//! # Statistics
//!
//! **Null.** An unchanged robot follows the simulator's predictive law, which includes the simulator's own error. The
//! residual of a step is that error (fixed while a command is held), the robot's process noise (independent in each step)
//! and the tracker's noise (it enters two consecutive steps with opposite signs). [`Whitening`] is the Kalman filter of
//! this model, so an innovation is close to standard normal given the past.
//!
//! **Alternatives.** A [`Direction`] predicts by how many standard deviations λ a change of the robot would shift the
//! innovations. λ depends on commands and predictions alone, so it is known before the measurement. Each direction is
//! tried in [`SIZES`] sizes, and in both signs where both make sense. Each channel also has an alternative that says only
//! that its residuals are [wider](WIDER).
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
//! Everything is in integers, and no number is wider than 32 bits but for five products. A [`Law`] is a constant in flash;
//! a [`Monitor`] is the state in RAM, 256 bytes at most.

mod alternatives;
mod correction;
mod whitening;

use fixed::types::I16F16;

use crate::fixed_point::product;
pub use alternatives::{
    ALTERNATIVES, Alternative, Direction, MOST_DIRECTIONS, MOST_FACTOR, MOST_NATS, Response, SIZES, WIDER,
};
pub use correction::{Correction, POINTS};
pub use whitening::{Gains, HELD, TRAVELS, Whitening};

use alternatives::{Alternatives, Responses, Weights};
use whitening::Filter;

/// Channels that the monitor compares: the way forward and the turn.
pub const CHANNELS: usize = 2;
/// Fractional bits of innovations, and of the shifts that directions predict for them.
pub const INNOVATION_BITS: u32 = 10;
/// Fractional bits of shares of full speed.
pub const SHARE_BITS: u32 = 14;
/// Fractional bits of evidence, in nats.
pub const NAT_BITS: u32 = 10;
/// Number of measured steps after which one more step may be paused.
pub const REGAINED_AFTER: u8 = 32;
/// An innovation beyond this many standard deviations is absurd.
const ABSURD: i32 = 12 << INNOVATION_BITS;

/// Everything that a monitor knows about an unchanged robot besides its networks. A host computes it from a simulator file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law<'a> {
    /// Factor from a command in Q16.16 to a share of full speed, with 30 fractional bits.
    pub share_of_command: i32,
    /// Factors that make wheel travel of predictions in Q16.16: of half the way forward, and of the turn at a wheel. Travel
    /// at full speed is one; both have 32 - 16 + 12 fractional bits.
    pub travel: [i32; CHANNELS],
    /// Difference of both wheels' travel, with 12 fractional bits, up to which a robot has gone straight.
    pub straight_travel: i32,
    /// Nominal duration of a step, ms.
    pub step_ms: u16,
    /// 2^24 divided by `step_ms`.
    pub per_step_ms: i32,
    /// What is added to the predictions of the networks, by channel.
    pub correction: [Correction<'a>; CHANNELS],
    /// How residuals become innovations, by channel.
    pub whitening: [Whitening; CHANNELS],
    /// Directions in which the robot may change, at most [`MOST_DIRECTIONS`].
    pub directions: &'a [Direction],
    /// Steps without evidence in a row that a failing tracker may cause.
    pub most_paused_steps: u8,
    /// Evidence at which the monitor raises an alarm, in nats with [`NAT_BITS`] fractional bits.
    pub threshold: u16,
}

/// What happened in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Left, right, previous left and previous right command.
    pub commands: [I16F16; 4],
    /// Way forward in cm and turn to the left in degrees by the networks.
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
    /// Travel of the wheels in the step before.
    travel_before: [i32; 2],
    /// Steps since the run began.
    run_steps: u16,
    /// Steps for which the present command has been held.
    held_steps: u8,
    /// Whether nothing is known of the tracker's error.
    is_fresh: bool,
    pauses_left: u8,
    until_regained: u8,
    alarm: Option<Alarm>,
}

/// The first alarm of a monitor.
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
    /// The step added no evidence: it was not measured, or absurdly.
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

    /// A new run begins, from rest. Evidence and alarm stay.
    pub fn start_run(&mut self) {
        self.lose_track();
        self.travel_before = [0; 2];
        self.run_steps = 0;
    }

    /// Compares a step with the law.
    pub fn step(&mut self, law: &Law, step: &Step) -> Outcome {
        let [left, right, left_before, right_before] = step.commands;
        let is_held = (left, right) == (left_before, right_before);
        self.held_steps = if is_held { self.held_steps.saturating_add(1).min(HELD as u8 - 1) } else { 0 };
        self.run_steps = self.run_steps.saturating_add(1);
        let travel = travel(law, step.predicted);
        let responses = Responses::new(travel, self.travel_before, self.run_steps);
        let [turned, turn] = [self.travel_before, travel].map(|[left, right]| (right - left).abs());
        let sum = (travel[0] + travel[1]).abs();
        self.travel_before = travel;
        if !is_held {
            self.filters.iter_mut().for_each(Filter::change_command);
        }
        let has_turned = self.is_fresh || turned > law.straight_travel;
        if has_turned {
            // The turn itself has no axis that could turn.
            self.filters[0].forget_tracker();
        }
        let held = usize::from(self.held_steps).min(HELD - 1);
        let gains = [
            &law.whitening[0].gains[usize::from(has_turned)][held],
            &law.whitening[1].gains[usize::from(self.is_fresh)][held],
        ];
        self.is_fresh = false;
        let widths = [law.whitening[0].width(sum), law.whitening[1].width(turn)];
        let weights = [self.filters[0].weights(gains[0], widths[0]), self.filters[1].weights(gains[1], widths[1])];
        let Some(innovations) = self.innovations(law, step, gains, weights) else {
            return self.alarm.map_or(Outcome::Paused, Outcome::Changed);
        };
        // A lasting shift is partly taken for the simulator's own error.
        let lasting = |weights: Weights, gains: &Gains| Weights {
            residual: (weights.residual * i32::from(gains.shift)) >> 14,
            ..weights
        };
        let weights = [lasting(weights[0], gains[0]), lasting(weights[1], gains[1])];
        if let Some((alternative, after_steps)) =
            alternatives::gather(&mut self.alternatives, law, &responses, innovations, weights, self.held_steps)
        {
            self.alarm.get_or_insert(Alarm { alternative, after_steps });
        }
        self.alarm.map_or(Outcome::Quiet, Outcome::Changed)
    }

    /// Returns the evidence of an alternative in nats, with [`NAT_BITS`] fractional bits; zero for one that does not exist.
    pub fn evidence(&self, alternative: Alternative) -> u16 {
        self.alternatives.tracks.get(alternative.index()).map_or(0, |track| track.evidence)
    }

    /// Returns the first alarm, if there has been one.
    pub fn alarm(&self) -> Option<Alarm> {
        self.alarm
    }

    /// Returns the innovations of a step, clipped; `None` if it is paused.
    fn innovations(
        &mut self,
        law: &Law,
        step: &Step,
        gains: [&Gains; CHANNELS],
        weights: [Weights; CHANNELS],
    ) -> Option<[i32; CHANNELS]> {
        let late = i32::from(law.step_ms) - i32::from(step.duration_ms);
        let Some(measured) = step.measured.filter(|_| 2 * late.abs() <= i32::from(law.step_ms)) else {
            self.lose_track();
            return None;
        };
        let shares = step.commands.map(|command| (product(command.to_bits(), law.share_of_command) >> 32) as i32);
        let corrections = correction::corrections(&law.correction, shares);
        // First order in the deviation of the duration, which is small; with 14 fractional bits.
        let stretch = late.saturating_mul(law.per_step_ms) >> 10;
        let innovation = |channel: usize, measured: I16F16, predicted: I16F16| {
            let measured = measured.to_bits();
            let scaled = measured.saturating_add((product(measured, stretch) >> 14) as i32);
            let predicted = predicted.to_bits().saturating_add(corrections[channel]);
            let residual = law.whitening[channel].standardised(scaled.saturating_sub(predicted));
            self.filters[channel].innovation(residual, weights[channel])
        };
        let ([forward, turn], [predicted_forward, predicted_turn]) = (measured, step.predicted);
        let innovations = [innovation(0, forward, predicted_forward), innovation(1, turn, predicted_turn)];
        if innovations.iter().any(|z| z.abs() > ABSURD) && self.pauses_left > 0 {
            self.pauses_left -= 1;
            self.lose_track();
            return None;
        }
        self.regain(law);
        let innovations = innovations.map(alternatives::clipped);
        self.filters[0].update(innovations[0], gains[0]);
        self.filters[1].update(innovations[1], gains[1]);
        Some(innovations)
    }

    /// Forgets what was known of the tracker's error.
    fn lose_track(&mut self) {
        self.filters = [Filter::default(); CHANNELS];
        self.held_steps = 0;
        self.is_fresh = true;
    }

    fn regain(&mut self, law: &Law) {
        self.until_regained = self.until_regained.saturating_sub(1);
        if self.until_regained == 0 {
            self.until_regained = REGAINED_AFTER;
            self.pauses_left = self.pauses_left.saturating_add(1).min(law.most_paused_steps);
        }
    }
}

/// Returns the predicted travel of the left and the right wheel, with 12 fractional bits.
fn travel(law: &Law, [forward, turn]: [I16F16; CHANNELS]) -> [i32; 2] {
    let along = (product(forward.to_bits(), law.travel[0]) >> 32) as i32;
    let across = (product(turn.to_bits(), law.travel[1]) >> 32) as i32;
    const MOST: i32 = 2 << 12;
    [along.saturating_sub(across), along.saturating_add(across)].map(|travel| travel.clamp(-MOST, MOST))
}

#[cfg(test)]
mod tests;
