//! Merges a brick's logs and a camera's tracks into a folder of logs.
//!
//! Brick and camera have clocks of their own. `clocks` aligns them by matching the motion of the wheels with the motion
//! that the camera saw; the camera's poses are then interpolated at the times of the brick's rows. The [`Report`] names
//! everything left out.

use std::path::PathBuf;

use super::brick_log::{self, BrickLog};
use super::clocks::{Alignment, Doubt, align};
use super::motion;
use super::report::{LogReport, Report, RunReport, TrackReport};
use super::sides::Sides;
use super::track::{Sighting, Track};
use super::units::Units;
use mindgap_foundations::counter::Counter;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::{Logs, Robot, Row, Run, Scene};

/// Merges brick logs and tracks, which are distinguished by their headers. `warn` receives one line for each oddity,
/// `watch` how many of the logs are matched.
///
/// # Errors
/// When a file cannot be read or parsed, when there is no log or no track, or when no log matches a track.
pub fn import(
    files: &[PathBuf],
    units: &Units,
    robot: Robot,
    scene: Scene,
    mut warn: impl FnMut(String),
    watch: impl Fn(usize, usize),
) -> Result<(Logs, Report)> {
    let (mut logs, mut tracks) = (Vec::new(), Vec::new());
    for file in files {
        if brick_log::is_one(file)? {
            logs.push(BrickLog::read(file, &mut warn)?);
        } else {
            tracks.push(Track::read(file, units, &robot)?);
        }
    }
    if logs.is_empty() || tracks.is_empty() {
        let what =
            if logs.is_empty() { "log of a brick (columns t_ms, left, right, ...)" } else { "track of a camera" };
        return Err(Error::new(format!("none of the files is a {what}")));
    }
    let mut runs = Vec::new();
    let mut reports = Vec::new();
    let counter = Counter::new(logs.len(), watch);
    for log in logs {
        let BrickLog { file, torn, .. } = &log;
        let report = LogReport { file: file.clone(), torn: *torn, run: None, left_out: None };
        let joined = matched(&log, &tracks, &robot).and_then(|(track, found)| {
            let joined = merged(&log, track, &found, format!("run-{:03}", runs.len()));
            let units = Sides::of_wheels(&joined.0, &robot).refusal("the wheels", &track.file.display().to_string());
            units.map_or(Ok(joined), Err)
        });
        reports.push(match joined {
            Ok((run, report_of_run)) => {
                runs.push(run);
                LogReport { run: Some(report_of_run), ..report }
            }
            Err(why) => LogReport { left_out: Some(why), ..report },
        });
        counter.one_more();
    }
    if runs.is_empty() {
        let first = &reports[0];
        return Err(Error::in_file(&first.file, first.left_out.clone().unwrap_or_default()));
    }
    let tracks = tracks.iter().map(|t| TrackReport { file: t.file.clone(), ..t.report() }).collect();
    let logs = Logs { robot, scene, runs };
    logs.check_step(&reports[0].file)?;
    Ok((logs, Report { tracks, logs: reports }))
}

/// The track that matches a log best and their alignment, or the reason why none does.
fn matched<'a>(
    log: &BrickLog,
    tracks: &'a [Track],
    robot: &Robot,
) -> std::result::Result<(&'a Track, Alignment), String> {
    let by_wheels = motion::by_wheels(&log.run.rows, robot);
    let found = tracks.iter().filter_map(|track| Some((track, align(&by_wheels, &track.motion())?)));
    let Some((track, found)) = found.min_by(|a, b| a.1.unexplained.total_cmp(&b.1.unexplained)) else {
        return Err("no track overlaps it by half of its steps, or nothing moved".into());
    };
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    match found.doubt() {
        None => Ok((track, found)),
        Some(Doubt::Differs) => Err(format!(
            "no track saw it: wheels and camera differ in {} of the motion at best",
            percent(found.unexplained)
        )),
        Some(Doubt::Repeats) => Err(format!(
            "it matches {} at more than one time: {} and {} of the motion differ",
            track.file.display(),
            percent(found.unexplained),
            percent(found.unexplained_elsewhere)
        )),
        Some(Doubt::Drifts) => Err(format!(
            "its clock and that of {} run apart by {:.1} ms a second",
            track.file.display(),
            1000.0 * found.clocks.drift
        )),
    }
}

/// The log's rows with the camera's poses at their times.
fn merged(log: &BrickLog, track: &Track, found: &Alignment, name: String) -> (Run, RunReport) {
    let clocks = &found.clocks;
    let seen: Vec<Sighting> = log.run.rows.iter().map(|row| track.at(clocks.camera_ms(row.t_ms))).collect();
    let rows = log.run.rows.iter().zip(&seen).map(|(row, seen)| Row { pose: seen.pose(), ..row });
    let run = Run { name: name.clone(), rows: rows.collect() };
    let report = RunReport {
        name,
        track: track.file.clone(),
        offset_ms: clocks.offset_ms,
        drift: clocks.drift,
        unexplained: found.unexplained,
        rows: seen.len(),
        outside: seen.iter().filter(|s| **s == Sighting::Outside).count(),
        in_gaps: seen.iter().filter(|s| **s == Sighting::Lost).count(),
    };
    (run, report)
}
