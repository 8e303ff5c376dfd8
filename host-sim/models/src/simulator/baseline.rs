//! The simulator as the diagnosis sees it: networks, their known bias, and their nominal noise.

use std::sync::Arc;

use crate::effects::Candidate;
use crate::effects::applied::AppliedEffect;
use crate::effects::chain::EffectChain;
use crate::effects::drive_filter::DriveFilter;
use crate::effects::witness::{OnCounters, on_counters, on_gyro};
use crate::simulator::ensemble::command_scale::Percent;
use crate::simulator::ensemble::{CommandScale, HeldMotion, Member, Posterior};
use crate::simulator::motion::MotionNetworks;
use crate::simulator::nominal::motion_bias::Precision;
use crate::simulator::nominal::{MotionBias, WheelLaw};
use crate::simulator::{Learned, Simulator};
use crate::sonar::SensorLaw;
use crate::sonar::familiar::FamiliarPoses;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::motion::Motion;
use mindgap_logs::Robot;

/// The models of motion and sonar without any gap.
#[derive(Clone)]
pub struct Baseline<'s> {
    /// The robot.
    pub robot: Robot,
    /// The motion, if the simulator knows it.
    pub motion: Option<MotionModel<'s>>,
    /// The law of the sensor, if the simulator knows it.
    pub sonar: Option<SensorLaw>,
    /// Fraction of the noise of its echo rate and of its readings that is a function of the place, as far as it is known.
    pub place_bound: [f64; 2],
    /// Readings that repeat at single poses.
    pub familiar: Option<&'s FamiliarPoses>,
    /// Effects that were added to the simulator before.
    pub applied: Vec<AppliedEffect>,
}

/// How commands become motion, and its noise.
#[derive(Clone)]
pub enum MotionModel<'s> {
    /// As learned from logs.
    Learned {
        /// The filter behind which the networks see commands.
        filter: DriveFilter,
        /// The networks.
        networks: MotionNetworks<'s>,
        /// Their bias and noise.
        reference: &'s MotionBias,
        /// How far commands turn the wheels, if rotation counters were logged.
        wheels: Option<&'s WheelLaw>,
        /// Least and largest command that they know.
        commands: [f64; 2],
        /// What the training logs leave open about the robot; `member` is its mean.
        open: Option<Arc<Posterior>>,
        /// The robot whose bias is added, if one is known.
        member: Option<Member>,
        /// Fraction of the noise of forward, lateral and turn that is the robot's own and not the tracker's, 0 to 1.
        process_noise_fraction: Motion<f64>,
    },
    /// The textbook's differential drive.
    Kinematic {
        /// The robot.
        robot: Robot,
        /// Standard deviations of the motion.
        scatter: Motion<f64>,
    },
}

impl<'s> Baseline<'s> {
    /// Returns the baseline of a trained simulator.
    ///
    /// # Errors
    /// When the simulator was written without the reference that a diagnosis needs.
    pub fn learned(simulator: &'s Simulator) -> Result<Self> {
        let reference = simulator.reference.as_ref().ok_or_else(|| {
            Error::new("the simulator file does not say how its training logs scattered: train it again")
        })?;
        let learned_wheels = reference.wheels.as_ref();
        let drive = simulator.motion_networks().zip(reference.motion.as_ref());
        let motion = drive.map(|(networks, reference)| MotionModel::Learned {
            filter: simulator.filter,
            networks,
            reference,
            wheels: learned_wheels,
            commands: simulator.commands.map(f64::from),
            open: None,
            member: None,
            process_noise_fraction: Motion {
                forward: process_noise_fraction(&simulator.forward),
                lateral: process_noise_fraction(&simulator.lateral),
                turn: process_noise_fraction(&simulator.turn),
            },
        });
        Ok(Baseline {
            robot: simulator.robot,
            motion,
            sonar: simulator.sensor_law(),
            place_bound: reference.place_bound,
            familiar: reference.familiar.as_ref(),
            applied: simulator.added.iter().filter(|added| added.sensor.is_none()).cloned().collect(),
        })
    }

    /// Returns the baseline of a trained simulator with its posterior mean robot. Networks are biased where logs are sparse,
    /// which is where controllers drive, and effects would be fitted to that bias.
    ///
    /// # Errors
    /// As [`learned`](Self::learned).
    pub fn at_posterior_mean(simulator: &'s Simulator) -> Result<Self> {
        let mut baseline = Baseline::learned(simulator)?;
        if let Some(MotionModel::Learned { member, open, .. }) = &mut baseline.motion {
            *open = simulator.trained().map(Arc::new);
            *member = open.as_ref().map(|open| open.mean());
        }
        Ok(baseline)
    }

