//! The simulator as the diagnosis sees it: networks, their known bias, and the noise that is normal.

use std::sync::Arc;

use crate::effects::PoseIncrement;
use crate::effects::applied::AppliedEffect;
use crate::simulator::ensemble::command_scale::Percent;
use crate::simulator::ensemble::{CommandScale, HeldMotion, Member, Posterior};
use crate::simulator::motion::MotionNetworks;
use crate::simulator::nominal::MotionBias;
use crate::simulator::nominal::motion_bias::Precision;
use crate::simulator::{Learned, Simulator};
use crate::sonar::SensorLaw;
use crate::sonar::familiar::FamiliarPoses;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Robot;

/// The models of motion and sonar without any gap.
#[derive(Clone)]
pub struct Baseline<'s> {
    /// The motion, if the simulator knows it.
    pub motion: Option<MotionModel<'s>>,
    /// The law of the sensor, if the simulator knows it.
    pub sonar: Option<SensorLaw>,
    /// Share of the chance in its echo rate and in its readings that belongs to the place, as far as it is known.
    pub place_bound: [f64; 2],
    /// What belongs to single poses.
    pub familiar: Option<&'s FamiliarPoses>,
    /// Effects that were added to the simulator before.
    pub applied: Vec<AppliedEffect>,
}

/// How commands become motion, and its noise.
#[derive(Clone)]
pub enum MotionModel<'s> {
    /// As learned from logs.
    Learned {
        /// The networks.
        networks: MotionNetworks<'s>,
        /// Their bias and noise.
        reference: &'s MotionBias,
        /// Least and largest command that they know.
        commands: [f64; 2],
        /// What the training logs leave open about the robot, where `member` is the one in its middle.
        open: Option<Arc<Posterior>>,
        /// The robot whose bias is added, if one is known.
        member: Option<Member>,
        /// Fraction of the noise of forward, lateral and turn that is the robot's own and not the tracker's, 0 to 1.
        process_noise_fraction: [f64; 3],
    },
    /// The textbook's differential drive.
    Kinematic {
        /// The robot.
        robot: Robot,
        /// Standard deviations of forward (cm), lateral (cm) and turn (rad).
        scatter: [f64; 3],
    },
}

impl<'s> Baseline<'s> {
    /// A trained simulator.
    ///
    /// # Errors
    /// When the simulator was written without the reference that a diagnosis needs.
    pub fn learned(simulator: &'s Simulator) -> Result<Self> {
        let reference = simulator.reference.as_ref().ok_or_else(|| {
            Error::new("the simulator file does not say how its training logs scattered: train it again")
        })?;
        let drive = simulator.motion_networks().zip(reference.motion.as_ref());
        let motion = drive.map(|(networks, reference)| MotionModel::Learned {
            networks,
            reference,
            commands: simulator.commands.map(f64::from),
            open: None,
            member: None,
            process_noise_fraction: [&simulator.forward, &simulator.lateral, &simulator.turn]
                .map(process_noise_fraction),
        });
        Ok(Baseline {
            motion,
            sonar: simulator.sensor_law(),
            place_bound: reference.place_bound,
            familiar: reference.familiar.as_ref(),
            applied: simulator.added.clone(),
        })
    }

    /// A trained simulator with the robot in the middle of those that its training logs allow. Networks are off where logs
    /// are few, which is where controllers drive, and an effect would be fitted to that.
    ///
    /// # Errors
    /// As [`learned`](Self::learned).
    pub fn of_middle(simulator: &'s Simulator) -> Result<Self> {
        let mut baseline = Baseline::learned(simulator)?;
        if let Some(MotionModel::Learned { member, open, .. }) = &mut baseline.motion {
            *open = simulator.trained().map(Arc::new);
            *member = open.as_ref().map(|open| open.mean());
        }
        Ok(baseline)
    }

    /// Number of steps that the motion was learned from, as far as that is known; none of the textbook.
    pub fn trained_on(&self) -> Option<f64> {
        let MotionModel::Learned { reference, .. } = self.motion.as_ref()? else { return None };
        reference.precision.as_ref().and_then(Precision::steps)
    }
}

