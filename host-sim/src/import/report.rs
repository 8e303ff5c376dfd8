//! What an import brought together and what it left out, for people and as JSON.

use std::path::PathBuf;

use serde::Serialize;

/// What was imported, and what was left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The cameras' tracks.
    pub tracks: Vec<TrackReport>,
    /// The brick's logs.
    pub logs: Vec<LogReport>,
}

/// What became of a camera's track.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackReport {
    /// Its file.
    pub file: PathBuf,
    /// Frames in it.
    pub frames: usize,
    /// Frames without a pose.
    pub lost: usize,
    /// Frames left out because no robot moves that fast.
    pub jumps: usize,
}

/// What became of a brick's log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogReport {
    /// Its file.
    pub file: PathBuf,
    /// Its last line had no end and was left out.
    pub torn: bool,
    /// The run in the folder of logs; none where the whole log was left out.
    pub run: Option<RunReport>,
    /// Why the whole log was left out.
    pub left_out: Option<String>,
}

/// A run that was imported.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunReport {
    /// Its name in the folder of logs.
    pub name: String,
    /// File of the track that saw it.
    pub track: PathBuf,
    /// Camera time at brick time 0.
    pub offset_ms: f64,
    /// How much faster the camera's clock runs.
    pub drift: f64,
    /// Share of the motion's variance in which wheels and camera differ.
    pub unexplained: f64,
    /// Rows of the run.
    pub rows: usize,
    /// Rows without a pose because the track has not begun yet or has ended.
    pub outside: usize,
    /// Rows without a pose because the camera had lost the robot.
    pub in_gaps: usize,
}
