//! Assembles recordings into logs: aligns clocks, resamples poses and readings to rows, corrects the frame, and checks units
//! and scale.

mod clock;
mod frame;
mod pauses;
mod rows;
mod sensors;

use std::ops::Range;
use std::sync::Arc;

use self::frame::{correct_frame, unmirror};
pub use self::pauses::Watchdog;
use self::rows::{Prepared, spacing_ms};
use super::clocks::Clocks;
use super::draft::{Measure, RobotDraft};
use super::left_out::LeftOut;
use super::recording::{Kind, Recording};
use super::report::{RecordingReport, RecordingsReport, SensorReport, without_poses};
use super::rotation;
use super::scale_check::ScaleCheck;
use mindgap_foundations::counter::Counter;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::heard::Heard;
use mindgap_logs::inspection::{Finding, Inspection, Part};
use mindgap_logs::range_sensor::{RangeSensor, Sensors};
use mindgap_logs::{Logs, Robot, Run, Scene};

/// Plausible range of fitted robot dimensions and speeds, cm or cm/s.
const PLAUSIBLE_CM: Range<f64> = 1.5..500.0;

/// Assembled logs with their report.
pub struct Assembled {
    /// The logs.
    pub logs: Logs,
    /// Draft of the robot, if the user gave none.
    pub draft: Option<RobotDraft>,
    /// What was guessed, changed or left out.
    pub report: RecordingsReport,
}

/// What the user states about the clocks and the base of recordings.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stated {
    /// Lead of the poses' clock, ms.
    pub offset_ms: Option<f64>,
    /// What the base does without commands; inferred from the motion if `None`.
    pub watchdog: Option<Watchdog>,
}

/// Assembles at least one recording. Without a `robot` and its range sensors, its dimensions are fitted where possible and
/// reported. `watch` receives the number of recordings aligned so far and their total. A recording that cannot be used is left
/// out, with its reason, as long as another remains.
///
/// # Errors
/// When no recording can be used, or when units or frames are inconsistent.
pub fn assemble(
    mut recordings: Vec<Recording>,
    robot: Option<(Robot, Sensors)>,
    scene: Scene,
    stated: Stated,
    watch: impl Fn(usize, usize),
) -> Result<Assembled> {
    recordings.iter_mut().for_each(Recording::correct_signs);
    let (robot, sensors) = robot.unzip();
    let (sensors, silent) = sensors::heard(&mut recordings, &sensors.unwrap_or_default());
    let counter = Counter::new(
        recordings.len() * if robot.is_none() && !all_of(&recordings, Kind::Twist) { 2 } else { 1 },
        watch,
    );
    let first_guess = match robot {
        Some(robot) => robot,
        None => first_guess(&recordings)?.robot()?,
    };
    if robot.is_some_and(|robot| robot.ultrasonic.is_none()) {
        recordings.iter_mut().for_each(Recording::drop_readings);
    }
    let stated_clocks = Clocks { offset_ms: stated.offset_ms.unwrap_or(0.0), drift: 0.0 };
    let mut runs = Vec::new();
    for recording in &recordings {
        if let Ok(prepared) = Prepared::of(recording, &first_guess) {
            runs.extend(prepared.runs(&stated_clocks, &first_guess, runs.len()));
        }
    }
    let logs = Logs { robot: first_guess, scene: scene.clone(), runs };
    let turned = correct_frame(&mut recordings, &logs);
    let mirrored = unmirror(&mut recordings, &first_guess, &scene, stated)?;
    let frame = turned.into_iter().chain(mirrored).collect::<Vec<_>>().join("; ");
    let frame = Some(frame).filter(|description| !description.is_empty());
    let draft = if robot.is_some() { None } else { Some(fitted(&recordings, stated, &counter)?) };
    let robot = draft.as_ref().map_or(Ok(first_guess), RobotDraft::robot)?;
    let (mut runs, mut reports, mut left_out, mut error) = (Vec::new(), Vec::new(), Vec::new(), None);
    for recording in &recordings {
        match runs_of(recording, &robot, &sensors, stated, runs.len()) {
            Ok((new_runs, report)) => {
                runs.extend(new_runs);
                reports.push(report);
            }
            Err(e) => {
                left_out.push(LeftOut::failed(&recording.file, &e));
                error = error.or(Some(e));
            }
        }
        counter.increment();
    }
    if let (true, Some(error)) = (runs.is_empty(), error) {
        return Err(error);
    }
    let logs = Logs { robot, scene, runs };
    let scale_check = ScaleCheck::of_commands(&logs.runs, &logs.robot);
    let inspected = Inspection::new(logs.clone());
    let mismatch = scale_check.refusal("the commands", "the track");
    if let Some(why) = mismatch.or_else(|| inspected.withheld(Part::Motion).map(str::to_owned)) {
        return Err(Error::in_file(&recordings[0].file, why));
    }
    let of_further = further_findings(&logs, &inspected.findings);
    let findings = inspected.findings.iter().chain(&of_further).map(Finding::line).chain(silent).collect();
    let unused = recordings.iter().flat_map(|r| &r.sources).flat_map(|source| &source.unused).cloned();
    left_out.extend(unused);
    let report = RecordingsReport {
        untracked: untracked(&reports),
        recordings: reports,
        odometry_check: scale_check,
        frame,
        findings,
        to_fill_in: Vec::new(),
        left_out,
    };
    Ok(Assembled { logs, draft, report })
}

