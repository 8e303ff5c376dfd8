//! A camera's track: the robot's pose frame by frame, on the camera's own clock.

mod columns;
mod motive;

use std::path::{Path, PathBuf};

use super::frame::{Frame, GAP_MS};
use super::motion::{CumulativeMotion, by_camera};
use super::report::TrackReport;
use super::units::Units;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_logs::Robot;

/// A camera's track.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Its file.
    pub file: PathBuf,
    /// The frames in which the robot was seen, in order of time.
    frames: Vec<Frame>,
    lost: usize,
    jumps: usize,
}

/// What a track says about a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sighting {
    /// The robot's pose.
    At(Pose),
    /// No pose, since the camera had lost the robot.
    Lost,
    /// No pose, since the time lies before the first or after the last frame.
    Outside,
}

/// Fastest motion of a robot as a multiple of its nominal full speed.
const FASTEST: f64 = 1.5;
/// Tracking errors allowed on top of it.
const ERR_CM: f64 = 4.0;
const ERR_RAD: f64 = 0.25;

impl Track {
    /// Reads a track: CSV whose columns name their units, or a rigid body exported by Motive.
    ///
    /// # Errors
    /// When the file cannot be read or parsed, when a column or its unit is missing, or when the robot was seen in fewer
    /// than two frames.
    pub fn read(file: &Path, units: &Units, robot: &Robot) -> Result<Self> {
        let text = mindgap_files::read_text(file)?;
        let frames =
            if motive::is_one(&text) { motive::frames(file, &text) } else { columns::frames(file, &text, units) };
        Track::of(file, frames?, robot)
    }

    /// A track of frames, `None` where the robot was lost.
    ///
    /// # Errors
    /// When a frame does not come after the one before, or when the robot was seen in fewer than two.
    pub fn of(file: &Path, frames: Vec<Option<Frame>>, robot: &Robot) -> Result<Self> {
        let all = frames.len();
        let seen: Vec<Frame> = frames.into_iter().flatten().collect();
        let (lost, whole) = (all - seen.len(), seen.len());
        if let Some(pair) = seen.windows(2).find(|pair| pair[1].t_ms <= pair[0].t_ms) {
            let what = format!("time {} ms does not come after {} ms", pair[1].t_ms, pair[0].t_ms);
            return Err(Error::in_file(file, what));
        }
        let frames = without_jumps(seen, robot);
        if frames.len() < 2 {
            return Err(Error::in_file(file, format!("has {} frame(s) in which the robot was seen", frames.len())));
        }
        Ok(Track { file: file.to_owned(), lost, jumps: whole - frames.len(), frames })
    }

    /// A track of frames that are known to be in order and within reach.
    pub fn without_check(file: &Path, frames: Vec<Frame>) -> Self {
        Track { file: file.to_owned(), frames, lost: 0, jumps: 0 }
    }

    /// The frames in which the robot was seen.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// When stretches begin and end in which frames are at most `pause_ms` apart.
    pub fn stretches(&self, pause_ms: f64) -> Vec<[f64; 2]> {
        let stretches = self.frames.chunk_by(|a, b| b.t_ms - a.t_ms <= pause_ms);
        stretches.map(|stretch| [stretch[0].t_ms, stretch[stretch.len() - 1].t_ms]).collect()
    }

    /// Number of frames and of those left out.
    pub fn report(&self) -> TrackReport {
        let Track { file, frames, lost, jumps } = self;
        TrackReport { file: file.clone(), frames: frames.len() + lost + jumps, lost: *lost, jumps: *jumps }
    }

    /// The robot's cumulative motion.
    pub fn motion(&self) -> Vec<CumulativeMotion> {
        by_camera(&self.frames)
    }

