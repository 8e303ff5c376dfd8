//! What an import merged and what it left out.

use std::path::PathBuf;

use serde::Serialize;

/// Summary of an import; its JSON form is described in docs/formats.md.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The tracks of the cameras.
    pub tracks: Vec<TrackReport>,
    /// The logs of the brick.
    pub logs: Vec<LogReport>,
}

/// Summary of a camera's track.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackReport {
    /// Its file.
    pub file: PathBuf,
    /// Total number of frames.
    pub frames: usize,
    /// Number of frames without a pose.
    pub lost: usize,
    /// Number of frames left out because the robot cannot move that fast.
    pub jumps: usize,
}

/// Summary of a brick's log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogReport {
    /// Its file.
    pub file: PathBuf,
    /// Whether its last line was incomplete and left out.
    pub torn: bool,
    /// The run in the folder of logs; `None` if the whole log was left out.
    pub run: Option<RunReport>,
    /// Why the whole log was left out, if so.
    pub left_out: Option<String>,
}

/// A run that was imported.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunReport {
    /// Its name in the folder of logs.
    pub name: String,
    /// File of the matching track.
    pub track: PathBuf,
    /// Camera time at brick time 0, ms.
    pub offset_ms: f64,
    /// Relative drift of the camera's clock: 1e-4 is 0.1 ms a second faster than the brick's.
    pub drift: f64,
    /// Share of the motion's variance that the alignment leaves unexplained, 0..=1.
    pub unexplained: f64,
    /// Number of rows.
    pub rows: usize,
    /// Number of rows without a pose because they lie before or after the track.
    pub outside: usize,
    /// Number of rows without a pose because the camera had lost the robot.
    pub in_gaps: usize,
}
