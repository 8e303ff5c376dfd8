//! Readings by the first-echo law, robot by robot: what a beam meets is no matter of vector lanes.

use rand::RngExt;

use super::Simulator;
use crate::chance::generator;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::logs::{Scene, Ultrasonic};
use crate::sonar::FirstEchoLaw;
use crate::sonar::echo_law::Surfaces;

/// A sensor that follows the law, in a scene.
pub(super) struct FirstEchoSensor<'s> {
    law: &'s FirstEchoLaw,
    surfaces: Surfaces,
    mount: Ultrasonic,
}

impl<'s> FirstEchoSensor<'s> {
    /// The sensor of a simulator's robot.
    ///
    /// # Errors
    /// When the simulator does not know the law of its sensor, or was given effects that change another model of it.
    pub fn of(simulator: &'s Simulator, scene: &Scene, is_changed: bool) -> Result<Self> {
        let law = simulator.first_echo.as_ref();
        let law = law.ok_or_else(|| Error::new("the simulator has no first-echo law of its sonar: train it again"))?;
        if is_changed {
            return Err(Error::new(
                "the simulator's added effects change its sonar, and do not know the first-echo law",
            ));
        }
        Ok(FirstEchoSensor { law, surfaces: Surfaces::new(scene.sides()), mount: simulator.robot.ultrasonic })
    }

    /// The reading of a robot; `draws` fix what chance adds.
    pub fn echo_cm(&self, robot: &Pose, draws: [f32; 2]) -> Option<f32> {
        let [seed, place] = draws.map(|draw| u64::from(draw.to_bits()));
        let mut rng = generator(seed, &[place]);
        let outcomes = self.law.outcomes_at(&self.surfaces, &self.mount.pose_on(robot));
        outcomes.draw(true, || rng.random()).map(|cm| cm as f32)
    }
}