/// Returns a draft fast enough for all commands in the recordings.
fn first_guess(recordings: &[Recording]) -> Result<RobotDraft> {
    let mut draft = RobotDraft::blank();
    draft.has_sensor = Some(recordings.iter().any(|recording| !recording.readings.is_empty()));
    let spacing_ms = recordings.iter().map(|recording| spacing_ms(&recording.poses));
    let spacing_ms = spacing_ms.fold(0.0, f64::max);
    if spacing_ms > draft.step_ms.value {
        draft.step_ms.value = 100.0 * (spacing_ms / 100.0).ceil();
    }
    let all_motors = all_of(recordings, Kind::Motors);
    draft.full_speed_cm_s.value = if all_motors { 100.0 } else { fastest_cm_s(recordings, &draft.robot()?) };
    Ok(draft)
}

/// Returns a draft with the dimensions that can be fitted to the recordings.
fn fitted(recordings: &[Recording], stated: Stated, counter: &Counter<impl Fn(usize, usize)>) -> Result<RobotDraft> {
    let mut draft = first_guess(recordings)?;
    let robot = draft.robot()?;
    if all_of(recordings, Kind::Twist) {
        let how = "between the centres of the driven wheels; has no effect on commands given as speed and turn rate";
        draft.track_cm.note = how.into();
    } else {
        let mut runs = Vec::new();
        for recording in recordings {
            match runs_of(recording, &robot, &Arc::default(), stated, runs.len()) {
                Ok((new_runs, _)) => runs.extend(new_runs),
                Err(error) if recordings.len() == 1 => return Err(error),
                // It is left out later, with its reason.
                Err(_) => {}
            }
            counter.increment();
        }
        let scale_check = ScaleCheck::of_commands(&runs, &robot);
        let fit = |value: f64, what: &str| {
            if !PLAUSIBLE_CM.contains(&value) {
                let why = format!("{what} would have to be {value:.3} to explain the track: its unit seems wrong");
                return Err(Error::in_file(&recordings[0].file, why));
            }
            Ok(Measure::placeholder(value, "fitted to these logs, so an error in it cannot show: measure it"))
        };
        let length = if all_of(recordings, Kind::Motors) { scale_check.travel_ratio } else { Some(1.0) };
        if let Some(length) = length.filter(|_| all_of(recordings, Kind::Motors)) {
            draft.full_speed_cm_s = fit(length * robot.full_speed_cm_s, "full_speed_cm_s")?;
        }
        if let Some((turn, length)) = scale_check.rotation_ratio.zip(length).filter(|(turn, _)| *turn != 0.0) {
            draft.track_cm = fit(robot.track_cm * length / turn.abs(), "track_cm")?;
        }
    }
    if !all_of(recordings, Kind::Motors) {
        let how = "the fastest commanded wheel speed, rounded up; commands are fractions of it";
        draft.full_speed_cm_s = Measure::known(fastest_cm_s(recordings, &draft.robot()?), how);
    }
    Ok(draft)
}

