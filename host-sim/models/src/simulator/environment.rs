//! A simulator, a scene and a start, ready for rollouts of controllers.

use std::str::FromStr;

use glam::DVec2;
use mindgap_core::controller::Controller;
use mindgap_core::folded::FoldedNetwork;

use super::beam::Beam;
use super::effect_layer::EffectLayer;
use super::ensemble::{Member, Robots};
use super::first_echo::FirstEchoSensor;
use super::motion::{MotionNetworks, MotionTable};
use super::residuals::{ConstantReading, ResidualNoise, ResidualQuantiles};
use super::room::Room;
use super::{Noise, Simulator};
use crate::sonar::SensorLaw;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Motion;
use mindgap_logs::{Robot, Scene, Ultrasonic};

/// Where and how controllers are rolled out.
pub struct Environment<'s> {
    pub(super) robot: Robot,
    pub(super) mount: Ultrasonic,
    pub(super) start: Pose,
    /// Unit vector along the sensor's axis on the robot.
    pub(super) yaw_direction: [f32; 2],
    pub(super) room: Room,
    pub(super) motion: MotionNetworks<'s>,
    /// Whether they are asked in every step and not once for all that a controller does: the same bits, slower.
    pub(super) asks_every_step: bool,
    /// Residual noise of the motion networks.
    pub(super) motion_noise: Motion<ResidualNoise>,
    /// Probability and value of an echo.
    pub(super) sonar: [FoldedNetwork<f32, 2>; 2],
    pub(super) echo_residuals: &'s ResidualQuantiles,
    pub(super) constant_reading: Option<ConstantReading>,
    pub(super) noise: Noise,
    /// There when effects were added to the simulator.
    pub(super) effect_layer: Option<EffectLayer>,
    /// There when it makes the readings.
    pub(super) beam: Option<Beam>,
    /// The same of the first-echo law.
    pub(super) first_echo: Option<FirstEchoSensor<'s>>,
}

/// What makes the readings of simulated runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorModel {
    /// The beam that the training logs show; the networks where they show none.
    Beam,
    /// The two sonar networks.
    Networks,
    /// The first-echo law.
    FirstEcho,
}

impl FromStr for SensorModel {
    type Err = String;

    fn from_str(name: &str) -> std::result::Result<Self, String> {
        match name {
            "beam" => Ok(SensorModel::Beam),
            "networks" => Ok(SensorModel::Networks),
            "first_echo" => Ok(SensorModel::FirstEcho),
            _ => Err(format!("{name:?} is not a sensor model")),
        }
    }
}

impl<'s> Environment<'s> {
    /// The environment for rollouts from `start`. What makes the readings is the networks without noise beyond the paper's, else
    /// the beam.
    ///
    /// # Errors
    /// When the simulator lacks a network or the robot does not fit at the start.
    pub fn new(simulator: &'s Simulator, scene: &Scene, start: Pose, noise: Noise) -> Result<Self> {
        let robot = simulator.robot;
        if !scene.has_room_for(start.position_cm, robot.body_radius_cm) {
            return Err(Error::new(format!(
                "the start at ({}, {}) leaves no room for a robot of radius {} cm",
                start.position_cm.x, start.position_cm.y, robot.body_radius_cm
            )));
        }
        let echo_probability = simulator.need(&simulator.echo_probability, "echo_probability")?;
        let echo_value = simulator.need(&simulator.echo_value, "echo_value")?;
        let mount = robot.ultrasonic.ok_or_else(|| Error::new("the simulator's robot has no [ultrasonic]"))?;
        let yaw_rad = mount.yaw_deg.to_radians();
        let beyond = simulator.reference.as_ref().filter(|_| noise == Noise::Learned);
        let motion = MotionNetworks::of(simulator)?.corrected(beyond.and_then(|r| r.motion.as_ref()));
        let beam = beyond.and_then(|r| r.sonar.as_ref()).map(Beam::new);
        Ok(Environment {
            robot,
            mount,
            start,
            yaw_direction: [libm::cos(yaw_rad) as f32, libm::sin(yaw_rad) as f32],
            room: Room::new(scene),
            motion_noise: motion.residual_noise(),
            motion,
            asks_every_step: false,
            sonar: [echo_probability, echo_value].map(|l| FoldedNetwork::fold(&l.network)),
            echo_residuals: &echo_value.residuals,
            constant_reading: simulator.constant_reading,
            noise,
            effect_layer: EffectLayer::of(simulator, scene, noise)?,
            beam,
            first_echo: None,
        })
    }

    /// The environment with readings of this model.
    ///
    /// # Errors
    /// When the simulator does not know the first-echo law of its sensor, and this is asked for.
    pub fn sensing_by(self, sensor: SensorModel, simulator: &'s Simulator, scene: &Scene) -> Result<Self> {
        match sensor {
            SensorModel::Beam => Ok(self),
            SensorModel::Networks => Ok(Environment { beam: None, ..self }),
            SensorModel::FirstEcho => self.with_first_echo(simulator, scene),
        }
    }

    fn with_first_echo(self, simulator: &'s Simulator, scene: &Scene) -> Result<Self> {
        let law = simulator.first_echo.as_ref();
        let law = law.ok_or_else(|| Error::new("the simulator has no first-echo law of its sonar: train it again"))?;
        let effect_layer = self.effect_layer.map(|layer| layer.hearing_by(SensorLaw::FirstEcho(law.clone())));
        // Readings that effects change are made where the effects are.
        let is_changed = effect_layer.as_ref().is_some_and(EffectLayer::senses);
        let first_echo = (!is_changed).then(|| FirstEchoSensor::new(law, scene, self.mount));
        Ok(Environment { effect_layer, first_echo, ..self })
    }

    /// The environment with one robot of those that its simulator's may be.
    pub fn of_robot(self, member: &'s Member) -> Self {
        let motion = self.motion.of_robot(member);
        Environment { motion_noise: motion.residual_noise(), motion, ..self }
    }

    /// The environment with the robot in the middle of those that its simulator's may be, where that is known: what is
    /// evolved on drawn ones would fit those.
    pub fn at_posterior_mean(self, robots: Option<&'s Robots>) -> Self {
        robots.into_iter().fold(self, |any, robots| any.of_robot(&robots.mean))
    }

    /// Where controllers start, cm.
    pub fn start_cm(&self) -> DVec2 {
        self.start.position_cm
    }

    /// An environment for each of these robots.
    ///
    /// # Errors
    /// As [`Environment::new`].
    pub fn of_robots(simulator: &'s Simulator, robots: &'s [Member], scene: &Scene, start: Pose) -> Result<Vec<Self>> {
        let of_one = |robot| Ok(Self::new(simulator, scene, start, Noise::Learned)?.of_robot(robot));
        robots.iter().map(of_one).collect()
    }

    /// The environment with the motion networks evaluated in every step. Outcomes stay the same to the bit; it is there
    /// to show that, and to measure the cost.
    pub fn asking_every_step(self) -> Self {
        Environment { asks_every_step: true, ..self }
    }

    /// The motions of a controller on this environment.
    pub fn motions(&self, controller: &Controller) -> MotionTable {
        let affected = self.effect_layer.as_ref().and_then(|layer| layer.transients(controller, &self.motion));
        self.motion.table(controller).with_transients(affected)
    }
}