    /// The robot's pose at a time on the camera's clock, interpolated between two frames.
    pub fn at(&self, t_ms: f64) -> Sighting {
        let after = self.frames.partition_point(|frame| frame.t_ms < t_ms);
        if let Some(exact) = self.frames.get(after).filter(|frame| frame.t_ms == t_ms) {
            return Sighting::At(exact.pose);
        }
        let (Some(after), Some(before)) = (self.frames.get(after), after.checked_sub(1).map(|i| &self.frames[i]))
        else {
            return Sighting::Outside;
        };
        let span_ms = after.t_ms - before.t_ms;
        if span_ms > GAP_MS {
            return Sighting::Lost;
        }
        let share = (t_ms - before.t_ms) / span_ms;
        let turn_rad = wrap_rad(after.pose.heading_rad - before.pose.heading_rad);
        let at_cm = before.pose.position_cm.lerp(after.pose.position_cm, share);
        Sighting::At(Pose::new(at_cm.x, at_cm.y, before.pose.heading_rad + share * turn_rad))
    }
}

impl Sighting {
    /// The pose, if there is one.
    pub fn pose(&self) -> Option<Pose> {
        match self {
            Sighting::At(pose) => Some(*pose),
            Sighting::Lost | Sighting::Outside => None,
        }
    }
}

/// The frames that the robot can have reached from the last frame kept.
fn without_jumps(frames: Vec<Frame>, robot: &Robot) -> Vec<Frame> {
    let cm_ms = FASTEST * robot.full_speed_cm_s / 1000.0;
    let rad_ms = 2.0 * cm_ms / robot.track_cm;
    let mut kept: Vec<Frame> = Vec::with_capacity(frames.len());
    for frame in frames {
        let can_be = kept.last().is_none_or(|last| {
            let (change, ms) = (last.pose.relative(&frame.pose), frame.t_ms - last.t_ms);
            change.position_cm.length() <= ERR_CM + cm_ms * ms && change.heading_rad.abs() <= ERR_RAD + rad_ms * ms
        });
        if can_be {
            kept.push(frame);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::default_robot;

    fn read(text: &str) -> Result<Track> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("track.csv");
        mindgap_files::write(&file, text)?;
        Track::read(&file, &Units::default(), &default_robot())
    }

    #[test]
    fn poses_are_known_between_frames_and_nowhere_else() {
        let text = "time_s,x_m,y_m,heading_rad\n10,0.1,0.2,3.1\n10.1,0.11,0.2,-3.1\n11,0.2,0.2,\n11.5,0.21,0.2,3.0\n";
        let track = read(text).expect("a track");
        assert_eq!((track.frames.len(), track.lost, track.jumps), (3, 1, 0));
        let pose = track.at(10_050.0).pose().expect("seen");
        assert!((pose.position_cm.x - 10.5).abs() < 1e-9 && pose.heading_rad.abs() > 3.1, "{pose:?}");
        assert_eq!(
            [9_999.0, 10_500.0, 11_501.0].map(|ms| track.at(ms)),
            [Sighting::Outside, Sighting::Lost, Sighting::Outside]
        );
    }

    #[test]
    fn a_jump_there_and_back_is_left_out() {
        let frame = |i: usize| format!("{},{},50,0\n", 33 * i, if i == 7 { 140.0 } else { 20.0 + i as f64 });
        let text = "t_ms,x_cm,y_cm,heading_deg\n".to_owned() + &(0..20).map(frame).collect::<String>();
        let track = read(&text).expect("a track");
        assert_eq!((track.frames.len(), track.jumps), (19, 1));
    }

    #[test]
    fn what_is_no_track_is_refused() {
        for (text, what) in [
            ("", "no column"),
            ("t_ms,x_cm,y_cm,heading_deg\n", "0 frame(s)"),
            ("t_ms,x_cm,y_cm,heading_deg\n0,1,1,0\n0,1,1,0\n", "does not come after"),
            ("t_ms,x_cm,y_cm,heading_deg\n0,1,far,0\n", ":2: y_cm = \"far\" is no number"),
            ("t_ms,x_cm,y_cm,heading_deg\n0,1,inf,0\n", ":2: y_cm = \"inf\" is no number"),
            ("t_ms,x_cm,y_cm\n0,1,1\n", ":1: no column for the heading"),
            ("t,x,y,theta\n0,1,1,0\n", ":1: column t has no unit"),
            ("t_ms,x_cm,x_mm,y_cm,heading_deg\n0,1,1,1,0\n", ":1: more than one column for x"),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(what), "{text:?} gave {error}");
        }
    }
}
