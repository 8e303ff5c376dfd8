//! `mindgap import`

mod recordings;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::json;

use super::facts::reported;
use super::table::{self, count};
use super::{Run, kinds, progress, warn};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_import::brick::import;
use mindgap_import::report::{LogReport, Report, RunReport, TrackReport};
use mindgap_import::units::{Angle, Length, Time, Units};
use mindgap_logs::{Robot, Scene};

/// Make a folder of logs of what a robot recorded: a brick's logs and a camera's tracks, streams as CSV, or ROS 2 bags.
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

/// Bring a brick's logs and a camera's tracks together.
#[derive(Args)]
struct Brick {
    /// Logs of the brick and tracks of the camera, in any order; their first lines tell them apart. Tracks are CSV with
    /// time, x, y and heading (time_s, x_m, y_m, yaw_rad and the like), or what Motive exports of a rigid body.
    #[arg(value_name = "BRICK_LOG|CAMERA_TRACK", required = true)]
    files: Vec<PathBuf>,
    /// Where the robot drove.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// What the builder measured of the robot.
    #[arg(long, value_name = "FILE")]
    robot: PathBuf,
    /// Folder for the logs.
    #[arg(long, value_name = "LOGS")]
    out: PathBuf,
    /// Unit of a track's time whose column names none.
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<Time>,
    /// Unit of a track's x and y whose columns name none.
    #[arg(long, value_name = "UNIT")]
    length_unit: Option<Length>,
    /// Unit of a track's heading whose column names none.
    #[arg(long, value_name = "UNIT")]
    angle_unit: Option<Angle>,
    // No `FactsOption`: clap does not see that a group which is left out as a whole was called where it flattens another.
    /// Also write the same facts here, for programs; `-` is standard output, in place of the text.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Import {
    /// The way that was called: clap leaves none out.
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

    fn run(&self) -> Result<String> {
        self.way().map_or(Ok(String::new()), Run::run)
    }
}

impl Run for Brick {
    fn places(&self) -> Places {
        let inputs = self.files.iter().chain([&self.scene, &self.robot]);
        Places::default().reading(inputs).filling([&self.out]).writing(&self.json, kinds::REPORT)
    }

    fn run(&self) -> Result<String> {
        let units = Units { time: self.time_unit, length: self.length_unit, angle: self.angle_unit };
        let (robot, scene) = (Robot::read(&self.robot)?, Scene::read(&self.scene)?);
        let bar = progress::bar(self.files.len() as u64);
        let imported = import(&self.files, &units, robot, scene, warn, progress::counting(&bar));
        bar.finish_and_clear();
        let (logs, report) = imported?;
        logs.write(&self.out)?;
        let text = format!("{}{}: {}\n", told(&report), self.out.display(), count(logs.runs.len(), "run"));
        let facts = json!({"schema": 1, "tracks": report.tracks, "logs": report.logs});
        reported(self.json.as_deref(), &facts, text)
    }
}

fn told(report: &Report) -> String {
    let tracks = report.tracks.iter().map(|TrackReport { file, frames, lost, jumps }| {
        let left_out = match (lost, jumps) {
            (0, 0) => String::new(),
            _ => format!("; left out: {lost} without a pose, {jumps} that no robot can reach"),
        };
        format!("{}: {frames} frames{left_out}\n", file.display())
    });
    let mut text: String = tracks.collect();
    let runs = report.logs.iter().filter_map(|log| Some((log, log.run.as_ref()?)));
    let rows: Vec<[String; 7]> = runs.map(|(log, run)| row(log, run)).collect();
    let header = ["log", "run", "offset (ms)", "drift (ppm)", "differs (%)", "rows", "without pose"];
    text += &table::text(header, &rows);
    for LogReport { file, torn, left_out, .. } in &report.logs {
        if *torn {
            text += &format!("{}: the last line has no end and is left out\n", file.display());
        }
        if let Some(why) = left_out {
            text += &format!("{}: left out, {why}\n", file.display());
        }
    }
    text
}

fn row(log: &LogReport, run: &RunReport) -> [String; 7] {
    let RunReport { name, offset_ms, drift, unexplained, rows, outside, in_gaps, .. } = run;
    let without = match (outside, in_gaps) {
        (0, 0) => "0".into(),
        _ => format!("{outside} outside the track, {in_gaps} in gaps"),
    };
    [
        log.file.display().to_string(),
        name.clone(),
        format!("{offset_ms:.0}"),
        format!("{:.0}", 1e6 * drift),
        format!("{:.1}", 100.0 * unexplained),
        rows.to_string(),
        without,
    ]
}
