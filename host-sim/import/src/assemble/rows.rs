//! Resamples streams on one clock to rows of logs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::clocks::Clocks;
use crate::frame::Frame;
use crate::own_motion::OwnMotion;
use crate::recording::{Commands, Readings, Recording};
use crate::track::Track;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::statistics::summary::median;
use mindgap_logs::range_sensor::Sensors;
use mindgap_logs::{CommandChange, CommandChanges, Robot, Row, Rows, Run};

/// A gap in the poses longer than this ends a run, ms.
const PAUSE_MS: f64 = 5000.0;
/// Rows continue for this long after the last command, ms.
const AFTER_MS: f64 = 1000.0;
/// Commands of this long before a run are kept, ms: they still move a robot whose dead time and lags take a second or two.
const BEFORE_MS: f64 = 5000.0;
/// Commands this close to a row are set at it, ms: no robot moves measurably in that time.
const ON_ROW_MS: f64 = 1.0;
/// Minimum number of steps of a run.
const MIN_STEPS: f64 = 4.0;
/// Poses of slow trackers are interpolated between frames up to this multiple of their usual interval apart.
const USUAL_GAP: f64 = 2.5;
/// Maximum interval of interpolated poses, ms.
const DENSE_MS: f64 = 50.0;
/// A robot that moves no farther than this stays in its place: more than the noise of any tracker, cm and rad.
const STILL_CM: f64 = 2.0;
const STILL_RAD: f64 = 0.09;
/// Maximum duration of a recording, ms: a hundred hours.
const MAX_DURATION_MS: f64 = 3.6e8;

/// A recording with motor commands and a track without jumps.
pub struct Prepared<'a> {
    /// File of the track.
    pub file: PathBuf,
    /// Motor commands.
    pub commands: Commands,
    /// Number of commands that were saturated at the robot's full speed.
    pub saturated: usize,
    /// The robot's poses; by dead reckoning if nobody tracked it.
    pub track: Track<'a>,
    /// What shows the motion, in words.
    pub shown_by: &'static str,
    /// Number of poses excluded as jumps.
    pub jumps: usize,
    /// Whether anybody tracked it.
    pub is_tracked: bool,
    readings: &'a [Readings],
    own_motion: &'a OwnMotion,
    /// The range sensors of the rows.
    pub sensors: Arc<Sensors>,
}

impl<'a> Prepared<'a> {
    /// Prepares a recording.
    ///
    /// # Errors
    /// When many commands exceed the robot's speed, its times span more than any recording, or nothing shows its motion.
    pub fn of(recording: &'a Recording, robot: &Robot) -> Result<Self> {
        let file = recording.file.clone();
        let (commands, saturated) = recording.commands.as_motor_commands(robot, &file)?;
        if commands.samples.len() < 2 {
            return Err(Error::in_file(&file, format!("has only {} command(s)", commands.samples.len())));
        }
        check_span(&file, commands.samples.iter().map(|(ms, _)| *ms))?;
        check_span(&file, recording.poses.iter().map(|frame| frame.t_ms))?;
        let (readings, own_motion) = (recording.readings.as_slice(), &recording.own_motion);
        let is_tracked = recording.is_tracked();
        let (track, jumps) = match is_tracked {
            true => track(&file, &recording.poses, robot)?,
            false => (reckoned(&file, own_motion, robot)?, 0),
        };
        let shown_by = match is_tracked {
            true => "poses",
            false if own_motion.has_counters() => "rotation counters",
            false => "a gyro",
        };
        let sensors = Arc::default();
        Ok(Prepared { file, commands, saturated, track, shown_by, jumps, is_tracked, readings, own_motion, sensors })
    }

