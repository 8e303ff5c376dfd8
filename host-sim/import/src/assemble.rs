//! Recordings become a folder of logs: clocks aligned, poses and readings at the times of rows, the frame put right, both
//! sides of the motion held against each other.

mod clock;
mod frame;
mod rows;

use std::ops::Range;

use self::frame::put_right;
use self::rows::{Prepared, spacing_ms};
use super::clocks::Clocks;
use super::draft::{Measure, RobotDraft};
use super::recording::{Kind, Recording};
use super::report::{RecordingReport, RecordingsReport};
use super::sides::Sides;
use mindgap_foundations::counter::Counter;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::inspection::Inspection;
use mindgap_logs::{Logs, Robot, Run, Scene};

/// What robots that fit on a floor measure, cm or cm/s.
const FITTED_CM: Range<f64> = 1.5..500.0;

/// The logs, and what is to be told about them.
pub struct Assembled {
    /// The logs.
    pub logs: Logs,
    /// The draft of the robot, where the user gave none.
    pub draft: Option<RobotDraft>,
    /// What was done.
    pub report: RecordingsReport,
}

/// Assembles recordings, of which there is at least one. Without a `robot` its measures are fitted where they can be, and
/// told. `watch` is told how often the recordings were brought onto one clock, of how often they will be.
///
/// # Errors
/// When streams have nothing in common, when units or frames do not go together, or when nothing is left.
pub fn assemble(
    mut recordings: Vec<Recording>,
    robot: Option<Robot>,
    scene: Scene,
    offset_ms: Option<f64>,
    watch: impl Fn(usize, usize),
) -> Result<Assembled> {
    let counter = Counter::new(
        recordings.len() * if robot.is_none() && !all_of(&recordings, Kind::Twist) { 2 } else { 1 },
        watch,
    );
    let first_guess = match robot {
        Some(robot) => robot,
        None => first_guess(&recordings)?.robot()?,
    };
    if robot.is_some_and(|robot| robot.ultrasonic.is_none()) {
        recordings.iter_mut().for_each(Recording::leave_readings_out);
    }
    let as_stated = Clocks { offset_ms: offset_ms.unwrap_or(0.0), drift: 0.0 };
    let mut runs = Vec::new();
    for recording in &recordings {
        runs.extend(Prepared::of(recording, &first_guess)?.runs(&as_stated, &first_guess, runs.len()));
    }
    let frame = put_right(&mut recordings, &Logs { robot: first_guess, scene: scene.clone(), runs });
    let draft = if robot.is_some() { None } else { Some(fitted(&recordings, offset_ms, &counter)?) };
    let robot = draft.as_ref().map_or(Ok(first_guess), RobotDraft::robot)?;
    let (mut runs, mut reports) = (Vec::new(), Vec::new());
    for recording in &recordings {
        let (of_recording, report) = runs_of(recording, &robot, offset_ms, runs.len())?;
        runs.extend(of_recording);
        reports.push(report);
        counter.one_more();
    }
    let logs = Logs { robot, scene, runs };
    let sides = Sides::of_commands(&logs.runs, &logs.robot);
    let inspected = Inspection::of(logs.clone());
    let units = sides.refusal("the commands", "the track");
    if let Some(why) = units.or_else(|| inspected.refusal().map(str::to_owned)) {
        return Err(Error::in_file(&recordings[0].track, why));
    }
    let findings = inspected.findings.iter().map(|found| found.line()).collect();
    let report = RecordingsReport { recordings: reports, sides, frame, findings, to_fill_in: Vec::new() };
    Ok(Assembled { logs, draft, report })
}

/// A draft that is wide enough for whatever recordings ask for.
fn first_guess(recordings: &[Recording]) -> Result<RobotDraft> {
    let mut draft = RobotDraft::blank();
    draft.has_sensor = Some(recordings.iter().any(|recording| recording.readings.is_some()));
    let spacing_ms = recordings.iter().map(|r| spacing_ms(&r.poses.iter().flatten().copied().collect::<Vec<_>>()));
    let spacing_ms = spacing_ms.fold(0.0, f64::max);
    if spacing_ms > draft.step_ms.value {
        draft.step_ms.value = 100.0 * (spacing_ms / 100.0).ceil();
    }
    let all_motors = all_of(recordings, Kind::Motors);
    draft.full_speed_cm_s.value = if all_motors { 100.0 } else { fastest_cm_s(recordings, &draft.robot()?) };
    Ok(draft)
}