    /// Returns its filter, and the effects that were added to the simulator before.
    pub fn chain(&self) -> EffectChain {
        self.chain_with(&[])
    }

    /// Returns the same with further effects.
    pub fn chain_with(&self, further: &[AppliedEffect]) -> EffectChain {
        let filter = self.motion.as_ref().map_or_else(DriveFilter::default, MotionModel::filter);
        EffectChain::of(filter, &[self.applied.as_slice(), further].concat(), &self.robot)
    }

    /// Returns the chain up to the rims, as rotation counters see it.
    pub fn chain_to_the_rims(&self) -> EffectChain {
        let filter = self.motion.as_ref().map_or_else(DriveFilter::default, MotionModel::filter);
        self.chain_of(filter.up_to_the_rims(), |added| on_counters(added) != OnCounters::Hidden)
    }

    /// Returns the chain up to the body, as a gyro sees it.
    pub fn chain_to_the_body(&self) -> EffectChain {
        let filter = self.motion.as_ref().map_or_else(DriveFilter::default, MotionModel::filter);
        self.chain_of(filter, on_gyro)
    }

    /// Returns a filter and those of the effects that were added before which are seen.
    fn chain_of(&self, filter: DriveFilter, is_seen: impl Fn(&Candidate) -> bool) -> EffectChain {
        let resolved = |added: &&AppliedEffect| added.resolve(&self.robot).is_ok_and(|(added, _)| is_seen(&added));
        let seen: Vec<AppliedEffect> = self.applied.iter().filter(resolved).cloned().collect();
        EffectChain::of(filter, &seen, &self.robot)
    }

    /// Returns the number of steps that the motion was learned from, if known; none for the textbook.
    pub fn trained_on(&self) -> Option<f64> {
        let MotionModel::Learned { reference, .. } = self.motion.as_ref()? else { return None };
        reference.precision.as_ref().and_then(Precision::steps)
    }
}

