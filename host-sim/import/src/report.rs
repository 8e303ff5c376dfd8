//! Reports of imports: what was merged and what was left out.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::left_out::{LeftOut, What};
use super::scale_check::ScaleCheck;
use mindgap_foundations::statistics::summary::median;

/// Summary of an import; its JSON form is described in docs/reference/json.md.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// Camera tracks.
    pub tracks: Vec<TrackReport>,
    /// Brick logs.
    pub logs: Vec<LogReport>,
    /// What can be diagnosed without poses, and how to add them; null if there is a track.
    pub untracked: Option<String>,
    /// Everything that is not used, with the reason.
    pub left_out: Vec<LeftOut>,
}

/// Summary of a camera track.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TrackReport {
    /// File of the track.
    pub file: PathBuf,
    /// Body of a motion capture; null if the file has a single one without a name.
    pub body: Option<String>,
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
    /// File of the matching track; null if no file is a track.
    pub track: Option<PathBuf>,
    /// Body of the track; null if the file has a single one without a name.
    pub body: Option<String>,
    /// Camera time at brick time 0, ms; null without a track.
    pub offset_ms: Option<f64>,
    /// Relative drift of the camera's clock: 1e-4 is 0.1 ms per second faster than the brick's; null without a track.
    pub drift: Option<f64>,
    /// Fraction of the motion's variance that the alignment leaves unexplained, 0..=1; null without a track.
    pub unexplained: Option<f64>,
    /// Number of changes of command that the rotation counters place between two rows; the rows hold their mean commands.
    pub changes_within_rows: usize,
    /// Number of rows.
    pub rows: usize,
    /// Number of rows without a pose because they are before or after the track; all rows without a track.
    pub outside: usize,
    /// Number of rows without a pose because the camera had lost the robot.
    pub in_gaps: usize,
}

/// Summary of imported recordings; its JSON form is described in docs/reference/json.md.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RecordingsReport {
    /// The recordings.
    pub recordings: Vec<RecordingReport>,
    /// What can be diagnosed of recordings without poses, and how to add poses; null if all have some.
    pub untracked: Option<String>,
    /// Commanded against tracked motion.
    pub odometry_check: ScaleCheck,
    /// What was changed in the frame of the poses; null if nothing was.
    pub frame: Option<String>,
    /// Findings of the inspection, one line each.
    pub findings: Vec<String>,
    /// Values that must be filled in by hand.
    pub to_fill_in: Vec<String>,
    /// Everything that is not used, with the reason.
    pub left_out: Vec<LeftOut>,
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
    /// Number of rows with a reading of the first range sensor.
    pub with_reading: usize,
    /// The further range sensors.
    pub further_sensors: Vec<SensorReport>,
    /// Number of rows with both rotation counters.
    pub with_counters: usize,
    /// Number of rows with a yaw rate of a gyro.
    pub with_gyro: usize,
    /// Number of poses excluded because the robot cannot move that fast.
    pub jumps: usize,
    /// Number of commands beyond full speed, which were limited to it.
    pub saturated: usize,
    /// Pauses in the commands; null if there are none.
    pub pauses: Option<PausesReport>,
}

/// Readings of a further range sensor.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SensorReport {
    /// Name of the sensor.
    pub sensor: String,
    /// Number of rows with a reading.
    pub with_reading: usize,
}

/// Pauses in a stream of commands while the last one asks for motion.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PausesReport {
    /// Number of pauses.
    pub number: usize,
    /// Longest pause, s.
    pub longest_s: f64,
    /// Time after the last command at which the base stops by itself, ms; null if it drives on.
    pub stops_after_ms: Option<f64>,
    /// How `stops_after_ms` was determined.
    pub determined: Determined,
}

/// How the behaviour of a base in pauses was determined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Determined {
    /// From the motion.
    Inferred,
    /// By the user.
    Stated,
    /// It was assumed, since the motion does not show it.
    Assumed,
}

/// Relation of the clocks of commands and poses; without poses, of commands and what the robot measured of its motion.
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
    /// Travelled per commanded distance, at the given lag; null if it is unknown.
    pub travel_gain: Option<f64>,
    /// Tracked per commanded rotation, at the given lag; null if it is unknown.
    pub rotation_gain: Option<f64>,
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
    /// Columns, bodies and rows that are not used; part of the report's `left_out`.
    #[serde(skip)]
    pub unused: Vec<LeftOut>,
}

impl RecordingReport {
    /// Returns whether no row has a pose.
    pub fn is_untracked(&self) -> bool {
        self.without_pose == self.rows
    }
}

/// Says what a diagnosis can do without poses, by what the robot measured of its motion, and how to add them; `None` if no
/// recording lacks them. The first number is that of recordings without poses, the second that of all.
pub fn without_poses([without, all]: [usize; 2], has_counters: bool, has_gyro: bool) -> Option<String> {
    let some = if without == all { String::new() } else { format!(" in {without} of {all} recordings") };
    let counters = has_counters.then_some("rotation counters, which show the drive up to the wheels");
    let gyro = has_gyro.then_some("a gyro, which shows how the body turns");
    let shown: Vec<&str> = counters.into_iter().chain(gyro).collect();
    let what = format!(
        "no poses were found{some}: a diagnosis compares the commands with {}, and neither travel over the ground nor range \
         sensors; to add poses, import them together with the commands, as a table of a camera or motion capture (t_s, x_m, y_m, \
         yaw_rad) or in a bag (PoseStamped, tf or Odometry)",
        shown.join(", and ")
    );
    (without > 0).then_some(what)
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
            unused: Vec::new(),
        }
    }

    /// Returns whether it is of this file.
    pub fn is_of(&self, file: &Path) -> bool {
        self.name == file.display().to_string()
    }

    /// Returns the columns that are not used.
    pub fn unused_columns(&self) -> impl Iterator<Item = &LeftOut> {
        self.unused.iter().filter(|unused| unused.what == What::Column)
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
