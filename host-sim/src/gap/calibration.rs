//! The thresholds of a diagnosis, as `mindgap challenge calibrate` settled them on cases with known answers.
//!
//! Whatever is decided by how often a diagnosis may be wrong is here; what follows from the shape of the problem is a
//! constant beside the code that uses it.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

/// Thresholds and probabilities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Of what could be explained the effects have to explain this share to be the cause.
    pub adequate: f64,
    /// How sharply adequacy decides: the width of a logistic curve.
    pub adequacy_width: f64,
    /// A rival with at least this share of the winner's weight is named beside it.
    pub rival: f64,
    /// Weights of rivals are raised to one over this: above one, doubt weighs more than its nats say.
    pub temperature: f64,
    /// How often the plainest answer is right.
    pub trust: f64,
    /// An effect counts from here on.
    pub effect: Gate,
    /// What the generic learner explains in a channel counts from here on.
    pub leftover: Gate,
}

/// From where on a gain on held-out runs counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gate {
    /// So many nats,
    pub nats: f64,
    /// and so many standard errors.
    pub z: f64,
}

/// The file that `mindgap challenge calibrate` wrote.
pub const SHIPPED: &str = include_str!("calibration.toml");

/// A file of this program that it cannot read is a fault of the program; a test reads it.
static CALIBRATION: LazyLock<Calibration> =
    LazyLock::new(|| toml::from_str(SHIPPED).expect("calibration.toml is as the command writes it"));

impl Calibration {
    /// The calibration that diagnoses use.
    pub fn shipped() -> Self {
        *CALIBRATION
    }

    /// The text of a calibration file, with the command that made it.
    pub fn to_text(&self, command: &str) -> String {
        let figures = toml::to_string(self).expect("numbers can be written");
        format!("# Made by: {command}\n{figures}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_file_is_as_the_command_writes_it() {
        let command = SHIPPED.lines().next().and_then(|line| line.strip_prefix("# Made by: ")).expect("a first line");
        assert!(command.starts_with("mindgap challenge calibrate --cases "), "{command}");
        assert_eq!(Calibration::shipped().to_text(command), SHIPPED);
    }

    #[test]
    fn thresholds_are_possible() {
        let Calibration { effect, leftover, adequate, adequacy_width, rival, temperature, trust } =
            Calibration::shipped();
        assert!([effect, leftover].iter().all(|gate| gate.nats > 0.0 && gate.z > 0.0));
        assert!([adequate, rival, trust].iter().all(|share| (0.0..=1.0).contains(share)));
        assert!(adequacy_width > 0.0 && temperature >= 1.0);
    }
}
