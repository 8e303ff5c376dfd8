//! Blind test of the diagnosis: cases with hidden effects, their diagnoses, and a score.
//!
//! [`make`] writes the cases, a sealed file with the effects of each, and a commitment to every entry of it; [`answer`]
//! reads only the cases; [`score`] breaks the seal, checks the commitments and scores the diagnoses. The three share only
//! the folder. [`calibrate`] fits the thresholds of the diagnosis to [`cases`] of other seeds.

pub mod answer;
mod bench;
pub mod calibrate;
pub mod cases;
pub mod coverage;
pub mod make;
pub mod rooms;
pub mod score;
pub mod seal;
pub mod sensitivity;
pub mod share;
mod truth;

use std::path::{Path, PathBuf};

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use seal::Published;

/// Paths within the folder of a challenge (docs/reference/formats.md, "A challenge").
pub struct Folder<'a>(pub &'a Path);

impl Folder<'_> {
    /// Reads the list of cases, whose names lie in this folder.
    ///
    /// # Errors
    /// If it cannot be read, or a case or robot has the name of a place elsewhere.
    pub fn published(&self) -> Result<Vec<Published>> {
        let cases: Vec<Published> = files::read_csv(&self.cases())?;
        for Published { case, robot, .. } in &cases {
            for name in [case, robot] {
                files::in_folder(self.0, name).map_err(|_| {
                    Error::in_file(&self.cases(), format!("{name:?} is not the name of a case or robot"))
                })?;
            }
        }
        Ok(cases)
    }

    /// Returns the list of cases, with the robot of each and the commitment to its effects.
    pub fn cases(&self) -> PathBuf {
        self.0.join("cases.csv")
    }

    /// Returns the sealed effects of all cases.
    pub fn sealed(&self) -> PathBuf {
        self.0.join("sealed.json")
    }

    /// Returns the logs of a case.
    pub fn case(&self, case: &str) -> PathBuf {
        self.0.join("cases").join(case)
    }

    /// Returns the training logs of a robot.
    pub fn robot(&self, robot: &str) -> PathBuf {
        self.0.join("robots").join(robot)
    }

    /// Returns the folder of the diagnoses.
    pub fn answers(&self) -> PathBuf {
        self.0.join("answers")
    }

    /// Returns the diagnosis of a case.
    pub fn answer(&self, case: &str) -> PathBuf {
        self.answers().join(format!("{case}.json"))
    }

    /// Returns the effects that the diagnosis of a case adds to the simulator.
    pub fn added(&self, case: &str) -> PathBuf {
        self.answers().join(format!("{case}-added.json"))
    }

    /// Returns the simulator of a robot, as learned for the answers.
    pub fn simulator(&self, robot: &str) -> PathBuf {
        self.answers().join(format!("simulator-{robot}.json"))
    }
}
