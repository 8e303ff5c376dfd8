//! The constants of a simulator's monitor on board ([`mindgap_core::monitor`]), from what its training logs said.

mod correction;
pub mod directions;
pub mod findings;
pub mod replay;
mod whitening;

use mindgap_core::monitor::{ALTERNATIVES, CHANNELS, Correction, Direction, Law, NAT_BITS, POINTS, Whitening};

use super::Simulator;
use super::baseline::{Baseline, MotionModel};
use super::ensemble::{Ensemble, HeldMotion};
use super::motion::MotionNetworks;
use super::nominal::MotionBias;
use nalgebra::DMatrix;

use directions::{DIRECTIONS, Named};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_logs::Robot;

/// Functions of a correction and the power of two of their values.
type Functions = ([[i16; POINTS]; 6], u8);

/// The channels that a monitor compares.
pub const AXES: [Axis; CHANNELS] = [Axis::Forward, Axis::Turn];
/// Steps for which the bound on false alarms is stated, and that bound.
pub const LIFETIME_STEPS: f64 = 1e4;
/// See [`LIFETIME_STEPS`].
pub const FALSE_ALARMS: f64 = 0.02;
/// A tracker may fail for this long, ms.
const FAILING_MS: f64 = 1000.0;
/// A turn up to which a robot has gone straight, degrees.
const STRAIGHT_DEG: f64 = 15.0;

/// The constants of a monitor, which own what a [`Law`] borrows.
#[derive(Clone, Debug, PartialEq)]
pub struct MonitorLaw {
    /// The robot.
    pub robot: Robot,
    correction: [Functions; CHANNELS],
    whitening: [Whitening; CHANNELS],
    directions: Vec<Direction>,
    /// Size of each direction's smallest alternative, in its unit.
    pub sizes: Vec<f64>,
    share_of_command: i32,
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
        let correction = correction::functions(known.bias, &known.precision)
            .ok_or_else(|| Error::new("the correction of the simulator's motion does not fit the monitor's numbers"))?;
        let share_of_command = libm::round(libm::ldexp(share, 30));
        if share_of_command >= f64::from(i32::MAX) {
            return Err(Error::new("the robot's commands are too small for the monitor's numbers"));
        }
        let steps = directions::typical_steps(&known.commands, &networks, &robot);
        let units = [0, 1].map(|i: usize| noise[i].unit());
        let (directions, sizes) = directions::scaled(&steps, &whitening, units, &robot);
        Ok(MonitorLaw { robot, correction, whitening, directions, sizes, share_of_command: share_of_command as i32 })
    }

    /// Returns the constants as the monitor takes them.
    pub fn law(&self) -> Law<'_> {
        let full_cm = full_cm(&self.robot);
        let half_track_cm_per_deg = 0.5 * self.robot.track_cm * 1f64.to_radians();
        let q28 = |x: f64| libm::round(libm::ldexp(x, 28)).min(f64::from(i32::MAX)) as i32;
        let straight = STRAIGHT_DEG.to_radians() * self.robot.track_cm / full_cm;
        Law {
            share_of_command: self.share_of_command,
            travel: [q28(1.0 / full_cm), q28(half_track_cm_per_deg / full_cm)],
            straight_travel: libm::round(libm::ldexp(straight, 12)) as i32,
            step_ms: self.robot.step_ms as u16,
            per_step_ms: libm::round(libm::ldexp(1.0 / self.robot.step_ms, 24)) as i32,
            correction: self.correction.each_ref().map(|(functions, shift)| Correction { functions, shift: *shift }),
            whitening: self.whitening,
            directions: &self.directions,
            most_paused_steps: libm::ceil(FAILING_MS / self.robot.step_ms).clamp(1.0, 255.0) as u8,
            threshold: libm::round(libm::ldexp(threshold_nats(), NAT_BITS as i32)) as u16,
        }
    }

    /// Returns the names of the directions, in the order of the law.
    pub fn names(&self) -> &'static [Named] {
        DIRECTIONS
    }
}

/// Evidence of one alternative at which a monitor raises an alarm: an unchanged robot then does so in at most
/// [`FALSE_ALARMS`] of the lifetimes of [`LIFETIME_STEPS`].
pub fn threshold_nats() -> f64 {
    libm::log(ALTERNATIVES as f64 * LIFETIME_STEPS / FALSE_ALARMS)
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
