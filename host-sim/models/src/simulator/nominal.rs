//! The nominal model of a simulator's training logs, against which a gap is measured.
//!
//! Networks trained on (D, α) and commands leave a misfit even where nothing is wrong. The nominal model corrects that misfit
//! from the same logs, and states the scatter that remains: only what exceeds it is a gap.

pub mod motion_bias;
pub mod wheel_law;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::sonar::familiar::FamiliarPoses;
use crate::sonar::{FirstEchoLaw, SonarModel};
pub use motion_bias::MotionBias;
pub use wheel_law::WheelLaw;

/// What is normal, as far as the training logs show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NominalModel {
    /// Model of the motion, if the logs had poses.
    pub motion: Option<MotionBias>,
    /// Model of the wheels, if the logs had rotation counters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wheels: Option<WheelLaw>,
    /// Beam model of the sonar, if the logs had echoes.
    pub sonar: Option<SonarModel>,
    /// The first-echo law of the sonar, with poses as logged, if it predicts readings better than the beam.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_echo: Option<FirstEchoLaw>,
    /// Share of the variance of its echo rate and of its readings that belongs to the place.
    #[serde(default)]
    pub place_bound: [f64; 2],
    /// Errors that belong to single poses, if many readings came from the same poses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub familiar: Option<FamiliarPoses>,
}

impl NominalModel {
    /// Returns whether its laws are those of a possible robot.
    pub fn is_sound(&self) -> bool {
        self.wheels.as_ref().is_none_or(WheelLaw::is_sound)
            && self.sonar.as_ref().is_none_or(SonarModel::is_sound)
            && self.first_echo.as_ref().is_none_or(FirstEchoLaw::is_sound)
    }
}
