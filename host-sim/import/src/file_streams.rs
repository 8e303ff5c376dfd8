//! The streams in one file: commands, poses of bodies and readings, cut where the clock was reset at a repeated header.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::column::Column;
use super::columns::{Columns, ReadTimes};
use super::frame::Frame;
use super::layouts;
use super::left_out::LeftOut;
use super::recording::{Commands, Echoes};
use super::report::Source;
use super::spatial_pose::SpatialPose;
use super::statements::Statements;
use super::timestamps::in_order;
use super::upright::Axis;
use mindgap_foundations::error::{Error, Result};

/// The streams in a file, or in a part of it.
#[derive(Clone, Debug)]
pub struct FileStreams {
    /// The file.
    pub file: PathBuf,
    /// The commands, if any.
    pub commands: Option<Commands>,
    /// Bodies with their poses, `None` where a body was lost.
    pub bodies: Vec<BodyTrack>,
    /// Readings of range sensors, with the index of the sensor.
    pub readings: Vec<(usize, Echoes)>,
    /// Angles of the left and of the right wheels, rad.
    pub counters: [Vec<Vec<(f64, f64)>>; 2],
    /// Yaw rates that the robot measured, rad/s, if any.
    pub gyro: Option<Vec<(f64, f64)>>,
    /// What the report says of the file.
    pub source: Source,
}

/// The poses of one body.
#[derive(Clone, Debug)]
pub struct BodyTrack {
    /// Name of the body; empty if the file has a single one without a name.
    pub name: String,
    /// Its poses; `None` where it was lost.
    pub frames: Vec<Option<Frame>>,
}

/// The cells of a file, row by row.
#[derive(Default)]
struct Cells {
    lines: Vec<u64>,
    /// The first rows below repeated headers.
    starts: Vec<usize>,
    commands: Vec<Option<[f64; 2]>>,
    poses: Vec<Vec<Option<SpatialPose>>>,
    readings: Vec<Vec<Option<f64>>>,
    counters: [Vec<Vec<Option<f64>>>; 2],
    gyro: Vec<Option<f64>>,
    /// Sums of the absolute speeds ahead and to the left.
    speeds: [f64; 2],
}

/// Commands beyond this are a wrong unit or column: cm/s, rad/s or percent.
const MAX_COMMAND: f64 = 1e6;

impl FileStreams {
    /// Returns what of the robot's measurements it holds: range sensors, wheels by side, a gyro.
    pub fn measured(&self) -> (Vec<usize>, [usize; 2], bool) {
        let sensors = self.readings.iter().map(|(sensor, _)| *sensor).collect();
        (sensors, self.counters.each_ref().map(Vec::len), self.gyro.is_some())
    }

    /// Returns whether it holds what the robot measured of its motion: the wheels of both sides, or a gyro.
    pub fn shows_motion(&self) -> bool {
        self.gyro.is_some() || self.counters.iter().all(|wheels| !wheels.is_empty())
    }

