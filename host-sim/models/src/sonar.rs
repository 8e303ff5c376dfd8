//! The measurement model of the ultrasonic sensor: the probability of everything that it may report.
//!
//! It is the beam model of Thrun, Burgard and Fox (2005), Probabilistic Robotics, section 6.3, a mixture of hits, short
//! readings, failures and random readings, with two changes. The NXT's beam is wide, so a hit is the *first echo of a
//! fan of rays* ([`first_echo`]): next to an edge it comes from the nearer surface, and at an oblique wall from the part
//! that faces the sensor. And some readings are independent of what is ahead: the constant one that the paper
//! observed (section VIII), and those of faults that a diagnosis looks for ([`Perturbation`]).
//!
//! A wall hit obliquely reflects sound specularly onto another one, from which it returns along the same path. So three of
//! the rays are continued to a second wall, as rays of the whole path length that lose
//! [`mirror_loss`](SonarModel::mirror_loss) in log-odds.
//!
//! With the rays in order of distance, b_j the probability that ray j returns, and d that an echo is dropped:
//!
//! ```text
//! first echo      a_j      = b_j Π_{i<j} (1 − b_i)
//! detected        e        = (1 − d) Σ a_j
//! hit             hit_j    = (1 − d) a_j (1 − g₁) (1 − c₁)
//! ghost           ghost    = e g₁ + (1 − e) g₀
//! constant        constant = e (1 − g₁) c₁ + (1 − e) (1 − g₀) c₀
//! none            none     = (1 − e) (1 − g₀) (1 − c₀)
//! ```
//!
//! where g₁ and c₁ are the probabilities of the ghost and of the constant reading in place of an echo, g₀ and c₀ in place of
//! none. Then the following replace the outcomes before them, in this order: a short reading with p_short, whether there was
//! a reading or not; a long reading with p_long in place of a reading, and with p_long_given_none in place of none; and a
//! random answer with p_rand, as often none as a reading from anywhere in the sensor's range.
//!
//! Hits scatter by Student's t distribution about the distance with a bias, ghost and constant readings about their
//! value; short readings are uniform from the least reading to what the axis meets, long ones from there to the
//! largest, random ones over the whole range.
//!
//! [`MixingWeights`] is the table's one implementation for a beam and [`Outcomes`] the whole mixture: logs are judged by
//! [`Outcomes::log_likelihood`], and readings are drawn by [`Outcomes::draw`]. The vectorised simulator draws the first
//! echo ray by ray and the rest by the same weights.
//!
//! Another law of the same sensor is the first-echo law ([`echo_law`]). A diagnosis judges a sensor by the law that is more
//! likely given its training logs; a [`SensorLaw`] is either of them, and perturbations have the same meaning for both.

mod draw;
pub mod echo_law;
pub mod familiar;
pub mod fan;
pub mod first_echo;
pub mod law;
mod likelihood;
pub mod model;
pub mod outcomes;
#[cfg(test)]
pub(crate) mod partition;
pub mod perturbation;
pub mod place;
pub mod pose_grid;
#[cfg(test)]
mod tests;

pub use echo_law::FirstEchoLaw;
pub use fan::{Fan, Ray, fan_at};
pub use law::{SensorLaw, View};
pub use model::SonarModel;
pub use outcomes::{MixingWeights, Outcomes};
pub use perturbation::Perturbation;
