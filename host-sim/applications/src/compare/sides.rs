//! One side of a comparison: folders of logs, or recordings that are imported.

use std::path::PathBuf;

use mindgap_foundations::error::{Error, Result};
use mindgap_import::assemble::{Stated, assemble};
use mindgap_import::bag::{self, Choice};
use mindgap_import::recording::Recording;
use mindgap_import::statements::Statements;
use mindgap_import::streams::recordings;
use mindgap_logs::range_sensor::Sensors;
use mindgap_logs::{Logs, Robot, Scene};

/// Reads one side. Recordings are imported with this robot, its range sensors and this scene; folders of logs have their own.
///
/// # Errors
/// If a file cannot be read, if recordings cannot be imported, or if folders are of different rooms.
pub fn read(
    paths: &[PathBuf],
    robot: Option<(Robot, Sensors)>,
    scene: &Scene,
    mut warn: impl FnMut(String),
) -> Result<Logs> {
    let (folders, files): (Vec<&PathBuf>, Vec<&PathBuf>) =
        paths.iter().partition(|path| path.is_dir() && !bag::is_bag(path));
    match (folders.as_slice(), files.is_empty()) {
        ([], _) => import(&files, robot, scene),
        ([first, others @ ..], true) => {
            let mut logs = Logs::read(first, &mut warn)?;
            for folder in others {
                let more = Logs::read(folder, &mut warn)?;
                if more.scene != logs.scene || more.robot != logs.robot || more.sensors() != logs.sensors() {
                    return Err(Error::in_file(
                        folder,
                        format!("has another robot.toml or scene.toml than {}", first.display()),
                    ));
                }
                logs.runs.extend(more.runs);
            }
            Ok(logs)
        }
        ([first, ..], false) => {
            Err(Error::in_file(first, "is a folder among files: give folders of logs or recordings, not both"))
        }
    }
}

/// Returns the robot and the range sensors that a side states, if it is a folder of logs.
///
/// # Errors
/// If its robot.toml cannot be read.
pub fn robot_of(paths: &[PathBuf]) -> Result<Option<(Robot, Sensors)>> {
    let folder = paths.iter().find(|path| path.is_dir() && !bag::is_bag(path));
    folder.map(|folder| Robot::read_all(&folder.join("robot.toml"))).transpose()
}

fn import(files: &[&PathBuf], robot: Option<(Robot, Sensors)>, scene: &Scene) -> Result<Logs> {
    let (bags, streams): (Vec<PathBuf>, Vec<PathBuf>) =
        files.iter().map(|file| (*file).clone()).partition(|path| bag::is_bag(path));
    let sensors = robot.as_ref().map(|(robot, sensors)| sensors.all(robot.ultrasonic)).unwrap_or_default();
    let read = bag::recordings(&bags, &Choice::default(), &sensors, |_| ());
    let mut all = read.into_iter().collect::<Result<Vec<Recording>>>()?;
    if !streams.is_empty() {
        let stated = Statements { sensors, ..Statements::default() };
        all.extend(recordings(&streams, &stated, |_, _| ())?.recordings);
    }
    Ok(assemble(all, robot, scene.clone(), Stated::default(), |_, _| ())?.logs)
}
