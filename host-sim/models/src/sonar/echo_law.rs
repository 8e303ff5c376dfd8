//! The first-echo law: a reading is the first echo that rises above the sensor's threshold.
//!
//! A wide beam hits many targets at once: walls along its rays, the feet of the perpendiculars on walls, and corners
//! (`targets`). Each returns an echo of some strength, in units of the threshold's logistic noise:
//!
//! ```text
//! s = G − n ln d − (β/b)^q − r(ι)      a wall; r(ι) = f (1 − exp(−(ι/i₀)²/f))
//! s = G − n ln d − (β/b)^q + c         a corner, or an edge
//! ```
//!
//! with the distance d in metres, the angle β off the axis and the incidence ι. In the order of distance, with σ the
//! logistic function and S_j the largest strength up to target j,
//!
//! ```text
//! P(first echo is j)   = σ(S_j) − σ(S_{j−1})
//! P(no direct echo)    = 1 − σ(S_last)
//! ```
//!
//! so that reading, loss and masking follow from one law: all targets share one threshold, and a target behind another is
//! heard only if it is stronger. The reading of target j scatters by Student's t distribution about o + k d + e (β/10°)²,
//! with the scale s₀ exp(a d + c β/10°) and, along walls, by the spacing of the rays.
//!
//! Without a direct echo there is another reading with some probability, longer or shorter than the distance along the axis
//! (echoes by detours), else none. A ghost, a weak echo from the robot itself, precedes all farther echoes. With a small
//! probability a reading is random.
//!
//! The law, its parameters and their spread over sensors were found on the scans of eleven LEGO NXT sensors;
//! `docs/explanation/sonar.md` describes them. Planes that return echoes near their normal, and corners, follow Kuc and
//! Siegel (1987), Physically based simulation model for acoustic sensor robot navigation, IEEE PAMI 9; constant distance
//! over a range of directions follows Leonard and Durrant-Whyte (1991), Mobile robot localization by tracking geometric
//! beacons, IEEE Trans. Robot. Autom. 7.

mod rays;
mod readings;
mod surfaces;
mod targets;
#[cfg(test)]
mod tests;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::model::P_RAND;
pub use readings::reach_cm;
pub use surfaces::Surfaces;
pub use targets::{Target, TargetKind, targets_at};

/// The parameters of the law for a sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FirstEchoLaw {
    /// G: strength of a wall that faces the sensor on its axis at 1 m.
    pub gain: f64,
    /// n: strength lost with the logarithm of the distance.
    pub spreading: f64,
    /// b: angle off the axis at which one unit of strength is lost, degrees.
    pub beam_deg: f64,
    /// q: power of the angle off the axis.
    pub beam_power: f64,
    /// i₀: incidence at which a wall has lost about one unit of strength, degrees.
    pub specular_deg: f64,
    /// f: largest loss of a wall by its incidence.
    pub oblique_loss: f64,
    /// Strength of a concave corner relative to a wall that faces the sensor.
    pub corner: f64,
    /// Strength of a convex edge, or of a wall's free end, relative to the same.
    pub edge: f64,
    /// o: reading minus distance on the axis, cm.
    pub offset_cm: f64,
    /// k: ratio of reading to distance.
    pub scale: f64,
    /// e: increase of a reading at 10 degrees off the axis, where the threshold is crossed later, cm.
    pub off_axis_cm: f64,
    /// s₀: scale of the scatter at the sensor, cm.
    pub scatter_cm: f64,
    /// a: growth of the scatter's logarithm per metre.
    pub scatter_per_m: f64,
    /// c: growth of the scatter's logarithm per 10 degrees off the axis.
    pub scatter_off_axis: f64,
    /// Probability that a direct echo is dropped.
    pub p_dropout: f64,
    /// Probability of another reading if there is no direct echo.
    pub p_other: f64,
    /// Probability that this reading is longer, not shorter, than the distance along the axis.
    pub p_long_given_other: f64,
    /// Probability of the ghost if nothing nearer is heard.
    pub p_ghost: f64,
    /// Reading of the ghost, cm.
    pub ghost_cm: f64,
    /// Probability of a random answer, as often none as a reading.
    pub p_stray: f64,
    /// Smallest and largest reading, cm.
    pub range_cm: [f64; 2],
}

/// Strength of an ideal ray's echo, practically certain, in units of the threshold's noise.
const CERTAIN: f64 = 6.0;
/// Width of an ideal ray, degrees: a twentieth of a usual beam, so that nothing off axis is heard.
const RAY_DEG: f64 = 8.7 / 20.0;

impl FirstEchoLaw {
    /// Returns the textbook's ideal ray: every surface returns it, at any distance and incidence. A share `p_dropout` of the
    /// echoes is lost, and readings scatter by `scatter_cm`.
    pub fn ideal_ray(scatter_cm: f64, p_dropout: f64, range_cm: [f64; 2]) -> Self {
        FirstEchoLaw {
            gain: CERTAIN,
            spreading: 0.0,
            beam_deg: RAY_DEG,
            beam_power: 1.33,
            specular_deg: 90.0,
            oblique_loss: 1e-9,
            corner: 0.0,
            edge: 0.0,
            offset_cm: 0.0,
            scale: 1.0,
            off_axis_cm: 0.0,
            scatter_cm,
            scatter_per_m: 0.0,
            scatter_off_axis: 0.0,
            p_dropout,
            p_other: 0.0,
            p_long_given_other: 0.5,
            p_ghost: 0.0,
            ghost_cm: range_cm[0],
            p_stray: P_RAND,
            range_cm,
        }
    }

    /// Returns whether it is an ideal ray.
    pub fn is_ray(&self) -> bool {
        *self == FirstEchoLaw::ideal_ray(self.scatter_cm, self.p_dropout, self.range_cm)
    }

    /// Returns whether the parameters are those of a possible sensor, so that every outcome has a probability.
    pub fn is_sound(&self) -> bool {
        let FirstEchoLaw { p_dropout, p_other, p_long_given_other, p_ghost, p_stray, .. } = *self;
        let FirstEchoLaw { beam_deg, beam_power, specular_deg, oblique_loss, scatter_cm, .. } = *self;
        let finite = [
            self.gain,
            self.spreading,
            self.corner,
            self.edge,
            self.offset_cm,
            self.scale,
            self.off_axis_cm,
            self.scatter_per_m,
            self.scatter_off_axis,
            self.ghost_cm,
        ];
        let [low, high] = self.range_cm;
        finite.iter().all(|x| x.is_finite())
            && [beam_deg, beam_power, specular_deg, oblique_loss, scatter_cm].iter().all(|x| *x > 0.0 && x.is_finite())
            && [p_dropout, p_other, p_long_given_other, p_ghost].iter().all(|p| (0.0..=1.0).contains(p))
            && p_stray > 0.0
            && p_stray < 1.0
            && self.spreading >= 0.0
            && low < high
            && low.is_finite()
            && high.is_finite()
    }
}
