//! Sessions: several folders of logs of one robot, each under conditions of its own (docs/reference/formats.md).

use std::path::{Path, PathBuf};

use toml::Table;

use super::robot::first_difference;
use super::{Logs, Robot, Scene};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// File with the conditions of a session.
pub const CONDITIONS: &str = "session.toml";

/// A folder of logs and the conditions under which they were recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// The folder, as it was given.
    pub folder: PathBuf,
    /// Conditions by their names, which are free; none without the file.
    pub conditions: Table,
}

impl Session {
    /// Reads the conditions of a folder of logs.
    ///
    /// # Errors
    /// If `session.toml` is there and is not TOML.
    pub fn read(folder: &Path) -> Result<Self> {
        let path = folder.join(CONDITIONS);
        let conditions = if files::source::exists(&path) { files::read_toml(&path)? } else { Table::new() };
        Ok(Session { folder: folder.to_owned(), conditions })
    }

    /// Returns what precedes the names of its runs: its folder, with slashes.
    pub fn prefix(&self) -> String {
        let folder = self.folder.to_string_lossy().replace('\\', "/");
        folder.trim_end_matches('/').to_owned()
    }
}

/// Reads the folders of logs of one robot, one folder per session, and joins their logs if there are several.
///
/// # Errors
/// If logs cannot be read, or those of several sessions do not belong together.
pub fn read_all(folders: &[PathBuf], mut read: impl FnMut(&Path) -> Result<Logs>) -> Result<(Vec<Session>, Logs)> {
    if let [folder] = folders {
        return Ok((vec![Session::read(folder)?], read(folder)?));
    }
    let read = |folder: &PathBuf| Ok((Session::read(folder)?, read(folder)?));
    let sessions = folders.iter().map(read).collect::<Result<Vec<_>>>()?;
    let known = sessions.iter().map(|(session, _)| session.clone()).collect();
    Ok((known, join(sessions)?))
}

/// Joins the logs of sessions. The names of runs then begin with the folder of their session.
///
/// # Errors
/// If there are none, two are the same folder, or they are of different robots or scenes.
fn join(sessions: Vec<(Session, Logs)>) -> Result<Logs> {
    let mut joined: Option<(PathBuf, Logs)> = None;
    let mut prefixes: Vec<String> = Vec::new();
    for (session, mut logs) in sessions {
        let prefix = session.prefix();
        if prefixes.contains(&prefix) {
            return Err(Error::in_file(&session.folder, "is given twice"));
        }
        logs.runs.iter_mut().for_each(|run| run.name = format!("{prefix}/{}", run.name));
        prefixes.push(prefix);
        match &mut joined {
            None => joined = Some((session.folder, logs)),
            Some((first, all)) => {
                check_same([first, &session.folder], [all, &logs])?;
                all.runs.extend(logs.runs);
            }
        }
    }
    joined.map(|(_, logs)| logs).ok_or_else(|| Error::new("no folder of logs is given"))
}

fn check_same([first, second]: [&PathBuf; 2], [a, b]: [&Logs; 2]) -> Result<()> {
    let as_in = |what: String| Err(Error::in_file(&second.join("robot.toml"), what));
    if let Some((name, [one, other])) = first_difference(&a.robot, &b.robot) {
        return as_in(format!("{name} is {other}, and {one} in {}: sessions are of one robot", first.display()));
    }
    let has_sensor = |robot: &Robot| robot.ultrasonic.is_some();
    if has_sensor(&a.robot) != has_sensor(&b.robot) {
        return as_in(format!(
            "and that of {} do not both have [ultrasonic]: sessions are of one robot",
            first.display()
        ));
    }
    let walls = |scene: &Scene| scene.sides();
    if walls(&a.scene) != walls(&b.scene) {
        let what = format!("has other walls or obstacles than that of {}: sessions share one scene", first.display());
        return Err(Error::in_file(&second.join("scene.toml"), what));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Row, Run, Scene};
    use mindgap_foundations::geometry::Wall;

    fn logs(robot: Robot, runs: usize) -> Logs {
        let run = |number: usize| Run {
            name: format!("run-{number:03}"),
            rows: [0.0, 400.0].into_iter().map(|t_ms| Row { t_ms, ..Row::default() }).collect(),
        };
        Logs { robot, scene: Scene::default(), runs: (0..runs).map(run).collect() }
    }

    fn robot() -> Robot {
        Robot {
            wheel_diameter_cm: 5.6,
            track_cm: 11.5,
            body_radius_cm: 10.0,
            step_ms: 400.0,
            full_speed_cm_s: 41.0,
            ultrasonic: None,
        }
    }

    fn joined(sessions: [(&str, Logs); 2]) -> Result<Logs> {
        let session =
            |(folder, logs): (&str, Logs)| (Session { folder: folder.into(), conditions: Table::new() }, logs);
        join(sessions.map(session).into())
    }

    #[test]
    fn runs_know_their_session() {
        let logs = joined([("tiles/", logs(robot(), 2)), ("home/carpet", logs(robot(), 1))]).unwrap();
        let names: Vec<&str> = logs.runs.iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names, ["tiles/run-000", "tiles/run-001", "home/carpet/run-000"]);
        assert_eq!([logs.runs[0].session(), logs.runs[2].session()], ["tiles", "home/carpet"]);
    }

    #[test]
    fn sessions_are_of_one_robot_in_one_scene() {
        let error = |other: Logs| joined([("a", logs(robot(), 1)), ("b", other)]).unwrap_err().to_string();
        let wider = logs(Robot { track_cm: 14.0, ..robot() }, 1);
        assert_eq!(error(wider), "b/robot.toml: track_cm is 14, and 11.5 in a: sessions are of one robot");
        let mut walled = logs(robot(), 1);
        walled.scene.walls.push(Wall { from_cm: Default::default(), to_cm: [0.0, 100.0].into() });
        assert_eq!(
            error(walled),
            "b/scene.toml: has other walls or obstacles than that of a: sessions share one scene"
        );
        let twice = joined([("a", logs(robot(), 1)), ("a/", logs(robot(), 1))]).unwrap_err().to_string();
        assert_eq!(twice, "a/: is given twice");
    }
}
