//! Robot and scene of an import, as the user gives them, and the folder of logs that is made with them.

use std::path::{Path, PathBuf};

use super::assemble::{Assembled, Stated, assemble};
use super::draft::{RobotDraft, SCENE, to_fill_in};
use super::report::RecordingsReport;
use super::streams::Recordings;
use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_logs::range_sensor::{RangeSensor, Sensors};
use mindgap_logs::{LogFiles, Logs, Robot, Run, Scene};

/// Robot and scene, with the texts of their files.
pub struct Given {
    robot: Option<(Robot, Sensors)>,
    robot_text: Option<String>,
    scene: Scene,
    scene_text: String,
}

/// Imported logs.
pub struct Imported {
    /// The logs.
    pub logs: Logs,
    /// The files of their folder.
    pub files: LogFiles,
    /// What was guessed, changed or left out.
    pub report: RecordingsReport,
}

impl Given {
    /// Reads the files that are given. Without a robot a draft of it is made; without a scene the ground is open.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub fn read(robot: Option<&Path>, scene: Option<&Path>) -> Result<Self> {
        let text = |path: &Path| Ok((path.to_owned(), files::read_text(path)?));
        Given::parse(robot.map(text).transpose()?, scene.map(text).transpose()?)
    }

    /// As [`Given::read`], from the texts of the files; their paths are for messages.
    ///
    /// # Errors
    /// When a text cannot be parsed.
    pub fn parse(robot: Option<(PathBuf, String)>, scene: Option<(PathBuf, String)>) -> Result<Self> {
        let parsed = robot.as_ref().map(|(path, text)| Robot::parse_all(path, text)).transpose()?;
        let (scene, scene_text) = match scene {
            Some((path, text)) => (Scene::parse(&path, &text)?, text),
            None => (Scene::default(), SCENE.to_owned()),
        };
        Ok(Given { robot: parsed, robot_text: robot.map(|(_, text)| text), scene, scene_text })
    }

    /// Returns the range sensors of the robot.
    pub fn range_sensors(&self) -> Vec<RangeSensor> {
        self.robot.as_ref().map(|(robot, sensors)| sensors.all(robot.ultrasonic)).unwrap_or_default()
    }

    /// Makes logs of recordings; `watch` receives the number of recordings aligned so far and their total.
    ///
    /// # Errors
    /// As [`assemble`].
    pub fn import(self, read: Recordings, stated: Stated, watch: impl Fn(usize, usize)) -> Result<Imported> {
        let Assembled { logs, draft, mut report } = assemble(read.recordings, self.robot, self.scene, stated, watch)?;
        let robot_text = self.robot_text.or(draft.as_ref().map(RobotDraft::text)).unwrap_or_default();
        report.to_fill_in = to_fill_in("robot.toml", &robot_text);
        report.left_out.extend(read.left_out);
        let others = [("robot.toml".into(), robot_text), ("scene.toml".into(), self.scene_text)];
        let files = others.into_iter().chain(logs.runs.iter().flat_map(Run::files)).collect();
        Ok(Imported { logs, files, report })
    }
}
