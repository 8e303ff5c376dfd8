//! The constants of a simulator's monitor on board ([`mindgap_core::monitor`]), from what its training logs said.

mod correction;
pub mod directions;
pub mod findings;
pub mod replay;
mod whitening;

use mindgap_core::monitor::{
    ALTERNATIVES, CHANNELS, Correction, FACTOR_BITS, FUNCTIONS, Factor, Law, NAT_BITS, POINTS, SHARE_BITS, TRAVEL_BITS,
    Whitening,
};

use super::Simulator;
use super::baseline::{Baseline, MotionModel};
use super::ensemble::{Ensemble, HeldMotion};
use super::motion::MotionNetworks;
use super::nominal::MotionBias;
use nalgebra::DMatrix;

use directions::Scaled;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_logs::Robot;

/// Functions of a correction for each channel.
type Functions = [[[i16; CHANNELS]; POINTS]; FUNCTIONS];

/// The channels that a monitor compares.
pub const AXES: [Axis; CHANNELS] = [Axis::Forward, Axis::Turn];
/// Steps for which the bound on false alarms is stated, and that bound.
pub const LIFETIME_STEPS: f64 = 1e4;
/// See [`LIFETIME_STEPS`].
pub const FALSE_ALARMS: f64 = 0.01;
/// A tracker may fail for this long, ms.
const FAILING_MS: f64 = 1000.0;
/// A turn up to which a robot has gone straight, degrees.
const STRAIGHT_DEG: f64 = 15.0;

/// The constants of a monitor, which own what a [`Law`] borrows.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitorLaw {
    /// The robot.
    pub robot: Robot,
    functions: Functions,
    /// Power of two of their values.
    shifts: [u8; CHANNELS],
    whitening: [Whitening; CHANNELS],
    /// How large the alternatives of each direction are.
    pub directions: Scaled,
    share_of_command: Factor,
    travel: [Factor; CHANNELS],
}

impl MonitorLaw {
    /// Computes the constants of a trained simulator's monitor.
    ///
    /// # Errors
    /// When the simulator does not say its own error, when its networks see commands behind a filter or with effects, or when a number
    /// has no place in fixed point.
    pub fn of(simulator: &Simulator) -> Result<Self> {
        simulator.need_no_filter()?;
        if let Some(added) = simulator.added.first() {
            let what = format!("the simulator has the effect {}, which boards do not compute", added.effect);
            return Err(Error::new(format!("{what}: train again on runs of the robot as it is now")));
        }
        let networks = MotionNetworks::of(simulator)?;
        let known = Known::of(simulator).ok_or_else(|| {
            Error::new("the simulator does not state its own error: train it again with `mindgap train LOGS --out SIM`")
        })?;
        let robot = simulator.robot;
        let share = f64::from(networks.scale().share());
        let noise = whitening::Noise::of(&known, robot);
        let whitening = noise.map(|noise| noise.whitening()).into_iter().collect::<Option<Vec<_>>>();
        let whitening: [Whitening; CHANNELS] = whitening
            .and_then(|w| w.try_into().ok())
            .ok_or_else(|| Error::new("the noise of the simulator's motion does not fit the monitor's numbers"))?;
        let (functions, shifts) = correction::functions(known.bias, &known.precision)
            .ok_or_else(|| Error::new("the correction of the simulator's motion does not fit the monitor's numbers"))?;
        let share_of_command = factor(share, 16, SHARE_BITS, (1 << SHARE_BITS) - 1)
            .ok_or_else(|| Error::new("the robot's commands do not fit the monitor's numbers"))?;
        let half_track_cm_per_deg = 0.5 * robot.track_cm * 1f64.to_radians();
        let travel =
            [1.0, half_track_cm_per_deg].map(|cm| factor(cm / full_cm(&robot), 16, TRAVEL_BITS, 1 << TRAVEL_BITS));
        let [Some(along), Some(across)] = travel else {
            return Err(Error::new("the robot's steps do not fit the monitor's numbers"));
        };
        let steps = directions::typical_steps(&known.commands, &networks, &robot);
        let units = [0, 1].map(|i: usize| noise[i].unit());
        let directions = Scaled::of(&steps, &whitening, units, &robot);
        Ok(MonitorLaw { robot, functions, shifts, whitening, directions, share_of_command, travel: [along, across] })
    }

