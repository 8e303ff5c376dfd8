//! `mindgap import streams` and `mindgap import bag`

use std::path::PathBuf;

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use crate::choices::{ANGLES, LENGTHS, TIMES, one_of};
use crate::json_output::JsonOption;
use crate::{Run, check, kinds, progress, table};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_import::assemble::{Stated, Watchdog};
use mindgap_import::bag::{self, Choice};
use mindgap_import::given::{Given, Imported};
use mindgap_import::left_out::LeftOut;
use mindgap_import::mapping::Mapping;
use mindgap_import::report::{
    ClocksReport, Determined, PausesReport, RecordingReport, RecordingsReport, SensorReport, Source,
};
use mindgap_import::statements::Statements;
use mindgap_import::streams::{Recordings, recordings};
use mindgap_import::units::{Angle, Length, Time, Units};

/// Import streams as CSV: commands, poses and readings, in one file or several, each with its own clock.
///
/// Columns are recognised by name, such as t_s, v_m_s, w_rad_s, left, right, x_m, y_m, yaw_rad, qx to qw, range_m;
/// --map describes others. docs/how-to/bring-your-own-robot.md lists names and units.
#[derive(Args)]
pub struct Streams {
    /// Files to import. A file with both commands and poses is one recording. Otherwise files are matched in order: the first
    /// with commands, the first with poses and the first with readings form one recording, and so on. Without poses, rotation
    /// counters or a gyro show the motion.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Quantity and unit of each column: TOML with one table per file.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Unit of times in columns whose names give no unit (default: guessed).
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Time>(TIMES))]
    time_unit: Option<Time>,
    /// Unit of lengths, and of speeds (per second), in columns whose names give no unit.
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Length>(LENGTHS))]
    length_unit: Option<Length>,
    /// Unit of headings, and of turn rates (per second), in columns whose names give no unit.
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Angle>(ANGLES))]
    angle_unit: Option<Angle>,
    /// Name of the robot's body in a motion capture (default: the one that moves as commanded).
    #[arg(long, value_name = "NAME")]
    body: Option<String>,
    /// Offset of the pose clock relative to the command clock, ms (default: estimated from the motion).
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = finite)]
    offset_ms: Option<f64>,
    #[command(flatten)]
    target: Target,
}

/// Import bags of ROS 2 (folders, MCAP, SQLite) or ROS 1: Twist, TwistStamped, Odometry, PoseStamped, tf, Range, LaserScan,
/// JointState, Imu.
#[derive(Args)]
pub struct Bag {
    /// Bags, one per recording: the folder that `ros2 bag record` writes, or a file.
    #[arg(value_name = "BAG", required = true)]
    bags: Vec<PathBuf>,
    /// Topic of the commands (default: guessed).
    #[arg(long, value_name = "TOPIC")]
    commands: Option<String>,
    /// Topic of the poses; for a transform, write for example /tf:map>base_link (default: guessed).
    #[arg(long, value_name = "TOPIC")]
    poses: Option<String>,
    /// Topic of the readings, or `none` (default: guessed). With several range sensors NAME=TOPIC for each; repeatable.
    #[arg(long, value_name = "[NAME=]TOPIC")]
    ranges: Vec<String>,
    /// Topic of the gyro, or `none` (default: guessed).
    #[arg(long, value_name = "TOPIC")]
    gyro: Option<String>,
    /// Joint of a left wheel, whose angle is a rotation counter; repeatable, since wheels of a side are averaged (default: guessed
    /// from the names of joints).
    #[arg(long, value_name = "[TOPIC:]JOINT")]
    left_joint: Vec<String>,
    /// Joint of a right wheel, as for the left.
    #[arg(long, value_name = "[TOPIC:]JOINT")]
    right_joint: Vec<String>,
    #[command(flatten)]
    target: Target,
}

/// Results of `mindgap import streams` and `mindgap import bag`.
#[derive(Serialize, JsonSchema)]
pub struct RecordingsResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<2>,
    /// What was merged and what was left out.
    #[serde(flatten)]
    report: &'a RecordingsReport,
}

impl<'a> RecordingsResults<'a> {
    /// Returns the results of an import.
    pub fn of(report: &'a RecordingsReport) -> Self {
        RecordingsResults { schema: SchemaNumber, report }
    }
}