/// A draft with what recordings say of the robot.
fn fitted(
    recordings: &[Recording],
    offset_ms: Option<f64>,
    counter: &Counter<impl Fn(usize, usize)>,
) -> Result<RobotDraft> {
    let mut draft = first_guess(recordings)?;
    let robot = draft.robot()?;
    if all_of(recordings, Kind::Twist) {
        let how =
            "between the middles of the driven wheels; of commands that are speed and turn rate it changes nothing";
        draft.track_cm.how = how.into();
    } else {
        let mut runs = Vec::new();
        for recording in recordings {
            runs.extend(runs_of(recording, &robot, offset_ms, runs.len())?.0);
            counter.one_more();
        }
        let sides = Sides::of_commands(&runs, &robot);
        let fit = |value: f64, what: &str| {
            if !FITTED_CM.contains(&value) {
                let why = format!(
                    "{what} would have to be {value:.3} to explain the track: its unit seems to be another one"
                );
                return Err(Error::in_file(&recordings[0].track, why));
            }
            Ok(Measure::open(value, "fitted to these logs, so that no gap in it can show: measure it"))
        };
        let length = if all_of(recordings, Kind::Motors) { sides.of_travel } else { Some(1.0) };
        if let Some(length) = length.filter(|_| all_of(recordings, Kind::Motors)) {
            draft.full_speed_cm_s = fit(length * robot.full_speed_cm_s, "full_speed_cm_s")?;
        }
        if let Some((turn, length)) = sides.of_rotation.zip(length).filter(|(turn, _)| *turn != 0.0) {
            draft.track_cm = fit(robot.track_cm * length / turn.abs(), "track_cm")?;
        }
    }
    if !all_of(recordings, Kind::Motors) {
        let how = "the fastest that a wheel was asked for, rounded up; commands are shares of it";
        draft.full_speed_cm_s = Measure::known(fastest_cm_s(recordings, &draft.robot()?), how);
    }
    Ok(draft)
}

/// Whether the commands of all recordings are of a kind.
fn all_of(recordings: &[Recording], kind: Kind) -> bool {
    recordings.iter().all(|recording| recording.commands.kind == kind)
}

/// The fastest that a wheel is asked for, rounded up to whole 5 cm/s.
fn fastest_cm_s(recordings: &[Recording], robot: &Robot) -> f64 {
    let commands = recordings.iter().map(|recording| &recording.commands);
    let speeds = commands.flat_map(|c| c.samples.iter().flat_map(|(_, pair)| c.kind.wheels_cm_s(*pair, robot)));
    5.0 * (speeds.map(f64::abs).fold(0.0, f64::max) / 5.0).ceil().max(1.0)
}

/// The runs of one recording, numbered from `first`.
fn runs_of(
    recording: &Recording,
    robot: &Robot,
    offset_ms: Option<f64>,
    first: usize,
) -> Result<(Vec<Run>, RecordingReport)> {
    let prepared = Prepared::of(recording, robot)?;
    let (clocks, clocks_report) = clock::aligned(&prepared, robot, recording.has_one_clock, offset_ms)?;
    let runs = prepared.runs(&clocks, robot, first);
    if runs.is_empty() {
        let what = "has no stretch of poses beside commands that is as long as a few steps";
        return Err(Error::in_file(&prepared.file, what));
    }
    let rows = || runs.iter().flat_map(|run| &run.rows);
    let report = RecordingReport {
        sources: recording.sources.clone(),
        clocks: clocks_report,
        runs: runs.iter().map(|run| run.name.clone()).collect(),
        rows: rows().count(),
        without_pose: rows().filter(|row| row.pose.is_none()).count(),
        with_reading: rows().filter(|row| row.echo_cm.is_some()).count(),
        jumps: prepared.jumps,
        limited: prepared.limited,
    };
    Ok((runs, report))
}

#[cfg(test)]
mod tests;
