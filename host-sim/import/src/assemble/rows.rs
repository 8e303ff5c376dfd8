//! Rows of logs from streams on one clock.

use std::path::{Path, PathBuf};

use crate::clocks::Clocks;
use crate::frame::Frame;
use crate::recording::{Commands, Readings, Recording};
use crate::track::Track;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_foundations::statistics::summary::median;
use mindgap_logs::{Robot, Row, Run};

/// Where the poses end for longer than this a run ends.
const PAUSE_MS: f64 = 5000.0;
/// After its last command a robot is followed for this long.
const AFTER_MS: f64 = 1000.0;
/// A run has at least so many steps.
const FEWEST_STEPS: f64 = 4.0;
/// Poses of slow trackers are taken to lie on a line between two that are this multiple of their usual distance apart,
const USUAL_GAP: f64 = 2.5;
/// and are spread to at most this distance, ms.
const DENSE_MS: f64 = 50.0;
/// A recording lasts no longer, ms: a hundred hours.
const LONGEST_MS: f64 = 3.6e8;

/// A recording whose commands are those of motors and whose track is without jumps.
pub struct Prepared {
    /// The file of its track.
    pub file: PathBuf,
    /// What the motors were told.
    pub commands: Commands,
    /// Number of commands that were limited to the robot's full speed.
    pub limited: usize,
    /// Where the robot was.
    pub track: Track,
    /// Number of poses that no robot can reach.
    pub jumps: usize,
    readings: Option<Readings>,
}

impl Prepared {
    /// Prepares a recording.
    ///
    /// # Errors
    /// When its commands are beyond the robot, or its times beyond any recording's.
    pub fn of(recording: &Recording, robot: &Robot) -> Result<Self> {
        let file = recording.track.clone();
        let (commands, limited) = recording.commands.of_motors(robot, &file)?;
        if commands.samples.len() < 2 {
            return Err(Error::in_file(&file, format!("goes with {} command(s)", commands.samples.len())));
        }
        check_span(&file, commands.samples.iter().map(|(ms, _)| *ms))?;
        check_span(&file, recording.poses.iter().flatten().map(|frame| frame.t_ms))?;
        let (track, jumps) = track(&file, &recording.poses, robot)?;
        Ok(Prepared { file, commands, limited, track, jumps, readings: recording.readings.clone() })
    }

    /// Its runs, numbered from `first`: one for each stretch of poses beside commands.
    pub fn runs(&self, clocks: &Clocks, robot: &Robot, first: usize) -> Vec<Run> {
        let samples = &self.commands.samples;
        let (begin_ms, end_ms) = (samples[0].0, samples[samples.len() - 1].0 + AFTER_MS.max(robot.step_ms));
        let own_ms = |camera_ms: f64| (camera_ms - clocks.offset_ms) / (1.0 + clocks.drift);
        let mut runs: Vec<Run> = Vec::new();
        for stretch in self.track.stretches(PAUSE_MS) {
            let (from_ms, to_ms) = (own_ms(stretch[0]).max(begin_ms), own_ms(stretch[1]).min(end_ms));
            let steps = ((to_ms - from_ms) / robot.step_ms).floor();
            if steps < FEWEST_STEPS {
                continue;
            }
            let row = |step: usize| {
                let since_ms = step as f64 * robot.step_ms;
                // A rounding error does not lead out of the stretch.
                let camera_ms = clocks.camera_ms(from_ms + since_ms).clamp(stretch[0], stretch[1]);
                self.row(robot, from_ms, since_ms, camera_ms)
            };
            let rows = (0..=steps as usize).map(row);
            runs.push(Run { name: format!("run-{:03}", first + runs.len()), rows: rows.collect() });
        }
        runs
    }

    /// The row at a time since the run began, which is a time of the poses' clock.
    fn row(&self, robot: &Robot, begin_ms: f64, since_ms: f64, camera_ms: f64) -> Row {
        let t_ms = begin_ms + since_ms;
        let [left, right] = self.commands.mean(t_ms, t_ms + robot.step_ms);
        let reading =
            |readings: &Readings| readings.at(if readings.on_clock_of_poses { camera_ms } else { t_ms }, robot.step_ms);
        let echo_cm = self.readings.as_ref().and_then(reading);
        Row { t_ms: since_ms, left, right, pose: self.track.at(camera_ms).pose(), echo_cm, ..Row::default() }
    }
}

/// Refuses times that no recording has, from which millions of rows would follow.
fn check_span(file: &Path, mut times_ms: impl Iterator<Item = f64>) -> Result<()> {
    let first = times_ms.next().unwrap_or(0.0);
    let span_ms = times_ms.last().unwrap_or(first) - first;
    if span_ms <= LONGEST_MS {
        return Ok(());
    }
    let what =
        format!("lasts {:.0} hours: the unit of its time seems to be another one; give --time-unit", span_ms / 3.6e6);
    Err(Error::in_file(file, what))
}

/// The track of poses, with those of slow trackers spread on lines between them, and the number of jumps.
fn track(file: &Path, poses: &[Option<Frame>], robot: &Robot) -> Result<(Track, usize)> {
    let seen: Vec<Frame> = poses.iter().flatten().copied().collect();
    let usual_ms = spacing_ms(&seen);
    let plain = Track::of(file, seen.into_iter().map(Some).collect(), robot)?;
    let (report, frames) = (plain.report(), plain.frames());
    // In another unit nearly every frame is a jump: that is told by the sides of the motion.
    let is_elsewhere = 2 * report.jumps > report.frames;
    let kept: Vec<Frame> = if is_elsewhere { poses.iter().flatten().copied().collect() } else { frames.to_vec() };
    let jumps = if is_elsewhere { 0 } else { report.jumps };
    let mut dense: Vec<Frame> = Vec::with_capacity(kept.len());
    for pair in kept.windows(2) {
        let ms = pair[1].t_ms - pair[0].t_ms;
        let parts = if ms <= USUAL_GAP * usual_ms { (ms / DENSE_MS).ceil().max(1.0) } else { 1.0 };
        dense.extend((0..parts as usize).map(|part| between(&pair[0], &pair[1], part as f64 / parts)));
    }
    dense.extend(kept.last());
    Ok((Track::without_check(file, dense), jumps))
}

fn between(from: &Frame, to: &Frame, share: f64) -> Frame {
    let turn_rad = wrap_rad(to.pose.heading_rad - from.pose.heading_rad);
    let at_cm = from.pose.position_cm.lerp(to.pose.position_cm, share);
    let pose = Pose::new(at_cm.x, at_cm.y, from.pose.heading_rad + share * turn_rad);
    Frame { t_ms: from.t_ms + share * (to.t_ms - from.t_ms), pose }
}

/// The usual time between two frames, ms; NaN of fewer.
pub fn spacing_ms(frames: &[Frame]) -> f64 {
    median(frames.windows(2).map(|pair| pair[1].t_ms - pair[0].t_ms))
}
