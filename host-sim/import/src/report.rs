//! What an import merged and what it left out.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::sides::Sides;
use mindgap_foundations::statistics::summary::median;

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

/// Summary of imported recordings; its JSON form is described in docs/formats.md.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingsReport {
    /// The recordings.
    pub recordings: Vec<RecordingReport>,
    /// What commands ask for and the track shows.
    pub sides: Sides,
    /// What was changed about the frame of the poses.
    pub frame: Option<String>,
    /// What an inspection finds in the logs, a sentence each.
    pub findings: Vec<String>,
    /// What has to be filled in by hand, and where.
    pub to_fill_in: Vec<String>,
}

/// A recording that was imported.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingReport {
    /// What it was read from.
    pub sources: Vec<Source>,
    /// How its clocks go together.
    pub clocks: ClocksReport,
    /// Names of the runs that were made of it.
    pub runs: Vec<String>,
    /// Number of rows.
    pub rows: usize,
    /// Number of rows without a pose.
    pub without_pose: usize,
    /// Number of rows with a reading.
    pub with_reading: usize,
    /// Number of poses left out because the robot cannot move that fast.
    pub jumps: usize,
    /// Number of commands beyond the robot's full speed, which were limited to it.
    pub limited: usize,
}

/// How the clocks of commands and poses go together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClocksReport {
    /// Whether they were taken as one clock.
    pub one: bool,
    /// Time of the poses' clock at time 0 of the commands' clock, ms.
    pub offset_ms: f64,
    /// Relative drift of the poses' clock.
    pub drift: f64,
    /// By how much motion follows the commands on one clock, ms.
    pub lag_ms: Option<f64>,
    /// Share of the motion's variance that commands do not explain, 0..=1; `None` where nothing moves.
    pub unexplained: Option<f64>,
}

/// A file or topic that was read.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Source {
    /// Its name.
    pub name: String,
    /// Number of samples.
    pub samples: usize,
    /// How long it lasts, s.
    pub lasts_s: f64,
    /// Median number of samples a second.
    pub rate_hz: f64,
    /// What was taken as what.
    pub taken: Vec<String>,
    /// What was guessed.
    pub guessed: Vec<String>,
    /// What was left out.
    pub left_out: Vec<String>,
}

impl Source {
    /// A file with samples at these times.
    pub fn of_file(file: &Path, times_ms: &[f64]) -> Self {
        Source::named(file.display().to_string(), times_ms)
    }

    /// A source with samples at these times.
    pub fn named(name: String, times_ms: &[f64]) -> Self {
        let lasts_ms = times_ms.last().zip(times_ms.first()).map_or(0.0, |(last, first)| last - first);
        let spacing_ms = median(times_ms.windows(2).map(|pair| pair[1] - pair[0]));
        Source {
            name,
            samples: times_ms.len(),
            lasts_s: lasts_ms / 1e3,
            rate_hz: 1e3 / spacing_ms,
            taken: Vec::new(),
            guessed: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// The same, with what was taken as what.
    pub fn taken(self, taken: Vec<String>) -> Self {
        Source { taken, ..self }
    }

    /// The same, with what was guessed.
    pub fn guessed(mut self, guessed: impl IntoIterator<Item = String>) -> Self {
        self.guessed.extend(guessed);
        self
    }

    /// The same, with a number of samples that were left out, if there are some.
    pub fn left_out(mut self, number: usize, why: &str) -> Self {
        if number > 0 {
            self.left_out.push(format!("{number} {why}"));
        }
        self
    }
}
