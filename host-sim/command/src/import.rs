//! `mindgap import`

pub mod recordings;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use schemars::JsonSchema;
use serde::Serialize;

use super::choices::{ANGLES, LENGTHS, TIMES, one_of};
use super::json_output::emit_sorted;
use super::table::{self, count};
use super::{Run, check, kinds, progress, warn};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_import::brick::import;
use mindgap_import::report::{LogReport, Report, RunReport, TrackReport};
use mindgap_import::statements::Statements;
use mindgap_import::units::{Angle, Length, Time, Units};
use mindgap_logs::{Robot, Scene};

/// Import recordings as a folder of logs: brick logs with camera tracks, streams as CSV, or ROS 2 bags.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Import {
    #[command(subcommand)]
    way: Option<Way>,
    #[command(flatten)]
    brick: Option<Brick>,
}

#[derive(Subcommand)]
enum Way {
    Streams(recordings::Streams),
    Bag(recordings::Bag),
}

/// Merge a brick's logs with a camera's tracks, if there are any.
#[derive(Args)]
struct Brick {
    /// Brick logs, and camera tracks if there are any, in any order; their kind is detected from the first line. Tracks are CSV with time,
    /// x, y and heading (time_s, x_m, y_m, yaw_rad and the like), TUM, or exports of Motive, Vicon or Qualisys.
    #[arg(value_name = "BRICK_LOG|CAMERA_TRACK", required = true)]
    files: Vec<PathBuf>,
    /// Scene in which the robot drove.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Measured dimensions of the robot, robot.toml.
    #[arg(long, value_name = "FILE")]
    robot: PathBuf,
    /// Folder to write the logs to.
    #[arg(long, value_name = "LOGS")]
    out: PathBuf,
    /// Unit of the track's time column, if its name states none.
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Time>(TIMES))]
    time_unit: Option<Time>,
    /// Unit of the track's x and y columns, if their names state none.
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Length>(LENGTHS))]
    length_unit: Option<Length>,
    /// Unit of the track's heading column, if its name states none.
    #[arg(long, value_name = "UNIT", value_parser = one_of::<Angle>(ANGLES))]
    angle_unit: Option<Angle>,
    /// Name of the robot's body in a motion capture (default: the one that moves as the wheels do).
    #[arg(long, value_name = "NAME")]
    body: Option<String>,
    // Not `JsonOption`: clap misses that an optional flattened group is present if that group flattens another.
    /// Write the results as JSON (`-`: to standard output, instead of the text).
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write an HTML page of the logs, as `mindgap check --html` does.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

/// Results of `mindgap import` for brick logs and camera tracks.
#[derive(Serialize, JsonSchema)]
pub struct ImportResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<2>,
    /// What was merged and what was left out.
    #[serde(flatten)]
    report: &'a Report,
}

impl<'a> ImportResults<'a> {
    /// Returns the results of an import.
    pub fn of(report: &'a Report) -> Self {
        ImportResults { schema: SchemaNumber, report }
    }
}

impl Import {
    /// Returns the subcommand; clap guarantees that there is one.
    fn way(&self) -> Option<&dyn Run> {
        match &self.way {
            Some(Way::Streams(streams)) => Some(streams),
            Some(Way::Bag(bag)) => Some(bag),
            None => self.brick.as_ref().map(|brick| brick as &dyn Run),
        }
    }
}

impl Run for Import {
    fn places(&self) -> Places {
        self.way().map(Run::places).unwrap_or_default()
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        self.way().map_or(Ok(String::new()), |way| way.run(executor))
    }
}

impl Run for Brick {
    fn places(&self) -> Places {
        let inputs = self.files.iter().chain([&self.scene, &self.robot]);
        Places::default()
            .reading(inputs)
            .filling([&self.out])
            .writing(&self.json, kinds::REPORT)
            .writing(&self.html, kinds::PAGE)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let units = Units { time: self.time_unit, length: self.length_unit, angle: self.angle_unit };
        let stated = Statements { units, body: self.body.clone(), ..Statements::default() };
        let (robot, scene) = (Robot::read_all(&self.robot)?, Scene::read(&self.scene)?);
        let bar = progress::bar(self.files.len() as u64);
        let imported = import(&self.files, &stated, robot, scene, warn, progress::counting(&bar));
        bar.finish_and_clear();
        let (logs, report) = imported?;
        let page = self.html.as_ref().map(|path| (path, check::surveyed(logs.clone(), &self.out, &[]).1));
        logs.write(&self.out)?;
        page.map_or(Ok(()), |(path, page)| files::write(path, page))?;
        let text = format!("{}{}: {}\n", describe(&report), self.out.display(), count(logs.runs.len(), "run"));
        emit_sorted(self.json.as_deref(), &ImportResults::of(&report), text)
    }
}

/// Returns the report for a terminal.
pub fn describe(report: &Report) -> String {
    let tracks = report.tracks.iter().map(|TrackReport { file, body, frames, lost, jumps }| {
        let left_out = match (lost, jumps) {
            (0, 0) => String::new(),
            _ => format!("; excluded: {lost} without a pose, {jumps} impossible jumps"),
        };
        let of = body.as_ref().map_or(String::new(), |body| format!(" of {body}"));
        format!("{}: {frames} frames{of}{left_out}\n", file.display())
    });
    let mut text: String = tracks.collect();
    let runs = report.logs.iter().filter_map(|log| Some((log, log.run.as_ref()?)));
    let rows: Vec<[String; 7]> = runs.map(|(log, run)| row(log, run)).collect();
    let header = ["log", "run", "offset (ms)", "drift (ppm)", "mismatch (%)", "rows", "without pose"];
    text += &table::text(header, &rows);
    for LogReport { file, truncated, run, left_out } in &report.logs {
        if *truncated {
            text += &format!("{}: the last line is incomplete and was excluded\n", file.display());
        }
        let within_rows = run.as_ref().map_or(0, |run| run.changes_within_rows);
        if within_rows > 0 {
            text += &format!(
                "{}: {within_rows} commands changed within a row, which holds their mean; the counters show when\n",
                file.display()
            );
        }
        if let Some(why) = left_out {
            text += &format!("{}: excluded, {why}\n", file.display());
        }
    }
    text += &recordings::excluded(&report.left_out);
    text + &report.untracked.as_ref().map_or(String::new(), |what| format!("poses: {what}\n"))
}

fn row(log: &LogReport, run: &RunReport) -> [String; 7] {
    let RunReport { name, track, body, offset_ms, drift, unexplained, rows, outside, in_gaps, .. } = run;
    let without = match (track, outside, in_gaps) {
        (None, ..) => "all".into(),
        (_, 0, 0) => "0".into(),
        _ => format!("{outside} outside the track, {in_gaps} in gaps"),
    };
    let number = |value: Option<f64>, decimals: usize| value.map_or("-".into(), |value| format!("{value:.decimals$}"));
    [
        log.file.display().to_string(),
        body.as_ref().map_or_else(|| name.clone(), |body| format!("{name} ({body})")),
        number(*offset_ms, 0),
        number(drift.map(|drift| 1e6 * drift), 0),
        number(unexplained.map(|share| 100.0 * share), 1),
        rows.to_string(),
        without,
    ]
}
