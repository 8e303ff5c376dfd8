//! `mindgap import`

use std::path::{Path, PathBuf};

use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_import::assemble::Stated;
use mindgap_import::bag::{self, Choice};
use mindgap_import::given::{Given, Imported};
use mindgap_import::statements::Statements;
use mindgap_import::streams::{Recordings, recordings};
use mindgap_logs::range_sensor::RangeSensor;
use serde::Deserialize;

use crate::drive::Drives;
use crate::report::{Answer, Report, Reporter};

/// Imports recordings as logs.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Import {
    /// Whether the recordings are bags; else they are streams as CSV.
    are_bags: bool,
    /// The recordings.
    recordings: Vec<PathBuf>,
    /// The measured robot, or nothing for a draft to fill in.
    robot: Option<PathBuf>,
    /// The scene, or nothing for open ground.
    scene: Option<PathBuf>,
}

impl Import {
    /// Imports the recordings.
    ///
    /// # Errors
    /// When a file cannot be read, or no recording can be used.
    pub fn answer(&self, report: Reporter) -> Result<Answer> {
        let given = Given::read(self.robot.as_deref(), self.scene.as_deref())?;
        let at = |begin: f64, what: &'static str| {
            move |done: usize, of: usize| {
                report(Report::Progress(begin + 0.5 * done as f64 / of.max(1) as f64, what.into()));
            }
        };
        let recordings = self.read(given.range_sensors(), at(0.0, "reading"))?;
        let Imported { logs, files, report: found } =
            given.import(recordings, Stated::default(), at(0.5, "aligning clocks"))?;
        let drives = Some(Drives::of(&logs));
        let json = files::json(Path::new("import.json"), &found)?;
        Ok(Answer { json: Some(json), files: Some(files), drives, ..Answer::default() })
    }

    fn read(&self, sensors: Vec<RangeSensor>, watch: impl Fn(usize, usize)) -> Result<Recordings> {
        if !self.are_bags {
            return recordings(&self.recordings, &Statements { sensors, ..Statements::default() }, watch);
        }
        let count = self.recordings.len();
        bag::usable(&self.recordings, &Choice::default(), &sensors, |before| watch(before, count))
    }
}