#[derive(Args)]
struct Target {
    /// Measured dimensions of the robot, robot.toml (default: a draft to fill in is written with the logs).
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// Scene in which the robot drove (default: open ground).
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Folder to write the logs to.
    #[arg(long, value_name = "LOGS")]
    out: PathBuf,
    /// Watchdog time of the base, ms: it stops this long after the last command. `none` if it drives on (default: inferred from
    /// the motion during pauses in the commands).
    #[arg(long, value_name = "MS")]
    watchdog_ms: Option<Watchdog>,
    #[command(flatten)]
    json: JsonOption,
    /// Write an HTML page of the logs, as `mindgap check --html` does.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

impl Run for Streams {
    fn places(&self) -> Places {
        self.target.places().reading(&self.files).reading(&self.map)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let given = self.target.read()?;
        let mapping = self.map.as_deref().map_or(Ok(Mapping::default()), Mapping::read)?;
        let units = Units { time: self.time_unit, length: self.length_unit, angle: self.angle_unit };
        let stated = Statements { mapping, units, body: self.body.clone(), sensors: given.range_sensors() };
        self.target.make(given, |watch| recordings(&self.files, &stated, watch), self.offset_ms)
    }
}

impl Run for Bag {
    fn places(&self) -> Places {
        self.target.places().reading(&self.bags)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let given = self.target.read()?;
        let choice = self.choice();
        let sensors = given.range_sensors();
        let read = |watch: &dyn Fn(usize, usize)| {
            let count = self.bags.len();
            bag::usable(&self.bags, &choice, &sensors, |before| watch(before, count))
        };
        self.target.make(given, read, None)
    }
}

impl Bag {
    fn choice(&self) -> Choice {
        let of_sensor = |text: &String| match text.split_once('=') {
            Some((sensor, topic)) => (Some(sensor.to_owned()), topic.to_owned()),
            None => (None, text.clone()),
        };
        Choice {
            commands: self.commands.clone(),
            poses: self.poses.clone(),
            ranges: self.ranges.iter().map(of_sensor).collect(),
            gyro: self.gyro.clone(),
            wheels: [self.left_joint.clone(), self.right_joint.clone()],
        }
    }
}

impl Target {
    fn places(&self) -> Places {
        let given = self.robot.iter().chain(&self.scene);
        let places = Places::default().reading(given).filling([&self.out]);
        places.writing(self.json.path(), kinds::REPORT).writing(&self.html, kinds::PAGE)
    }

    /// Reads the robot and scene files that are given.
    fn read(&self) -> Result<Given> {
        Given::read(self.robot.as_deref(), self.scene.as_deref())
    }

