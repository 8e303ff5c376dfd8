//! Reports of imports: what was merged and what was left out.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::scale_check::ScaleCheck;
use mindgap_foundations::statistics::summary::median;

/// Summary of an import; its JSON form is described in docs/reference/json.md.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// Camera tracks.
    pub tracks: Vec<TrackReport>,
    /// Brick logs.
    pub logs: Vec<LogReport>,
}

/// Summary of a camera track.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TrackReport {
    /// File of the track.
    pub file: PathBuf,
    /// Total number of frames.
    pub frames: usize,
    /// Number of frames without a pose.
    pub lost: usize,
    /// Number of frames excluded because the robot cannot move that fast.
    pub jumps: usize,
}

/// Summary of a brick log.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LogReport {
    /// File of the log.
    pub file: PathBuf,
    /// Whether the last line was incomplete and dropped.
    pub truncated: bool,
    /// The run in the log folder; null if the log was left out.
    pub run: Option<RunReport>,
    /// Why the log was left out; null if it was not.
    pub left_out: Option<String>,
}

/// A run that was imported.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunReport {
    /// Name in the log folder.
    pub name: String,
    /// File of the matching track.
    pub track: PathBuf,
    /// Camera time at brick time 0, ms.
    pub offset_ms: f64,
    /// Relative drift of the camera's clock: 1e-4 is 0.1 ms per second faster than the brick's.
    pub drift: f64,
    /// Fraction of the motion's variance that the alignment leaves unexplained, 0..=1.
    pub unexplained: f64,
    /// Number of rows.
    pub rows: usize,
    /// Number of rows without a pose because they are before or after the track.
    pub outside: usize,
    /// Number of rows without a pose because the camera had lost the robot.
    pub in_gaps: usize,
}

/// Summary of imported recordings; its JSON form is described in docs/reference/json.md.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RecordingsReport {
    /// The recordings.
    pub recordings: Vec<RecordingReport>,
    /// Commanded against tracked motion.
    pub odometry_check: ScaleCheck,
    /// What was changed in the frame of the poses; null if nothing was.
    pub frame: Option<String>,
    /// Findings of the inspection, one line each.
    pub findings: Vec<String>,
    /// Values that must be filled in by hand.
    pub to_fill_in: Vec<String>,
}

/// A recording that was imported.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RecordingReport {
    /// The files or topics that it was read from.
    pub sources: Vec<Source>,
    /// Relation of its clocks.
    pub clocks: ClocksReport,
    /// Names of its runs.
    pub runs: Vec<String>,
    /// Number of rows.
    pub rows: usize,
    /// Number of rows without a pose.
    pub without_pose: usize,
    /// Number of rows with a reading.
    pub with_reading: usize,
    /// Number of poses excluded because the robot cannot move that fast.
    pub jumps: usize,
    /// Number of commands above the robot's full speed, which were saturated.
    pub saturated: usize,
}

/// Relation of the clocks of commands and poses.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ClocksReport {
    /// Whether commands and poses share one clock.
    pub shared: bool,
    /// Time of the poses' clock at time 0 of the commands' clock, ms.
    pub offset_ms: f64,
    /// Relative drift of the poses' clock.
    pub drift: f64,
    /// Delay of the motion after the commands on a shared clock, ms; null if it is unknown.
    pub lag_ms: Option<f64>,
    /// Fraction of the motion's variance that commands do not explain, 0..=1; null if nothing moves.
    pub unexplained: Option<f64>,
}

/// A file or topic that was read.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Source {
    /// Name of the file or topic.
    pub name: String,
    /// Number of samples.
    pub samples: usize,
    /// Duration, s.
    pub duration_s: f64,
    /// Median number of samples per second.
    pub rate_hz: f64,
    /// Assignments of quantities to columns or topics.
    pub mapped: Vec<String>,
    /// Guesses made.
    pub guessed: Vec<String>,
    /// Samples left out, with the reason.
    pub left_out: Vec<String>,
}

impl Source {
    /// Describes a file with samples at these times.
    pub fn of_file(file: &Path, times_ms: &[f64]) -> Self {
        Source::named(file.display().to_string(), times_ms)
    }

    /// Describes a source with samples at these times.
    pub fn named(name: String, times_ms: &[f64]) -> Self {
        let duration_ms = times_ms.last().zip(times_ms.first()).map_or(0.0, |(last, first)| last - first);
        let spacing_ms = median(times_ms.windows(2).map(|pair| pair[1] - pair[0]));
        Source {
            name,
            samples: times_ms.len(),
            duration_s: duration_ms / 1e3,
            rate_hz: 1e3 / spacing_ms,
            mapped: Vec::new(),
            guessed: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// Sets the assignments of quantities.
    pub fn mapped(self, mapped: Vec<String>) -> Self {
        Source { mapped, ..self }
    }

    /// Adds guesses.
    pub fn guessed(mut self, guessed: impl IntoIterator<Item = String>) -> Self {
        self.guessed.extend(guessed);
        self
    }

    /// Adds a number of samples that were left out, unless it is zero.
    pub fn left_out(mut self, number: usize, why: &str) -> Self {
        if number > 0 {
            self.left_out.push(format!("{number} {why}"));
        }
        self
    }
}