impl MotionModel<'_> {
    /// What a step does for the commands now and before.
    pub fn step(&self, now: [f64; 2], before: [f64; 2]) -> PoseIncrement {
        match self {
            MotionModel::Learned { networks, reference, commands, member, .. } => {
                let [now, before] = [now, before].map(|command| command.map(|c| c.clamp(commands[0], commands[1])));
                // Of a command that is held this is all there is to say, and the networks need not be asked.
                if let Some(member) = member.as_ref().filter(|_| now == before) {
                    let [forward_cm, lateral_cm, turn_deg] = member.motion(now);
                    return PoseIncrement { forward_cm, lateral_cm, turn_rad: turn_deg.to_radians() };
                }
                let speeds = [now[0], now[1], before[0], before[1]];
                let learned = networks.step(speeds.map(|c| c as f32));
                let (known, beyond) = (reference.correction(&speeds), self.beyond(now));
                let more = [0, 1, 2].map(|channel| known[channel] + beyond[channel]);
                PoseIncrement {
                    forward_cm: f64::from(learned.forward_cm) + more[0],
                    lateral_cm: f64::from(learned.lateral_cm) + more[1],
                    turn_rad: f64::from(learned.turn_rad) + more[2],
                }
            }
            MotionModel::Kinematic { robot, .. } => {
                let way_cm = now.map(|c| c / 100.0 * robot.full_speed_cm_s * robot.step_ms / 1000.0);
                let turn_rad = (way_cm[1] - way_cm[0]) / robot.track_cm;
                let arc_cm = 0.5 * (way_cm[0] + way_cm[1]);
                // The chord of an arc.
                let half = 0.5 * turn_rad;
                let chord_cm = if half.abs() < 1e-9 { arc_cm } else { arc_cm * libm::sin(half) / half };
                let (forward_cm, lateral_cm) = (chord_cm * libm::cos(half), chord_cm * libm::sin(half));
                PoseIncrement { forward_cm, lateral_cm, turn_rad }
            }
        }
    }

    /// What the robot does beyond networks and their bias while a command is held, if one is known.
    pub fn beyond(&self, command: [f64; 2]) -> [f64; 3] {
        let MotionModel::Learned { networks, reference, member: Some(member), .. } = self else { return [0.0; 3] };
        let (does, said) = (member.motion(command), networks.held(command));
        let known = reference.correction(&[command[0], command[1], command[0], command[1]]);
        let beyond = [does[0] - said[0], does[1] - said[1], (does[2] - said[2]).to_radians()];
        [0, 1, 2].map(|channel| beyond[channel] - known[channel])
    }

    /// A command in percent of full speed.
    pub fn percent(&self, command: [f64; 2]) -> Percent {
        let scale = match self {
            MotionModel::Learned { networks, .. } => networks.scale(),
            MotionModel::Kinematic { .. } => CommandScale::PERCENT,
        };
        scale.percent(command)
    }

    /// Whether it was learned from logs, and so is off where they were few.
    pub fn is_learned(&self) -> bool {
        matches!(self, MotionModel::Learned { .. })
    }

    /// How far this may be off in every step of commands now and before, as mean squares of forward (cm), lateral (cm) and turn
    /// (rad): what the training logs leave open of them, and what they say beyond it.
    pub fn own_error(&self, now: [f64; 2], before: [f64; 2]) -> [f64; 3] {
        let MotionModel::Learned { open: Some(open), .. } = self else { return [0.0; 3] };
        let mut squares = self.held_error(open, now);
        // The first step of a command is still moved by the one before.
        if now != before {
            let (others, first) = (self.held_error(open, before), open.first_step_variances());
            squares = [0, 1, 2].map(|channel| squares[channel] + others[channel] + first[channel]);
        }
        let [forward, lateral, turn] = squares;
        [forward, lateral, turn.to_radians().to_radians()]
    }

    /// The same of a command that is held; that of the turn in degrees.
    fn held_error(&self, open: &Posterior, command: [f64; 2]) -> [f64; 3] {
        let PoseIncrement { forward_cm, lateral_cm, turn_rad } = self.step(command, command);
        let (does, said) = (open.motion(command), [forward_cm, lateral_cm, turn_rad.to_degrees()]);
        [0, 1, 2].map(|channel| {
            let [mean, deviation] = does[channel];
            (mean - said[channel]) * (mean - said[channel]) + deviation * deviation
        })
    }

    /// Standard deviations of forward (cm), lateral (cm) and turn (rad) where nothing is different.
    pub fn scatter(&self) -> [f64; 3] {
        match self {
            MotionModel::Learned { reference, .. } => reference.scatter,
            MotionModel::Kinematic { scatter, .. } => *scatter,
        }
    }

    /// Fraction of that noise which is the robot's own and not the tracker's, 0 to 1.
    pub fn process_noise_fraction(&self) -> [f64; 3] {
        match self {
            MotionModel::Learned { process_noise_fraction, .. } => *process_noise_fraction,
            MotionModel::Kinematic { .. } => [1.0; 3],
        }
    }
}

fn process_noise_fraction(learned: &Option<Learned<4>>) -> f64 {
    let components = learned.iter().flat_map(|l| &l.residuals.components);
    let (sum, n) =
        components.fold((0.0, 0.0), |(sum, n), s| (sum + f64::from(s.step * s.step + s.held * s.held), n + 1.0));
    if n > 0.0 { f64::sqrt(sum / n) } else { 1.0 }
}