impl MotionModel<'_> {
    /// Returns the filter behind which it sees commands.
    pub fn filter(&self) -> DriveFilter {
        match self {
            MotionModel::Learned { filter, .. } => *filter,
            MotionModel::Kinematic { .. } => DriveFilter::default(),
        }
    }

    /// Predicts a step for the commands now and before, as they come out of its filter.
    pub fn step(&self, now: [f64; 2], before: [f64; 2]) -> Motion<f64> {
        match self {
            MotionModel::Learned { .. } if self.rests(now) && self.rests(before) => Motion::ZERO,
            MotionModel::Learned { networks, reference, commands, member, .. } => {
                let [now, before] = [now, before].map(|command| command.map(|c| c.clamp(commands[0], commands[1])));
                // For a held command this is the whole prediction, and the networks need not be evaluated.
                if let Some(member) = member.as_ref().filter(|_| now == before) {
                    return member.motion(now).turn_in_radians();
                }
                let speeds = [now[0], now[1], before[0], before[1]];
                let learned = networks.evaluate(speeds.map(|c| c as f32)).map(f64::from);
                learned + (reference.correction(&speeds) + self.beyond(now))
            }
            MotionModel::Kinematic { robot, .. } => {
                let way_cm = rolled_cm(robot, now);
                let turn = (way_cm[1] - way_cm[0]) / robot.track_cm;
                let arc_cm = 0.5 * (way_cm[0] + way_cm[1]);
                // The chord of an arc.
                let half = 0.5 * turn;
                let chord_cm = if half.abs() < 1e-9 { arc_cm } else { arc_cm * libm::sin(half) / half };
                Motion { forward: chord_cm * libm::cos(half), lateral: chord_cm * libm::sin(half), turn }
            }
        }
    }

    /// Predicts how far the rims of the left and the right wheel turn in a step, cm, for the commands now and before as they
    /// come out of the filter [up to the rims](DriveFilter::up_to_the_rims); `None` where that was not learned.
    pub fn wheels_cm(&self, now: [f64; 2], before: [f64; 2]) -> Option<[f64; 2]> {
        match self {
            MotionModel::Learned { wheels, commands, .. } => {
                let [now, before] = [now, before].map(|command| command.map(|c| c.clamp(commands[0], commands[1])));
                wheels.map(|law| law.wheels_cm(now, before))
            }
            MotionModel::Kinematic { robot, .. } => Some(rolled_cm(robot, now)),
        }
    }

    /// Returns whether it knows how far the wheels turn.
    pub fn knows_wheels(&self) -> bool {
        !matches!(self, MotionModel::Learned { wheels: None, .. })
    }

    /// Returns the standard deviations of the left and the right rotation counter where nothing is different, cm per step;
    /// `None` where that is not known.
    pub fn counter_scatter_cm(&self) -> Option<[f64; 2]> {
        match self {
            MotionModel::Learned { wheels, .. } => wheels.map(|law| law.scatter_cm),
            MotionModel::Kinematic { .. } => None,
        }
    }

    /// Returns whether a command of zero is held, under which every robot rests.
    fn rests(&self, command: [f64; 2]) -> bool {
        match self {
            MotionModel::Learned { networks, .. } => networks.scale().is_rest(command),
            MotionModel::Kinematic { .. } => command == [0.0; 2],
        }
    }

    /// Returns what the robot does beyond the networks and their bias while a command is held, if a robot is known.
    pub fn beyond(&self, command: [f64; 2]) -> Motion<f64> {
        let MotionModel::Learned { networks, reference, member: Some(member), .. } = self else { return Motion::ZERO };
        let beyond = (member.motion(command) - networks.motion(command)).turn_in_radians();
        beyond - reference.correction(&[command[0], command[1], command[0], command[1]])
    }

    /// Returns a command in percent of full speed.
    pub fn percent(&self, command: [f64; 2]) -> Percent {
        let scale = match self {
            MotionModel::Learned { networks, .. } => networks.scale(),
            MotionModel::Kinematic { .. } => CommandScale::PERCENT,
        };
        scale.percent(command)
    }

    /// Returns whether it contains the lag of a drive that answers within a step.
    pub fn answers_within_a_step(&self) -> bool {
        self.is_learned() && self.filter().is_none()
    }

    /// Returns whether it was learned from logs, and so is biased where they were sparse.
    pub fn is_learned(&self) -> bool {
        matches!(self, MotionModel::Learned { .. })
    }

    /// Returns the mean square error of this model in every step of commands now and before: what the training logs leave
    /// open of them, and what they say beyond it.
    pub fn own_error(&self, now: [f64; 2], before: [f64; 2]) -> Motion<f64> {
        let MotionModel::Learned { open: Some(open), .. } = self else { return Motion::ZERO };
        let mut squares = self.held_error(open, now);
        // The first step of a command is still moved by the one before.
        if now != before {
            squares = squares + self.held_error(open, before) + open.first_step_variances();
        }
        // From squared degrees.
        squares.turn_in_radians().turn_in_radians()
    }

    /// Returns the mean square error for a held command; that of the turn in squared degrees.
    fn held_error(&self, open: &Posterior, command: [f64; 2]) -> Motion<f64> {
        if self.rests(command) {
            return Motion::ZERO;
        }
        let predicted = self.step(command, command).turn_in_degrees();
        open.motion(command).zip_with(predicted, |[mean, deviation], predicted| {
            (mean - predicted) * (mean - predicted) + deviation * deviation
        })
    }

    /// Returns the standard deviations of the motion where nothing is different.
    pub fn scatter(&self) -> Motion<f64> {
        match self {
            MotionModel::Learned { reference, .. } => reference.scatter,
            MotionModel::Kinematic { scatter, .. } => *scatter,
        }
    }

    /// Returns the fraction of that noise which is the robot's own and not the tracker's, 0 to 1.
    pub fn process_noise_fraction(&self) -> Motion<f64> {
        match self {
            MotionModel::Learned { process_noise_fraction, .. } => *process_noise_fraction,
            MotionModel::Kinematic { .. } => Motion::splat(1.0),
        }
    }
}

/// Returns how far wheels roll in a step by a textbook, cm.
fn rolled_cm(robot: &Robot, command: [f64; 2]) -> [f64; 2] {
    command.map(|c| c / 100.0 * robot.full_speed_cm_s * robot.step_ms / 1000.0)
}

fn process_noise_fraction(learned: &Option<Learned<4>>) -> f64 {
    let components = learned.iter().flat_map(|l| &l.residuals.components);
    let (sum, n) =
        components.fold((0.0, 0.0), |(sum, n), s| (sum + f64::from(s.step * s.step + s.held * s.held), n + 1.0));
    if n > 0.0 { f64::sqrt(sum / n) } else { 1.0 }
}
