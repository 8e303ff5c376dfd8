//! The blind test of a diagnosis: cases whose effects are withheld, answers, and the score.
//!
//! [`make`] writes cases and a sealed file of what is different in each, with a commitment to every entry beside the
//! cases; [`answer`] reads the cases alone; [`score`] opens the seal, checks the commitments and counts. The three share
//! nothing but the folder. [`calibrate`] settles the diagnosis's thresholds on [`cases`] of other seeds.

pub mod answer;
pub mod calibrate;

pub mod cases;
pub mod make;
pub mod rooms;
pub mod score;
pub mod seal;

use std::path::{Path, PathBuf};

/// Where things lie in a challenge's folder.
pub struct Folder<'a>(pub &'a Path);

impl Folder<'_> {
    /// Which robot each case is of, and the commitment to what is different in it.
    pub fn cases(&self) -> PathBuf {
        self.0.join("cases.csv")
    }

    /// What is different in each case.
    pub fn sealed(&self) -> PathBuf {
        self.0.join("sealed.json")
    }

    /// The logs of a case.
    pub fn case(&self, case: &str) -> PathBuf {
        self.0.join("cases").join(case)
    }

    /// The logs of a robot as its simulator should know it.
    pub fn robot(&self, robot: &str) -> PathBuf {
        self.0.join("robots").join(robot)
    }

    /// The diagnosis of a case.
    pub fn answer(&self, case: &str) -> PathBuf {
        self.0.join("answers").join(format!("{case}.json"))
    }

    /// The effects that the diagnosis of a case adds to the simulator, where it names any.
    pub fn added(&self, case: &str) -> PathBuf {
        self.0.join("answers").join(format!("{case}-added.json"))
    }

    /// The simulator of a robot, as learned for the answers.
    pub fn simulator(&self, robot: &str) -> PathBuf {
        self.0.join("answers").join(format!("simulator-{robot}.json"))
    }
}
