//! Merges brick logs and camera tracks into a log folder.
//!
//! Brick and camera have separate clocks. `clocks` aligns them by matching the motion of the wheels with the motion seen by the
//! camera; the camera's poses are then interpolated at the times of the brick's rows. Without any track the rows have no poses. The
//! [`Report`] lists everything left out.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::brick_log::{self, BrickLog};
use super::clocks::{Alignment, Doubt, align};
use super::command_times;
use super::file_streams::{BodyTrack, FileStreams};
use super::left_out::LeftOut;
use super::motion;
use super::range_sensors::heard_in_all;
use super::report::{LogReport, Report, RunReport, without_poses};
use super::scale_check::ScaleCheck;
use super::statements::Statements;
use super::table::read_source;
use super::track::{Sighting, Track};
use mindgap_foundations::counter::Counter;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::range_sensor::Sensors;
use mindgap_logs::{Logs, Robot, Run, Scene};

/// Merges brick logs and tracks, distinguished by their headers, of a robot with these range sensors. A file that cannot be used is
/// left out. Among several bodies of a track, the one named `body`, or else the one that moves as the wheels do, is the robot. `warn`
/// receives one line for each irregularity, `watch` the number of logs matched so far and their total.
///
/// # Errors
/// When there is no log, when no track that is given can be used, or when no log matches a track.
pub fn import(
    files: &[PathBuf],
    stated: &Statements,
    (robot, sensors): (Robot, Sensors),
    scene: Scene,
    mut warn: impl FnMut(String),
    watch: impl Fn(usize, usize),
) -> Result<(Logs, Report)> {
    let sensors = Arc::new(sensors);
    let (mut logs, mut tracks, mut left_out, mut error) = (Vec::new(), Vec::new(), Vec::new(), None);
    let mut has_failed_track = false;
    for (file, before) in files.iter().zip(0..) {
        if files[..before].contains(file) {
            left_out.push(LeftOut::file(file, "is given twice"));
            continue;
        }
        let read = match read_source(file) {
            Ok(text) if brick_log::is_brick_log(&text) => {
                BrickLog::parse(file, &text, &sensors, &mut warn).map(|log| logs.push(log))
            }
            unknown => {
                let read = unknown.and_then(|_| tracks_in(file, stated, &robot)).map(|(found, unused)| {
                    tracks.extend(found);
                    left_out.extend(unused);
                });
                has_failed_track |= read.is_err();
                read
            }
        };
        if let Err(e) = read {
            left_out.push(LeftOut::failed(file, &e));
            error = error.or(Some(e));
        }
    }
    if (logs.is_empty() || tracks.is_empty() && has_failed_track)
        && let Some(error) = error
    {
        return Err(error);
    }
    if logs.is_empty() {
        return Err(Error::new("none of the files is a log of a brick (columns t_ms, left, right, ...)"));
    }
    keep_heard(&mut logs, &sensors, warn);
    let mut runs = Vec::new();
    let mut reports = Vec::new();
    let counter = Counter::new(logs.len(), watch);
    for log in logs {
        let BrickLog { file, is_truncated, .. } = &log;
        let report = LogReport { file: file.clone(), truncated: *is_truncated, run: None, left_out: None };
        let name = format!("run-{:03}", runs.len());
        let merged_run = if tracks.is_empty() {
            untracked(&log, &robot, name)
        } else {
            match_track(&log, &tracks, &robot).and_then(|(track, found)| {
                let merged_run = merge(&log, Some((track, &found)), name);
                let mismatch = ScaleCheck::of_wheels(&merged_run.0, &robot)
                    .refusal("the wheels", &track.file.display().to_string());
                mismatch.map_or(Ok(merged_run), Err)
            })
        };
        reports.push(match merged_run {
            Ok((run, run_report)) => {
                runs.push(run);
                LogReport { run: Some(run_report), ..report }
            }
            Err(why) => LogReport { left_out: Some(why), ..report },
        });
        counter.increment();
    }
    if runs.is_empty() {
        let first = &reports[0];
        return Err(Error::in_file(&first.file, first.left_out.clone().unwrap_or_default()));
    }
    left_out.extend(unused_bodies(&tracks, &reports));
    let has_gyro = runs.iter().flat_map(|run| &run.rows).any(|row| row.gyro_deg_s.is_some());
    let without = if tracks.is_empty() { runs.len() } else { 0 };
    let untracked = without_poses([without, runs.len()], true, has_gyro);
    let tracks = tracks.iter().map(Track::report).collect();
    let logs = Logs { robot, scene, runs };
    logs.check_step(&reports[0].file)?;
    Ok((logs, Report { tracks, logs: reports, untracked, left_out }))
}

/// Keeps the range sensors that have a column in all logs, and warns of the others.
fn keep_heard(logs: &mut [BrickLog], sensors: &Sensors, warn: impl FnMut(String)) {
    let heard = |index: usize| logs.iter().filter(|log| log.have_echoes[index]).count();
    let (kept, silent) = heard_in_all(sensors, logs.len(), heard);
    silent.into_iter().for_each(warn);
    let kept = Arc::new(kept);
    for log in logs {
        log.run.rows = std::mem::take(&mut log.run.rows).of_sensors(Arc::clone(&kept));
    }
}