/// Returns whether the commands of all recordings are of one kind.
fn all_of(recordings: &[Recording], kind: Kind) -> bool {
    recordings.iter().all(|recording| recording.commands.kind == kind)
}

/// Returns the fastest commanded wheel speed, rounded up to a multiple of 5 cm/s.
fn fastest_cm_s(recordings: &[Recording], robot: &Robot) -> f64 {
    let commands = recordings.iter().map(|recording| &recording.commands);
    let speeds = commands.flat_map(|c| c.samples.iter().flat_map(|(_, pair)| c.kind.wheels_cm_s(*pair, robot)));
    5.0 * (speeds.map(f64::abs).fold(0.0, f64::max) / 5.0).ceil().max(1.0)
}

/// Returns the runs of one recording, numbered from `first`, and its report.
fn runs_of(
    recording: &Recording,
    robot: &Robot,
    sensors: &Arc<Sensors>,
    stated: Stated,
    first: usize,
) -> Result<(Vec<Run>, RecordingReport)> {
    if let Some(what) = rotation::missing(recording, robot) {
        return Err(Error::in_file(&recording.file, what));
    }
    let mut prepared = Prepared::of(recording, robot)?;
    prepared.check_motion()?;
    let pauses = pauses::apply(&mut prepared, robot, recording.has_one_clock, stated);
    let (clocks, clocks_report) = clock::aligned(&prepared, robot, recording.has_one_clock, stated.offset_ms)?;
    prepared.sensors = Arc::clone(sensors);
    let runs = prepared.runs(&clocks, robot, first);
    if runs.is_empty() {
        let what = format!("has no period with both {} and commands that lasts a few steps", prepared.shown_by);
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
        further_sensors: sensors
            .further()
            .iter()
            .enumerate()
            .map(|(i, sensor)| with_reading(&runs, i, sensor))
            .collect(),
        with_counters: rows().filter(|row| row.rot_left_deg.is_some() && row.rot_right_deg.is_some()).count(),
        with_gyro: rows().filter(|row| row.gyro_deg_s.is_some()).count(),
        jumps: prepared.jumps,
        saturated: prepared.saturated,
        pauses,
    };
    Ok((runs, report))
}

/// Returns what a diagnosis can do with the recordings that have no poses, if there are any.
fn untracked(reports: &[RecordingReport]) -> Option<String> {
    let untracked: Vec<&RecordingReport> = reports.iter().filter(|report| report.is_untracked()).collect();
    let [counters, gyro] =
        [|report: &RecordingReport| report.with_counters, |report: &RecordingReport| report.with_gyro]
            .map(|rows| untracked.iter().any(|report| rows(report) > 0));
    without_poses([untracked.len(), reports.len()], counters, gyro)
}

/// Counts the readings of a further range sensor.
fn with_reading(runs: &[Run], index: usize, sensor: &RangeSensor) -> SensorReport {
    let readings = runs.iter().flat_map(|run| (0..run.rows.len()).filter_map(move |k| run.rows.further_cm(index, k)));
    SensorReport { sensor: sensor.name.clone(), with_reading: readings.count() }
}

/// Returns what the inspection finds by the further range sensors beyond what is `known`.
fn further_findings(logs: &Logs, known: &[Finding]) -> Vec<Finding> {
    let of_sensor = |heard: Heard| {
        let found = Inspection::new(heard.logs).findings.into_iter();
        found.filter(|found| !known.contains(found)).map(move |found| found.of_sensor(&heard.sensor))
    };
    logs.by_further_sensor().into_iter().flat_map(of_sensor).collect()
}

#[cfg(test)]
mod tests;