    /// Checks that the robot moves; a gyro alone does not show that.
    ///
    /// # Errors
    /// When it stays in its place.
    pub fn check_motion(&self) -> Result<()> {
        let frames = self.track.frames();
        if !self.is_tracked && !self.own_motion.has_counters() {
            return Ok(());
        }
        let Some(first) = frames.first() else { return Ok(()) };
        let moved = frames.iter().map(|frame| first.pose.relative(&frame.pose));
        let (cm, rad) = moved.fold((0.0_f64, 0.0_f64), |(cm, rad), change| {
            (cm.max(change.position_cm.length()), rad.max(change.heading_rad.abs()))
        });
        if cm > STILL_CM || rad > STILL_RAD {
            return Ok(());
        }
        let fastest =
            self.commands.samples.iter().flat_map(|(_, pair)| pair).fold(0.0_f64, |most, c| most.max(c.abs()));
        let commands = match fastest {
            0.0 => "and all commands are zero".to_owned(),
            fastest => format!(
                "although commands reach {fastest:.0} % of full speed: are the motors on, and are these its own {}?",
                self.shown_by
            ),
        };
        let what = format!(
            "the robot never moves: its {} stay within {cm:.1} cm and {:.1} deg, {commands}",
            self.shown_by,
            rad.to_degrees()
        );
        Err(Error::in_file(&self.file, what))
    }

    /// Returns its runs, numbered from `first`: one per period with poses and commands.
    pub fn runs(&self, clocks: &Clocks, robot: &Robot, first: usize) -> Vec<Run> {
        let samples = &self.commands.samples;
        let (begin_ms, end_ms) = (samples[0].0, samples[samples.len() - 1].0 + AFTER_MS.max(robot.step_ms));
        let command_ms = |camera_ms: f64| (camera_ms - clocks.offset_ms) / (1.0 + clocks.drift);
        let mut runs: Vec<Run> = Vec::new();
        for period in self.track.periods(PAUSE_MS) {
            let (from_ms, to_ms) = (command_ms(period[0]).max(begin_ms), command_ms(period[1]).min(end_ms));
            let steps = ((to_ms - from_ms) / robot.step_ms).floor();
            if steps < MIN_STEPS {
                continue;
            }
            let mut rows = Rows::of(Arc::clone(&self.sensors));
            let heard = 1..=self.sensors.further().len();
            for step in 0..=steps as usize {
                let since_ms = step as f64 * robot.step_ms;
                // Rounding errors must not lead out of the period.
                let camera_ms = clocks.camera_ms(from_ms + since_ms).clamp(period[0], period[1]);
                rows.push(self.row(robot, from_ms, since_ms, camera_ms));
                for readings in self.readings.iter().filter(|readings| heard.contains(&readings.sensor)) {
                    let reading_cm = readings.at([from_ms + since_ms, camera_ms], robot.step_ms);
                    rows.set_further_cm(readings.sensor - 1, step, reading_cm);
                }
            }
            if let Some(changes) = self.changes_off_rows(from_ms, from_ms + steps * robot.step_ms, robot.step_ms) {
                rows.set_changes(changes);
            }
            runs.push(Run { name: format!("run-{:03}", first + runs.len()), rows });
        }
        runs
    }

    /// Returns the commands of a run at their own times; `None` if all of them fall on its rows.
    fn changes_off_rows(&self, from_ms: f64, to_ms: f64, step_ms: f64) -> Option<CommandChanges> {
        let samples = &self.commands.samples;
        let index = |t_ms: f64| samples.partition_point(|(ms, _)| *ms <= t_ms);
        let first = index(from_ms - BEFORE_MS).max(1) - 1;
        let change = |(t_ms, command): &(f64, [f64; 2])| CommandChange { t_ms: t_ms - from_ms, command: *command };
        let changes = CommandChanges::of(samples[first..index(to_ms + step_ms)].iter().map(change))?;
        let off_row_ms = |t_ms: f64| (t_ms - step_ms * (t_ms / step_ms).round()).abs();
        let is_off = |change: &CommandChange| {
            if change.t_ms < -ON_ROW_MS { change.command != [0.0; 2] } else { off_row_ms(change.t_ms) > ON_ROW_MS }
        };
        changes.as_slice().iter().any(is_off).then_some(changes)
    }