    /// Reads recordings with `read`, writes them as logs, and returns the report for the terminal.
    fn make(
        &self,
        given: Given,
        read: impl FnOnce(&dyn Fn(usize, usize)) -> Result<Recordings>,
        offset_ms: Option<f64>,
    ) -> Result<String> {
        let bar = progress::shares();
        let recordings = read(&progress::part(&bar, 0..50, "reading"))?;
        let aligning = progress::part(&bar, 50..100, "aligning clocks");
        let stated = Stated { offset_ms, watchdog: self.watchdog_ms };
        let Imported { logs, files, report } = given.import(recordings, stated, aligning)?;
        bar.finish_and_clear();
        let page = self.html.as_ref().map(|path| (path, check::surveyed(logs.clone(), &self.out, &notes(&report)).1));
        files.write(&self.out)?;
        page.map_or(Ok(()), |(path, page)| files::write(path, page))?;
        let text = describe(&report, logs.robot.step_ms);
        let text = format!("{text}{}: {} runs\n", self.out.display(), logs.runs.len());
        self.json.emit_sorted(&RecordingsResults::of(&report), text)
    }
}

/// Returns what is still to be filled in, as a page of the logs has it.
fn notes(report: &RecordingsReport) -> Vec<String> {
    report.to_fill_in.iter().map(|line| format!("To fill in: {line}")).collect()
}

/// Returns the report for a terminal.
pub fn describe(report: &RecordingsReport, step_ms: f64) -> String {
    let mut text: String = report.recordings.iter().map(|recording| of_recording(recording, step_ms)).collect();
    if report.recordings.iter().any(|recording| !recording.is_untracked()) {
        let check = &report.odometry_check;
        let number = |value: f64| format!("{value:.0}");
        text += &table::text(
            ["motion", "commanded", "tracked"],
            &[
                ["travel (cm)".to_owned(), number(check.commanded_cm), number(check.tracked_cm)],
                ["rotation (deg)".to_owned(), number(check.commanded_deg), number(check.tracked_deg)],
            ],
        );
    }
    let mut lines = |title: &str, lines: &[String]| lines.iter().for_each(|line| text += &format!("{title}: {line}\n"));
    lines("frame", report.frame.as_slice());
    lines("poses", report.untracked.as_slice());
    text += &excluded(&report.left_out);
    let mut lines = |title: &str, lines: &[String]| lines.iter().for_each(|line| text += &format!("{title}: {line}\n"));
    lines("logs", &report.findings);
    lines("fill in", &report.to_fill_in);
    text
}

/// Returns a line for everything that is not used.
pub fn excluded(left_out: &[LeftOut]) -> String {
    let of = |unused: &LeftOut| unused.source.as_ref().map_or(String::new(), |source| format!(" ({source})"));
    left_out.iter().map(|unused| format!("excluded: {}{}\n", unused.line(), of(unused))).collect()
}

fn of_recording(recording: &RecordingReport, step_ms: f64) -> String {
    let RecordingReport { sources, clocks, runs, rows, without_pose, with_reading, jumps, saturated, pauses, .. } =
        recording;
    let mut text: String = sources.iter().map(of_source).collect();
    text += &format!("  {}\n", of_clocks(clocks));
    of_gains(clocks).iter().chain(&pauses.as_ref().map(of_pauses)).for_each(|line| text += &format!("  {line}\n"));
    let names =
        if let [one] = runs.as_slice() { one.clone() } else { format!("{} to {}", runs[0], runs[runs.len() - 1]) };
    text += &format!(
        "  {names}: {rows} rows, one per {step_ms} ms; {without_pose} without a pose, {with_reading} with a reading{}\n",
        of_measurements(recording)
    );
    if *with_reading > 0 {
        text +=
            &format!("  readings have their own timestamps: each row has the last one of the {step_ms} ms before it\n");
    }
    if *jumps > 0 {
        text += &format!("  excluded: {jumps} poses that are impossible jumps\n");
    }
    if *saturated > 0 {
        text += &format!("  {saturated} commands exceeded full_speed_cm_s and were limited to it\n");
    }
    text
}

/// Returns what further sensors, counters and gyro add to a sentence about the rows.
fn of_measurements(recording: &RecordingReport) -> String {
    let RecordingReport { further_sensors, with_counters, with_gyro, .. } = recording;
    let of_sensor = |of: &SensorReport| format!(", {} of {}", of.with_reading, of.sensor);
    let own = [(with_counters, "rotation counters"), (with_gyro, "a gyro")];
    let own = own.into_iter().filter(|(rows, _)| **rows > 0).map(|(rows, what)| format!(", {rows} with {what}"));
    further_sensors.iter().map(of_sensor).chain(own).collect()
}

fn of_source(source: &Source) -> String {
    let Source { name, samples, duration_s, rate_hz, mapped, guessed, left_out, .. } = source;
    let mut text = format!("{name}: {samples} samples in {duration_s:.1} s, {rate_hz:.1} Hz; {}\n", mapped.join(", "));
    for (what, lines) in [("guessed", guessed), ("excluded", left_out)] {
        lines.iter().for_each(|line| text += &format!("  {what}: {line}\n"));
    }
    text
}

/// Returns what the robot did in pauses of its commands.
fn of_pauses(pauses: &PausesReport) -> String {
    let PausesReport { number, longest_s, stops_after_ms, determined } = pauses;
    let how = match determined {
        Determined::Inferred => "inferred from the motion; --watchdog-ms sets it",
        Determined::Stated => "as stated",
        Determined::Assumed => "assumed, since the motion does not show it; --watchdog-ms sets it",
    };
    let what = match stops_after_ms {
        Some(ms) => format!("the base stops by itself {ms:.0} ms after the last one, from when on it counts as zero"),
        None => "the base drives on, so the last one holds".into(),
    };
    format!("commands pause {number} times while the robot should move, for up to {longest_s:.1} s: {what} ({how})")
}

/// Motion that differs from the commanded one by less than this fraction is not worth a line.
const USUAL_GAIN: f64 = 0.2;
/// Gains of travel and rotation that differ by less than this fraction have one cause.
const SAME_GAIN: f64 = 0.1;

/// Returns what is unusual about the motion as a whole compared with the commands.
fn of_gains(clocks: &ClocksReport) -> Option<String> {
    let is_usual = |gain: f64| (1.0 / (1.0 + USUAL_GAIN)..1.0 + USUAL_GAIN).contains(&gain);
    match (clocks.travel_gain, clocks.rotation_gain) {
        (Some(travel), Some(turn)) if !is_usual(travel) && (travel / turn - 1.0).abs() < SAME_GAIN => Some(format!(
            "the robot moves and turns {travel:.2} of what is commanded: full_speed_cm_s, or times of a clock at another rate, as of \
             a simulation that is not in real time"
        )),
        (_, Some(turn)) if !is_usual(turn) => {
            Some(format!("the robot turns {turn:.2} of what is commanded: track_cm, or wheels that scrub"))
        }
        (Some(travel), _) if !is_usual(travel) => Some(format!(
            "the robot travels {travel:.2} of what is commanded: full_speed_cm_s, wheel_diameter_cm, or wheels that slip"
        )),
        _ => None,
    }
}

fn of_clocks(clocks: &ClocksReport) -> String {
    let ClocksReport { shared, offset_ms, drift, lag_ms, unexplained, .. } = clocks;
    let differs =
        unexplained.map_or("no motion".into(), |share| format!("{:.0} % of the motion unexplained", 100.0 * share));
    match (shared, lag_ms) {
        (true, Some(lag_ms)) => format!("one clock: motion lags the commands by {lag_ms:.0} ms ({differs})"),
        (true, None) => format!("one clock, as stated or assumed ({differs})"),
        (false, _) => format!(
            "two clocks: that of the motion is {:.3} s ahead and drifts by {:.0} ppm ({differs}); estimated from the motion, so \
             a delay of the robot is not visible",
            offset_ms / 1e3,
            1e6 * drift
        ),
    }
}

/// Parses a length of time of either sign, ms.
fn finite(text: &str) -> std::result::Result<f64, String> {
    text.parse().ok().filter(|ms: &f64| ms.is_finite()).ok_or_else(|| "is not a number".into())
}
