//! `mindgap import streams` and `mindgap import bag`

use std::path::{Path, PathBuf};

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use crate::choices::{ANGLES, LENGTHS, TIMES, one_of};
use crate::json_output::JsonOption;
use crate::{Run, kinds, progress, table};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_import::assemble::{Assembled, assemble};
use mindgap_import::bag::{Choice, recording};
use mindgap_import::draft::{RobotDraft, SCENE, to_fill_in};
use mindgap_import::mapping::Mapping;
use mindgap_import::recording::Recording;
use mindgap_import::report::{ClocksReport, RecordingReport, RecordingsReport, Source};
use mindgap_import::streams::recordings;
use mindgap_import::units::{Angle, Length, Time, Units};
use mindgap_logs::{Robot, Scene};

/// Import streams as CSV: commands, poses and readings of a drive, in one file or several, each with its own clock.
///
/// Columns are recognised by name, such as t_s, v_m_s, w_rad_s, left, right, x_m, y_m, yaw_rad, qx to qw, range_m;
/// --map describes others. docs/how-to/bring-your-own-robot.md lists names and units.
#[derive(Args)]
pub struct Streams {
    /// Files. A file with commands and poses is a drive of its own; otherwise the first file with commands belongs to the
    /// first with poses and the first with readings, and so on.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Quantity and unit of each column: TOML with one table per file.
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Unit of times whose column name states none (default: guessed).
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Time>(TIMES))]
    time_unit: Option<Time>,
    /// Unit of lengths, and of speeds per second, whose column names state none.
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Length>(LENGTHS))]
    length_unit: Option<Length>,
    /// Unit of headings, and of turn rates per second, whose column names state none.
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Angle>(ANGLES))]
    angle_unit: Option<Angle>,
    /// Offset of the pose clock relative to the command clock, ms (default: estimated from the motion).
    #[arg(long, value_name = "MS", allow_negative_numbers = true)]
    offset_ms: Option<f64>,
    #[command(flatten)]
    target: Target,
}

/// Import ROS 2 bags (MCAP): Twist, TwistStamped, Odometry, PoseStamped, tf, Range, LaserScan.
#[derive(Args)]
pub struct Bag {
    /// Bags, one per drive.
    #[arg(value_name = "BAG.mcap", required = true)]
    bags: Vec<PathBuf>,
    /// Topic of the commands (default: guessed).
    #[arg(long, value_name = "TOPIC")]
    commands: Option<String>,
    /// Topic of the poses, for transforms such as /tf:map>base_link (default: guessed).
    #[arg(long, value_name = "TOPIC")]
    poses: Option<String>,
    /// Topic of the readings, or none (default: guessed).
    #[arg(long, value_name = "TOPIC")]
    ranges: Option<String>,
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
    #[command(flatten)]
    json: JsonOption,
}

impl Run for Streams {
    fn places(&self) -> Places {
        self.target.places().reading(&self.files).reading(&self.map)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let given = self.target.read()?;
        let mapping = self.map.as_deref().map_or(Ok(Mapping::default()), Mapping::read)?;
        let units = Units { time: self.time_unit, length: self.length_unit, angle: self.angle_unit };
        self.target.make(given, |watch| recordings(&self.files, &mapping, &units, watch), self.offset_ms)
    }
}

impl Run for Bag {
    fn places(&self) -> Places {
        self.target.places().reading(&self.bags)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let given = self.target.read()?;
        let choice = Choice { commands: self.commands.clone(), poses: self.poses.clone(), ranges: self.ranges.clone() };
        let yaw_rad = given.robot.and_then(|robot| robot.ultrasonic).map_or(0.0, |sensor| sensor.yaw_deg.to_radians());
        let read = |watch: &dyn Fn(usize, usize)| {
            let bags = self.bags.iter().zip(0..);
            bags.map(|(bag, before)| {
                watch(before, self.bags.len());
                recording(bag, &choice, yaw_rad)
            })
            .collect()
        };
        self.target.make(given, read, None)
    }
}

/// Robot and scene as given by the user.
struct Given {
    robot: Option<Robot>,
    robot_text: Option<String>,
    scene: Scene,
    scene_text: String,
}

impl Target {
    fn places(&self) -> Places {
        let given = self.robot.iter().chain(&self.scene);
        Places::default().reading(given).filling([&self.out]).writing(self.json.path(), kinds::REPORT)
    }

    /// Reads the robot and scene files that are given.
    fn read(&self) -> Result<Given> {
        let robot_text = self.robot.as_deref().map(files::read_text).transpose()?;
        let robot = self.robot.as_deref().map(Robot::read).transpose()?;
        let (scene, scene_text) = match &self.scene {
            Some(path) => (Scene::read(path)?, files::read_text(path)?),
            None => (Scene::default(), SCENE.to_owned()),
        };
        Ok(Given { robot, robot_text, scene, scene_text })
    }