    /// Reads a file; more than one if the recording was restarted within it.
    ///
    /// # Errors
    /// When it cannot be read or interpreted.
    pub fn read(file: &Path, stated: &Statements) -> Result<Vec<Self>> {
        let layouts::Opened { table, columns, .. } = layouts::open(file)?;
        let columns = match (stated.mapping.of(file), columns) {
            (None, Some(columns)) => columns,
            (mapped, _) => Columns::find(&table, mapped, &stated.units, &stated.sensors)?,
        };
        let mut cells = Cells {
            poses: vec![Vec::new(); columns.bodies.len()],
            readings: vec![Vec::new(); columns.ranges.len()],
            counters: columns.counters.each_ref().map(|wheels| vec![Vec::new(); wheels.len()]),
            ..Cells::default()
        };
        let mut times = ReadTimes::new(&table, &columns.times);
        let mut part = 0;
        let mut left_out = table.for_each(|line| {
            let pair = columns.commands.as_ref().map(|commands| commands.pair(line)).transpose()?;
            let poses = columns.bodies.iter().map(|body| body.pose(line)).collect::<Result<Vec<_>>>()?;
            let sideways = columns.sideways.as_ref().map_or(Ok(None), |sideways| sideways.value(line))?;
            let readings =
                columns.ranges.iter().map(|(_, range)| range.reading_cm(line)).collect::<Result<Vec<_>>>()?;
            let value = |column: &Column| column.value(line);
            let angles = columns.counters.iter().flatten().map(value).collect::<Result<Vec<_>>>()?;
            let rate = columns.gyro.as_ref().map(value).transpose()?;
            times.push(line)?;
            if line.part > part {
                (part, cells.starts) = (line.part, [cells.starts.as_slice(), &[cells.lines.len()]].concat());
            }
            cells.lines.push(line.number);
            if let (Some(Some([ahead, _])), Some(sideways)) = (pair, sideways) {
                cells.speeds = [cells.speeds[0] + ahead.abs(), cells.speeds[1] + sideways.abs()];
            }
            cells.commands.extend(pair);
            cells.poses.iter_mut().zip(poses).for_each(|(all, pose)| all.push(pose));
            cells.readings.iter_mut().zip(readings).for_each(|(all, reading)| all.push(reading));
            cells.counters.iter_mut().flatten().zip(angles).for_each(|(all, angle)| all.push(angle));
            cells.gyro.extend(rate);
            Ok(())
        })?;
        if cells.lines.is_empty() {
            return Err(Error::in_file(file, "has a header but no rows"));
        }
        let times = times.choose()?;
        left_out.extend(columns.sideways.as_ref().map(|sideways| {
            let [ahead, left] = cells.speeds;
            let percent = if left > 0.0 { 100.0 * left / (ahead + left) } else { 0.0 };
            let reason = format!("motion to the side is not modelled; it is {percent:.0} % of the commanded travel");
            LeftOut::column(&sideways.name, reason)
        }));
        left_out.extend(columns.left_out.iter().chain(&times.left_out).cloned());
        let kind = columns.commands.as_ref().map(|c| c.kind(&table, cells.commands.iter().flatten())).transpose()?;
        let mut guessed = [columns.guessed.clone(), times.guessed].concat();
        guessed.extend(kind.as_ref().and_then(|kind| kind.guessed.clone()));
        let axes: Vec<Option<Axis>> = columns
            .bodies
            .iter()
            .zip(&cells.poses)
            .map(|(body, poses)| {
                if !body.is_spatial() {
                    return Some(Axis::Z);
                }
                Axis::upright(poses.iter().flatten().copied())
            })
            .collect();
        let mapped = [vec![format!("time = {}", times.name)], columns.mapped()].concat();
        let parts = parts(&cells.starts, &times.ms);
        let read = parts.iter().enumerate().map(|(part, rows)| {
            let ms = &times.ms[rows.clone()];
            let kept = in_order(ms).map_err(|(at, what)| Error::at_line(file, cells.lines[rows.start + at], what))?;
            let out_of_order = kept.iter().filter(|kept| !**kept).count();
            if ms.len() - out_of_order < 2 {
                return Err(Error::in_file(
                    file,
                    format!("has {} row(s) with distinct times", ms.len() - out_of_order),
                ));
            }
            let rows =
                || ms.iter().zip(&kept).zip(rows.clone()).filter(|((_, kept), _)| **kept).map(|((ms, _), i)| (i, *ms));
            let commands = kind.as_ref().map(|kind| Commands {
                kind: kind.kind,
                samples: rows().filter_map(|(i, ms)| Some((ms, cells.commands[i]?.map(|v| v * kind.factor)))).collect(),
            });
            if let Some(commands) = &commands
                && commands.samples.iter().any(|(_, pair)| pair.iter().any(|v| !v.is_finite() || v.abs() > MAX_COMMAND))
            {
                return Err(Error::in_file(file, "has a command that no robot could follow"));
            }
            let bodies = columns.bodies.iter().zip(&cells.poses).zip(&axes).map(|((body, poses), axis)| {
                let axis = axis.or(axes.iter().flatten().next().copied()).unwrap_or(columns.upright);
                let frames = rows().map(|(i, ms)| poses[i].map(|pose| axis.frame(ms, &pose))).collect();
                BodyTrack { name: body.name.clone(), frames }
            });
            let bodies: Vec<BodyTrack> = bodies.collect();
            let numbers = |cells: &Vec<Option<f64>>| rows().filter_map(|(i, ms)| Some((ms, cells[i]?))).collect();
            let readings = columns.ranges.iter().zip(&cells.readings);
            let readings =
                readings.map(|((sensor, _), cells)| (*sensor, rows().map(|(i, ms)| (ms, cells[i])).collect()));
            let readings = readings.collect();
            let counters = cells.counters.each_ref().map(|wheels| wheels.iter().map(numbers).collect());
            let gyro = columns.gyro.as_ref().map(|_| numbers(&cells.gyro));
            let mut source = Source::of_file(file, &rows().map(|(_, ms)| ms).collect::<Vec<_>>())
                .mapped(mapped.clone())
                .guessed(guessed.clone())
                .left_out(out_of_order, "with a time not later than the one before");
            if let [body] = bodies.as_slice() {
                source = source.left_out(body.frames.iter().filter(|frame| frame.is_none()).count(), "without a pose");
            }
            if let Some(axis) = axes.iter().flatten().find(|axis| **axis != Axis::Z) {
                let what =
                    format!("the {} axis points upwards: the robot turns about it and keeps its height", axis.name());
                source.guessed.push(what);
            }
            if parts.len() > 1 {
                source.guessed.push(format!("part {} of {}: the recording was restarted", part + 1, parts.len()));
            }
            if part == 0 {
                source.unused = left_out.iter().cloned().map(|unused| unused.of(file)).collect();
            }
            Ok(FileStreams { file: file.into(), commands, bodies, readings, counters, gyro, source })
        });
        let read = read.collect::<Result<Vec<_>>>()?;
        Ok(read)
    }
}

/// Returns the rows of each part: a header within the rows begins a new one if the clock goes back there.
fn parts(starts: &[usize], ms: &[f64]) -> Vec<Range<usize>> {
    let is_reset = |start: &&usize| **start > 0 && ms[**start] <= ms[**start - 1];
    let mut starts: Vec<usize> = [0].into_iter().chain(starts.iter().filter(is_reset).copied()).collect();
    starts.push(ms.len());
    starts.windows(2).map(|pair| pair[0]..pair[1]).collect()
}
