//! The nominal model of a simulator's training logs, against which a gap is measured.
//!
//! Networks trained on (D, α) and commands leave a misfit even where nothing is wrong. The nominal model corrects that misfit
//! from the same logs, and states the scatter that remains: only what exceeds it is a gap.

pub mod motion_bias;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::sonar::familiar::FamiliarPoses;
use crate::sonar::{FirstEchoLaw, SonarModel};
pub use motion_bias::MotionBias;

/// What is normal, as far as the training logs show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NominalModel {
    /// Of the motion, if the logs had poses.
    pub motion: Option<MotionBias>,
    /// Of the sonar as a beam, if the logs had echoes.
    pub sonar: Option<SonarModel>,
    /// Of the sonar by the first-echo law, with poses as logged, if that predicts readings better than the beam.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_echo: Option<FirstEchoLaw>,
    /// Share of the chance in its echo rate and in its readings that belongs to the place.
    #[serde(default)]
    pub place_bound: [f64; 2],
    /// What belongs to single poses, where readings came from the same ones again and again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub familiar: Option<FamiliarPoses>,
}
