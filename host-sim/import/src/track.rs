//! Camera tracks: the robot's pose frame by frame, on the camera's own clock.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::frame::{Frame, GAP_MS};
use super::motion::{CumulativeMotion, by_camera};
use super::report::TrackReport;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_logs::Robot;

/// A camera track.
#[derive(Clone, Debug, PartialEq)]
pub struct Track<'a> {
    /// File of the track.
    pub file: PathBuf,
    /// Body of a motion capture; `None` if the file has a single one without a name.
    pub body: Option<String>,
    /// Frames that show the robot, in temporal order.
    frames: Cow<'a, [Frame]>,
    lost: usize,
    jumps: usize,
}

/// The state of a track at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sighting {
    /// The robot's pose.
    At(Pose),
    /// No pose, since the camera had lost the robot.
    Lost,
    /// No pose, since the time is before the first or after the last frame.
    Outside,
}

/// Maximum speed of a robot as a multiple of its nominal full speed.
const MAX_SPEED_RATIO: f64 = 1.5;
/// Allowed tracking error in position, cm.
const TOLERANCE_CM: f64 = 4.0;
/// Allowed tracking error in heading, rad.
const TOLERANCE_RAD: f64 = 0.25;

impl<'a> Track<'a> {
    /// Builds a track from frames, `None` where the robot was lost, without jumps.
    ///
    /// # Errors
    /// As [`Track::seen`].
    pub fn of(file: &Path, frames: Vec<Option<Frame>>, robot: &Robot) -> Result<Self> {
        let all = frames.len();
        let seen: Vec<Frame> = frames.into_iter().flatten().collect();
        let lost = all - seen.len();
        Ok(Track { lost, ..Track::seen(file, seen, robot)? })
    }

    /// Builds a track from the frames that show the robot, without jumps.
    ///
    /// # Errors
    /// When a frame is not later than the one before, or when there are fewer than two.
    pub fn seen(file: &Path, seen: impl Into<Cow<'a, [Frame]>>, robot: &Robot) -> Result<Self> {
        let seen = seen.into();
        let whole = seen.len();
        if let Some(pair) = seen.windows(2).find(|pair| pair[1].t_ms <= pair[0].t_ms) {
            let what = format!("time {} ms is not later than {} ms before it", pair[1].t_ms, pair[0].t_ms);
            return Err(Error::in_file(file, what));
        }
        let frames = without_jumps(seen, robot);
        if frames.len() < 2 {
            return Err(Error::in_file(file, format!("has {} frame(s) in which the robot was seen", frames.len())));
        }
        Ok(Track { file: file.to_owned(), body: None, lost: 0, jumps: whole - frames.len(), frames })
    }

    /// Names the body; an empty name is that of the only body in a file.
    pub fn of_body(self, name: String) -> Self {
        Track { body: Some(name).filter(|name| !name.is_empty()), ..self }
    }

    /// Builds a track from frames known to be in order and without jumps.
    pub fn without_check(file: &Path, frames: impl Into<Cow<'a, [Frame]>>) -> Self {
        Track { file: file.to_owned(), body: None, frames: frames.into(), lost: 0, jumps: 0 }
    }

    /// Returns the frames that show the robot.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Returns start and end of the periods in which frames are at most `pause_ms` apart.
    pub fn periods(&self, pause_ms: f64) -> Vec<[f64; 2]> {
        let periods = self.frames.chunk_by(|a, b| b.t_ms - a.t_ms <= pause_ms);
        periods.map(|period| [period[0].t_ms, period[period.len() - 1].t_ms]).collect()
    }

    /// Returns the number of frames and of those excluded.
    pub fn report(&self) -> TrackReport {
        let Track { file, body, frames, lost, jumps } = self;
        TrackReport {
            file: file.clone(),
            body: body.clone(),
            frames: frames.len() + lost + jumps,
            lost: *lost,
            jumps: *jumps,
        }
    }

    /// Returns the robot's cumulative motion.
    pub fn motion(&self) -> Vec<CumulativeMotion> {
        by_camera(&self.frames)
    }

    /// Returns the robot's pose at a time on the camera's clock, interpolated between two frames.
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
        Sighting::At(before.pose.between(&after.pose, (t_ms - before.t_ms) / span_ms))
    }
}

impl Sighting {
    /// Returns the pose, if there is one.
    pub fn pose(&self) -> Option<Pose> {
        match self {
            Sighting::At(pose) => Some(*pose),
            Sighting::Lost | Sighting::Outside => None,
        }
    }
}

/// Removes frames that the robot cannot have reached from the last kept frame.
fn without_jumps<'a>(frames: Cow<'a, [Frame]>, robot: &Robot) -> Cow<'a, [Frame]> {
    let cm_ms = MAX_SPEED_RATIO * robot.full_speed_cm_s / 1000.0;
    let rad_ms = 2.0 * cm_ms / robot.track_cm;
    let is_reachable = |from: &Frame, to: &Frame| {
        let (change, ms) = (from.pose.relative(&to.pose), to.t_ms - from.t_ms);
        change.position_cm.length() <= TOLERANCE_CM + cm_ms * ms
            && change.heading_rad.abs() <= TOLERANCE_RAD + rad_ms * ms
    };
    if frames.windows(2).all(|pair| is_reachable(&pair[0], &pair[1])) {
        return frames;
    }
    let mut frames = frames.into_owned();
    let mut last = frames[0];
    frames.retain(|frame| {
        let is_kept = is_reachable(&last, frame);
        if is_kept {
            last = *frame;
        }
        is_kept
    });
    Cow::Owned(frames)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::default_robot;

    fn track(frames: &[Option<[f64; 4]>]) -> Result<Track<'static>> {
        let frame = |[t_ms, x, y, heading]: [f64; 4]| Frame { t_ms, pose: Pose::new(x, y, heading) };
        let frames = frames.iter().map(|values| values.map(frame)).collect();
        Track::of(Path::new("track.csv"), frames, &default_robot())
    }

    #[test]
    fn poses_are_interpolated_only_between_frames() {
        let frames = [[10_000.0, 10.0, 20.0, 3.1], [10_100.0, 11.0, 20.0, -3.1], [11_500.0, 21.0, 20.0, 3.0]].map(Some);
        let track = track(&[frames[0], frames[1], None, frames[2]]).expect("a track");
        assert_eq!((track.frames.len(), track.lost, track.jumps), (3, 1, 0));
        let pose = track.at(10_050.0).pose().expect("seen");
        assert!((pose.position_cm.x - 10.5).abs() < 1e-9 && pose.heading_rad.abs() > 3.1, "{pose:?}");
        assert_eq!(
            [9_999.0, 10_500.0, 11_501.0].map(|ms| track.at(ms)),
            [Sighting::Outside, Sighting::Lost, Sighting::Outside]
        );
    }

    #[test]
    fn jump_there_and_back_is_removed() {
        let x_cm = |i: usize| if i == 7 { 140.0 } else { 20.0 + i as f64 };
        let frames: Vec<_> = (0..20).map(|i| Some([33.0 * i as f64, x_cm(i), 50.0, 0.0])).collect();
        let track = track(&frames).expect("a track");
        assert_eq!((track.frames.len(), track.jumps), (19, 1));
    }

    #[test]
    fn tracks_without_motion_in_time_are_rejected() {
        let error = |frames: &[Option<[f64; 4]>]| track(frames).expect_err("rejected").to_string();
        assert!(error(&[None, Some([0.0; 4])]).contains("1 frame(s)"));
        assert!(error(&[Some([0.0; 4]); 2]).contains("is not later than"));
    }
}