    /// Returns the row at `since_ms` after the start of the run, at time `camera_ms` of the poses' clock.
    fn row(&self, robot: &Robot, begin_ms: f64, since_ms: f64, camera_ms: f64) -> Row {
        let t_ms = begin_ms + since_ms;
        let [left, right] = self.commands.mean(t_ms, t_ms + robot.step_ms);
        let first = self.readings.iter().find(|readings| readings.sensor == 0);
        let times_ms = [t_ms, camera_ms];
        let angle_deg = |side| self.own_motion.angle_rad(side, times_ms).map(f64::to_degrees);
        Row {
            t_ms: since_ms,
            left,
            right,
            pose: self.track.at(camera_ms).pose().filter(|_| self.is_tracked),
            echo_cm: first.and_then(|readings| readings.at(times_ms, robot.step_ms)),
            rot_left_deg: angle_deg(0),
            rot_right_deg: angle_deg(1),
            battery_mv: None,
            gyro_deg_s: self.own_motion.yaw_rad_s(times_ms).map(f64::to_degrees),
        }
    }
}

/// Rejects time spans longer than any recording, which would give millions of rows.
fn check_span(file: &Path, mut times_ms: impl Iterator<Item = f64>) -> Result<()> {
    let first = times_ms.next().unwrap_or(0.0);
    let span_ms = times_ms.last().unwrap_or(first) - first;
    if span_ms <= MAX_DURATION_MS {
        return Ok(());
    }
    let what = format!("lasts {:.0} hours: its unit of time seems wrong; give --time-unit", span_ms / 3.6e6);
    Err(Error::in_file(file, what))
}

/// Returns the track of a robot that nobody tracked.
fn reckoned(file: &Path, own_motion: &OwnMotion, robot: &Robot) -> Result<Track<'static>> {
    let frames = own_motion.dead_reckoned(robot);
    if frames.len() < 2 {
        return Err(Error::in_file(
            file,
            "has neither poses nor rotation counters nor a gyro: nothing shows its motion",
        ));
    }
    Ok(Track::without_check(file, frames))
}

/// Returns the track of poses, interpolated for slow trackers, and the number of jumps.
fn track<'a>(file: &Path, poses: &'a [Frame], robot: &Robot) -> Result<(Track<'a>, usize)> {
    let usual_ms = spacing_ms(poses);
    let plain = Track::seen(file, poses, robot)?;
    let report = plain.report();
    // In a wrong unit nearly every frame is a jump: the scale check reports that.
    let has_wrong_unit = 2 * report.jumps > report.frames;
    let (kept, jumps) = if has_wrong_unit { (Track::without_check(file, poses), 0) } else { (plain, report.jumps) };
    let parts = |pair: &[Frame]| {
        let ms = pair[1].t_ms - pair[0].t_ms;
        if ms <= USUAL_GAP * usual_ms { (ms / DENSE_MS).ceil().max(1.0) } else { 1.0 }
    };
    let pairs = || kept.frames().windows(2).map(|pair| (pair, parts(pair)));
    if pairs().all(|(_, parts)| parts == 1.0) {
        return Ok((kept, jumps));
    }
    let mut dense: Vec<Frame> = Vec::with_capacity(kept.frames().len());
    for (pair, parts) in pairs() {
        dense.extend((0..parts as usize).map(|part| between(&pair[0], &pair[1], part as f64 / parts)));
    }
    dense.extend(kept.frames().last());
    Ok((Track::without_check(file, dense), jumps))
}

fn between(from: &Frame, to: &Frame, share: f64) -> Frame {
    Frame { t_ms: from.t_ms + share * (to.t_ms - from.t_ms), pose: from.pose.between(&to.pose, share) }
}

/// Returns the median interval of frames, ms; NaN with fewer than two.
pub fn spacing_ms(frames: &[Frame]) -> f64 {
    median(frames.windows(2).map(|pair| pair[1].t_ms - pair[0].t_ms))
}