    /// Returns the constants as the monitor takes them.
    pub fn law(&self) -> Law<'_> {
        let straight = STRAIGHT_DEG.to_radians() * self.robot.track_cm / full_cm(&self.robot);
        let most = f64::from(i16::MAX);
        Law {
            share_of_command: self.share_of_command,
            travel: self.travel,
            straight_travel: libm::round(libm::ldexp(straight, TRAVEL_BITS as i32)).min(most) as i16,
            step_ms: self.robot.step_ms as u16,
            per_step_ms: libm::round(libm::ldexp(1.0 / self.robot.step_ms, 19)).min(most) as i16,
            correction: Correction { functions: &self.functions, shifts: self.shifts },
            whitening: self.whitening,
            factors: self.directions.factors,
            sign: self.directions.sign,
            most_paused_steps: libm::ceil(FAILING_MS / self.robot.step_ms).clamp(1.0, 255.0) as u8,
            threshold: libm::round(libm::ldexp(threshold_nats(), NAT_BITS as i32)) as u16,
        }
    }
}

/// Evidence of one alternative at which a monitor raises an alarm: an unchanged robot then does so in at most
/// [`FALSE_ALARMS`] of the lifetimes of [`LIFETIME_STEPS`].
pub fn threshold_nats() -> f64 {
    libm::log(ALTERNATIVES as f64 * LIFETIME_STEPS / FALSE_ALARMS)
}

/// Returns a factor that also changes the number of fractional bits, and whose product is at most `most`; none where it does not
/// fit.
fn factor(x: f64, from_bits: u32, to_bits: u32, most: i32) -> Option<Factor> {
    // The mantissa is from one half to one; the factor is twice as large, and its shift makes up for that.
    let (mantissa, exponent) = libm::frexp(libm::ldexp(x, to_bits as i32 - from_bits as i32));
    let shift = u8::try_from(1 - exponent).ok().filter(|shift| *shift < 32)?;
    let factor = libm::round(libm::ldexp(mantissa, FACTOR_BITS as i32 + 1)).min(f64::from(i16::MAX)) as i16;
    Some(Factor { factor, shift, most: ((most << FACTOR_BITS) / i32::from(factor)) as i16 })
}

/// Returns what a wheel covers in a step at full speed, cm.
fn full_cm(robot: &Robot) -> f64 {
    robot.full_speed_cm_s * robot.step_ms / 1000.0
}

/// What a simulator knows of its error.
struct Known<'s> {
    bias: &'s MotionBias,
    precision: DMatrix<f64>,
    model: MotionModel<'s>,
    ensemble: &'s Ensemble,
    /// Commands of the training logs.
    commands: Vec<[f64; 2]>,
}

impl<'s> Known<'s> {
    fn of(simulator: &'s Simulator) -> Option<Self> {
        let bias = simulator.reference.as_ref()?.motion.as_ref()?;
        let precision = bias.precision.as_ref()?;
        let ensemble = simulator.ensemble.as_ref()?;
        let baseline = Baseline::at_posterior_mean(simulator).ok()?;
        let mut model = baseline.motion?;
        // A board has the networks and their correction, and no process over commands.
        if let MotionModel::Learned { member, open, .. } = &mut model {
            *member = None;
            open.as_ref()?;
        }
        let commands: Vec<[f64; 2]> = ensemble.evidence.iter().map(|e| e.command.map(f64::from)).collect();
        let precision = correction::gram(precision)?;
        (commands.len() > 1).then_some(Known { bias, precision, model, ensemble, commands })
    }
}

/// Returns the mean of a motion over commands.
fn mean_over(commands: &[[f64; 2]], motion: impl Fn([f64; 2]) -> Motion<f64>) -> Motion<f64> {
    let sum = commands.iter().fold(Motion::ZERO, |sum, command| sum + motion(*command));
    sum.scaled(1.0 / commands.len() as f64)
}
