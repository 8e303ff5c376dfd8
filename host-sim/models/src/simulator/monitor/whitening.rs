//! The gains of the monitor's filter, from the noise and the own error that the simulator states.

use mindgap_core::monitor::{Gains, HELD, INNOVATION_BITS, RESIDUAL_BITS, TRAVELS, Whitening};

use super::{AXES, Known, correction, factor, full_cm, mean_over};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_logs::Robot;

/// A command that was not logged is about this far from one that was, percent of full speed.
const BETWEEN_PERCENT: f64 = 5.0;

/// Variances are taken this much larger than the simulator states them, since they are estimates from logs themselves.
const MARGIN: f64 = 1.3;

/// The most units that a residual counts, so that products have room.
const MOST_UNITS: i32 = 31;

/// Smallest unit of residuals, cm or degrees, that the numbers on board hold. Less noise counts as this much.
const LEAST_UNIT: f64 = 1.0 / 15.0;

/// Variances of one channel, in squared cm or degrees.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// Of the simulator's own error for a command.
    error: f64,
    /// Of the robot's process noise in a step, for the typical step.
    process: f64,
    /// The same by travel in this channel, in eighths of full speed.
    process_by_travel: [f64; TRAVELS],
    /// Of the tracker's error in one pose.
    tracker: f64,
}

impl Noise {
    /// Of both channels.
    pub fn of(known: &Known, robot: Robot) -> [Noise; 2] {
        let noise = &known.ensemble.noise;
        let off = BETWEEN_PERCENT / (100.0 * f64::from(known.bias.scale.share()));
        let near: Vec<[f64; 2]> = known.commands.iter().map(|[l, r]| [l + off, r - off]).collect();
        let own = |command: [f64; 2]| known.model.own_error(command, command);
        let own = mean_over(&near, own);
        let predicted = |command: [f64; 2]| known.model.step(command, command).turn_in_degrees();
        let full_deg = (2.0 * full_cm(&robot) / robot.track_cm).to_degrees();
        AXES.map(|axis| {
            let process = |motion: Motion<f64>| noise.step_variance(motion, axis);
            let mean = mean_over(&known.commands, |command| Motion::splat(process(predicted(command))));
            let own = if axis == Axis::Turn { own[axis] * 1f64.to_degrees() * 1f64.to_degrees() } else { own[axis] };
            let by_travel = |eighth: usize| {
                let share = (eighth as f64 + 0.5) / TRAVELS as f64;
                process(match axis {
                    Axis::Turn => Motion { turn: share * full_deg, ..Motion::ZERO },
                    _ => Motion { forward: share * full_cm(&robot), ..Motion::ZERO },
                })
            };
            let first = noise.first_step[axis];
            Noise {
                error: own + first * first + correction::misfit(known.bias, &known.precision, axis),
                process: mean.forward,
                process_by_travel: std::array::from_fn(by_travel),
                tracker: noise.tracker[axis],
            }
        })
    }

    /// Returns the standard deviation of a residual, which is the unit of residuals.
    pub fn unit(&self) -> f64 {
        (MARGIN * (self.error + self.process + 2.0 * self.tracker)).sqrt().max(LEAST_UNIT)
    }

    /// Returns the filter; none where a number does not fit.
    pub fn whitening(&self) -> Option<Whitening> {
        let scale = factor(1.0 / self.unit(), RESIDUAL_BITS, INNOVATION_BITS, MOST_UNITS << INNOVATION_BITS)?;
        let known = self.gains(true)?;
        let unknown = self.gains(false)?;
        let width = |process: f64| {
            let typical = self.error + self.process + 2.0 * self.tracker;
            (typical / (typical - self.process + process)).sqrt()
        };
        let by_travel = self.process_by_travel.map(|process| fixed(width(process).min(1.9)).unwrap_or(1 << 14));
        Some(Whitening { scale, gains: [known, unknown], by_travel })
    }

    fn gains(&self, is_tracker_known: bool) -> Option<[Gains; HELD]> {
        let unit = self.unit();
        let [error, process, tracker] = [self.error, self.process, self.tracker].map(|v| MARGIN * v / (unit * unit));
        let process = process + (1.0 - error - process - 2.0 * tracker).max(0.0);
        // Of the tracker's error at the beginning of the step, after a first step from nothing.
        let mut begin = tracker;
        if is_tracker_known {
            for _ in 0..2 {
                begin = tracker - tracker * tracker / (error + begin + process + tracker);
            }
        }
        let (mut own, mut both) = (error, 0.0);
        let mut taken_in = 0.0;
        let mut gains = Vec::with_capacity(HELD);
        for _ in 0..HELD {
            let variance = own + begin - 2.0 * both + process + tracker;
            let deviation = variance.sqrt();
            let gain = (own - both) / variance;
            gains.push(Gains {
                precision: fixed(1.0 / deviation)?,
                error: fixed(gain * deviation)?,
                tracker: fixed(tracker / deviation)?,
                shift: fixed(1.0 - taken_in)?,
            });
            taken_in += gain * (1.0 - taken_in);
            own -= gain * gain * variance;
            both = -gain * tracker;
            begin = tracker - tracker * tracker / variance;
        }
        gains.try_into().ok()
    }
}

/// Returns a number with 14 fractional bits.
fn fixed(x: f64) -> Option<i16> {
    let bits = libm::round(libm::ldexp(x, 14));
    (bits.abs() <= f64::from(i16::MAX)).then_some(bits as i16)
}

/// Returns the standard deviation of the innovation that these gains assume, in units of residuals.
pub fn deviation(gains: &Gains) -> f64 {
    libm::ldexp(1.0, 14) / f64::from(gains.precision)
}