    /// Reads recordings with `read`, writes them as logs, and returns the report for the terminal.
    fn make(
        &self,
        given: Given,
        read: impl FnOnce(&dyn Fn(usize, usize)) -> Result<Vec<Recording>>,
        offset_ms: Option<f64>,
    ) -> Result<String> {
        let bar = progress::shares();
        let recordings = read(&progress::part(&bar, 0..50, "reading"))?;
        let aligning = progress::part(&bar, 50..100, "aligning clocks");
        let Assembled { logs, draft, mut report } =
            assemble(recordings, given.robot, given.scene, offset_ms, aligning)?;
        bar.finish_and_clear();
        let robot_text = given.robot_text.or(draft.as_ref().map(RobotDraft::text)).unwrap_or_default();
        report.to_fill_in = to_fill_in("robot.toml", &robot_text);
        let ours = |name: &str| {
            (name.starts_with("run-") && name.ends_with(".csv")) || name == "robot.toml" || name == "scene.toml"
        };
        files::write_folder(&self.out, ours, |fresh| {
            files::write(&fresh.join("robot.toml"), &robot_text)?;
            files::write(&fresh.join("scene.toml"), &given.scene_text)?;
            logs.runs.iter().try_for_each(|run| run.write(&fresh.join(format!("{}.csv", run.name))))
        })?;
        let text = describe(&report, logs.robot.step_ms, &self.out);
        let results = RecordingsResults { schema: SchemaNumber, report: &report };
        self.json.emit_sorted(&results, text)
    }
}

fn describe(report: &RecordingsReport, step_ms: f64, out: &Path) -> String {
    let mut text: String = report.recordings.iter().map(|recording| of_recording(recording, step_ms)).collect();
    let check = &report.odometry_check;
    let number = |value: f64| format!("{value:.0}");
    text += &table::text(
        ["motion", "commanded", "tracked"],
        &[
            ["travel (cm)".to_owned(), number(check.commanded_cm), number(check.tracked_cm)],
            ["rotation (deg)".to_owned(), number(check.commanded_deg), number(check.tracked_deg)],
        ],
    );
    let mut lines = |title: &str, lines: &[String]| lines.iter().for_each(|line| text += &format!("{title}: {line}\n"));
    lines("frame", report.frame.as_slice());
    lines("logs", &report.findings);
    lines("fill in", &report.to_fill_in);
    let runs: usize = report.recordings.iter().map(|recording| recording.runs.len()).sum();
    text + &format!("{}: {runs} runs\n", out.display())
}

fn of_recording(recording: &RecordingReport, step_ms: f64) -> String {
    let RecordingReport { sources, clocks, runs, rows, without_pose, with_reading, jumps, saturated } = recording;
    let mut text: String = sources.iter().map(of_source).collect();
    text += &format!("  {}\n", of_clocks(clocks));
    let names =
        if let [one] = runs.as_slice() { one.clone() } else { format!("{} to {}", runs[0], runs[runs.len() - 1]) };
    text += &format!(
        "  {names}: {rows} rows, one per {step_ms} ms; {without_pose} without a pose, {with_reading} with a reading\n"
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

fn of_source(source: &Source) -> String {
    let Source { name, samples, duration_s, rate_hz, mapped, guessed, left_out } = source;
    let mut text = format!("{name}: {samples} samples in {duration_s:.1} s, {rate_hz:.1} Hz; {}\n", mapped.join(", "));
    for (what, lines) in [("guessed", guessed), ("excluded", left_out)] {
        lines.iter().for_each(|line| text += &format!("  {what}: {line}\n"));
    }
    text
}

fn of_clocks(clocks: &ClocksReport) -> String {
    let ClocksReport { shared, offset_ms, drift, lag_ms, unexplained } = clocks;
    let differs =
        unexplained.map_or("no motion".into(), |share| format!("{:.0} % of the motion unexplained", 100.0 * share));
    match (shared, lag_ms) {
        (true, Some(lag_ms)) => format!("one clock: motion lags the commands by {lag_ms:.0} ms ({differs})"),
        (true, None) => format!("one clock, as stated ({differs})"),
        (false, _) => format!(
            "two clocks: the pose clock is {:.3} s ahead and drifts by {:.0} ppm ({differs}); estimated from the motion, so a \
             delay of the robot is not visible",
            offset_ms / 1e3,
            1e6 * drift
        ),
    }
}
