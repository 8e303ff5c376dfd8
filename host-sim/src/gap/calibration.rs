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
    /// Rows of evidence that the gates are set for.
    pub rows: f64,
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

    /// The same for evidence of so many rows: what the simulator's own misfit feigns grows with them, and so do the
    /// nats that are asked for.
    pub fn for_rows(self, rows: usize) -> Self {
        let growth = self.growth(rows);
        let grown = |gate: Gate| Gate { nats: gate.nats * growth, ..gate };
        Calibration { effect: grown(self.effect), leftover: grown(self.leftover), ..self }
    }

    /// How much more is asked for with so many rows; never less, since what chance feigns does not shrink.
    pub fn growth(&self, rows: usize) -> f64 {
        (rows as f64 / self.rows).max(1.0)
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
        let Calibration { rows, effect, leftover, adequate, adequacy_width, rival, temperature, trust } =
            Calibration::shipped();
        assert!([effect, leftover].iter().all(|gate| gate.nats > 0.0 && gate.z > 0.0));
        assert!([adequate, rival, trust].iter().all(|share| (0.0..=1.0).contains(share)));
        assert!(rows > 0.0 && adequacy_width > 0.0 && temperature >= 1.0);
    }

    #[test]
    fn twice_the_rows_ask_for_twice_the_nats_and_few_for_no_fewer() {
        let shipped = Calibration { rows: 1000.0, ..Calibration::shipped() };
        assert_eq!(shipped.for_rows(10), shipped);
        let twice = shipped.for_rows(2000);
        assert_eq!(twice.effect, Gate { nats: 2.0 * shipped.effect.nats, ..shipped.effect });
        assert_eq!(twice.leftover, Gate { nats: 2.0 * shipped.leftover.nats, ..shipped.leftover });
    }
}