/// Reads the tracks in a file, one per body, and what is not used.
fn tracks_in(file: &Path, stated: &Statements, robot: &Robot) -> Result<(Vec<Track<'static>>, Vec<LeftOut>)> {
    let (mut tracks, mut unused, mut error) = (Vec::new(), Vec::new(), None);
    for FileStreams { bodies, source, .. } in FileStreams::read(file, stated)? {
        unused.extend(source.unused);
        if bodies.is_empty() {
            let what = "contains neither a brick log (columns t_ms, left, right, rot_left_deg, rot_right_deg) nor poses: use `mindgap import streams` for commands without counters";
            return Err(Error::in_file(file, what));
        }
        for BodyTrack { name, frames } in bodies {
            if stated.body.as_ref().is_some_and(|body| *body != name) {
                unused.push(LeftOut::body(&name, Some(frames.len()), "another body is chosen with --body").of(file));
                continue;
            }
            match Track::of(file, frames, robot) {
                Ok(track) => tracks.push(track.of_body(name)),
                Err(e) => {
                    unused.push(LeftOut::failed(file, &e));
                    error = error.or(Some(e));
                }
            }
        }
    }
    match error {
        Some(error) if tracks.is_empty() => Err(error),
        None if tracks.is_empty() => Err(Error::in_file(file, "has no body of the name that --body states")),
        _ => Ok((tracks, unused)),
    }
}

/// Returns the bodies that no log was matched with, in files where another body was.
fn unused_bodies(tracks: &[Track], logs: &[LogReport]) -> Vec<LeftOut> {
    let runs: Vec<&RunReport> = logs.iter().filter_map(|log| log.run.as_ref()).collect();
    let is_used =
        |track: &&Track| runs.iter().any(|run| run.track.as_ref() == Some(&track.file) && run.body == track.body);
    let unused = tracks.iter().filter(|track| !is_used(track));
    let unused = unused.filter_map(|track| {
        let name = track.body.as_deref()?;
        Some(LeftOut::body(name, Some(track.frames().len()), "it does not move as the wheels do").of(&track.file))
    });
    unused.collect()
}

/// Returns the track that matches a log best with their alignment, or why none does.
fn match_track<'a>(
    log: &BrickLog,
    tracks: &'a [Track<'static>],
    robot: &Robot,
) -> std::result::Result<(&'a Track<'static>, Alignment), String> {
    let by_wheels = motion::by_wheels(&log.run.rows, robot);
    let found = tracks.iter().filter_map(|track| Some((track, align(&by_wheels, &track.motion())?)));
    let Some((track, found)) = found.min_by(|a, b| a.1.unexplained.total_cmp(&b.1.unexplained)) else {
        return Err("no track overlaps half of its steps, or nothing moved".into());
    };
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    match found.doubt() {
        None => Ok((track, found)),
        Some(Doubt::Differs) => Err(format!(
            "no track matches: the best candidate leaves {} of the motion unexplained",
            percent(found.unexplained)
        )),
        Some(Doubt::Repeats) => Err(format!(
            "it matches {} at more than one time, with {} and {} of the motion unexplained",
            track.file.display(),
            percent(found.unexplained),
            percent(found.unexplained_elsewhere)
        )),
        Some(Doubt::Drifts) => Err(format!(
            "its clock and that of {} drift apart by {:.1} ms per second",
            track.file.display(),
            1000.0 * found.clocks.drift
        )),
    }
}

/// Makes a run of a log without a track, or says why that is no use.
fn untracked(log: &BrickLog, robot: &Robot, name: String) -> std::result::Result<(Run, RunReport), String> {
    let by_wheels = motion::by_wheels(&log.run.rows, robot);
    if by_wheels.windows(2).all(|pair| pair[0].by == pair[1].by) {
        return Err("its rotation counters never change, and none of the files is a track of a camera".into());
    }
    Ok(merge(log, None, name))
}

/// Adds the poses of a matching track to the rows of a log, if there is one.
fn merge(log: &BrickLog, matched: Option<(&Track, &Alignment)>, name: String) -> (Run, RunReport) {
    let seen = |t_ms: f64| matched.map_or(Sighting::Outside, |(track, found)| track.at(found.clocks.camera_ms(t_ms)));
    let seen: Vec<Sighting> = log.run.rows.iter().map(|row| seen(row.t_ms)).collect();
    let mut rows = log.run.rows.clone();
    seen.iter().enumerate().for_each(|(k, seen)| rows.edit(k, |row| row.pose = seen.pose()));
    let mut run = Run { name: name.clone(), rows };
    let changes_within_rows = command_times::place(&mut run);
    let report = RunReport {
        name,
        track: matched.map(|(track, _)| track.file.clone()),
        body: matched.and_then(|(track, _)| track.body.clone()),
        offset_ms: matched.map(|(_, found)| found.clocks.offset_ms),
        drift: matched.map(|(_, found)| found.clocks.drift),
        unexplained: matched.map(|(_, found)| found.unexplained),
        changes_within_rows,
        rows: seen.len(),
        outside: seen.iter().filter(|s| **s == Sighting::Outside).count(),
        in_gaps: seen.iter().filter(|s| **s == Sighting::Lost).count(),
    };
    (run, report)
}
