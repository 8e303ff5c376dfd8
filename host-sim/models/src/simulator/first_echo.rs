//! Readings by the first-echo law, robot by robot: what a beam meets is no matter of vector lanes.

use rand::RngExt;

use crate::sonar::FirstEchoLaw;
use crate::sonar::echo_law::Surfaces;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;
use mindgap_logs::{Scene, Ultrasonic};

/// A sensor that follows the law, in a scene.
pub(super) struct FirstEchoSensor<'s> {
    law: &'s FirstEchoLaw,
    surfaces: Surfaces,
    mount: Ultrasonic,
}

impl<'s> FirstEchoSensor<'s> {
    /// The sensor that is mounted so.
    pub fn new(law: &'s FirstEchoLaw, scene: &Scene, mount: Ultrasonic) -> Self {
        FirstEchoSensor { law, surfaces: Surfaces::new(scene.sides()), mount }
    }

    /// The reading of a robot; `draws` fix what chance adds.
    pub fn echo_cm(&self, robot: &Pose, draws: [f32; 2]) -> Option<f32> {
        let [seed, place] = draws.map(|draw| u64::from(draw.to_bits()));
        let mut rng = generator(seed, &[place]);
        let outcomes = self.law.outcomes_at(&self.surfaces, &self.mount.pose_on(robot));
        outcomes.draw(true, || rng.random()).map(|cm| cm as f32)
    }
}
