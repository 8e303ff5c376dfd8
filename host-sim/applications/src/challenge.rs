//! Blind test of the diagnosis: cases whose effects are withheld, the diagnoses, and their score.
//!
//! [`make`] writes the cases, a sealed file with the effects of each, and a commitment to every entry of it; [`answer`]
//! reads the cases only; [`score`] opens the seal, checks the commitments and scores the diagnoses. The three share
//! nothing but the folder. [`calibrate`] fits the thresholds of the diagnosis on [`cases`] of other seeds.

pub mod answer;
mod bench;
pub mod calibrate;
pub mod cases;
pub mod make;
pub mod rooms;
pub mod score;
pub mod seal;
pub mod sensitivity;

use std::path::{Path, PathBuf};

/// Paths within the folder of a challenge (docs/formats.md, "A challenge").
pub struct Folder<'a>(pub &'a Path);

impl Folder<'_> {
    /// The list of cases, with the robot of each and the commitment to its effects.
    pub fn cases(&self) -> PathBuf {
        self.0.join("cases.csv")
    }

    /// The effects of each case.
    pub fn sealed(&self) -> PathBuf {
        self.0.join("sealed.json")
    }

    /// The logs of a case.
    pub fn case(&self, case: &str) -> PathBuf {
        self.0.join("cases").join(case)
    }

    /// The logs that a robot's simulator is learned from.
    pub fn robot(&self, robot: &str) -> PathBuf {
        self.0.join("robots").join(robot)
    }

    /// The diagnoses, and what belongs to them.
    pub fn answers(&self) -> PathBuf {
        self.0.join("answers")
    }

    /// The diagnosis of a case.
    pub fn answer(&self, case: &str) -> PathBuf {
        self.answers().join(format!("{case}.json"))
    }

    /// The effects that the diagnosis of a case adds to the simulator.
    pub fn added(&self, case: &str) -> PathBuf {
        self.answers().join(format!("{case}-added.json"))
    }

    /// The simulator of a robot, as learned for the answers.
    pub fn simulator(&self, robot: &str) -> PathBuf {
        self.answers().join(format!("simulator-{robot}.json"))
    }
}
