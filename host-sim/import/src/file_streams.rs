//! The streams in one file: commands, poses of bodies and readings, cut where the clock was reset at a repeated header.

mod cells;

use std::ops::Range;
use std::path::{Path, PathBuf};

use self::cells::{Cells, Numbers, Poses, Rows};
use super::columns::{Columns, CommandKind};
use super::frame::Frame;
use super::layouts;
use super::left_out::LeftOut;
use super::recording::{Commands, Echoes};
use super::report::Source;
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

/// The parts of a file: those of a recording that was restarted within it, or all of it.
struct Parts {
    /// The rows of each.
    rows: Vec<Range<usize>>,
    /// The times of all rows, ms.
    ms: Vec<f64>,
    /// Whether the time of a row is later than all before it in its part.
    is_kept: Vec<bool>,
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
        let mut cells = Cells::of(&table, &columns);
        let mut left_out = table.for_each(|line| cells.push(line))?;
        if cells.lines.is_empty() {
            return Err(Error::in_file(file, "has a header but no rows"));
        }
        left_out.extend(columns.sideways.as_ref().map(|sideways| {
            let percent = cells.percent_sideways();
            let reason = format!("motion to the side is not modelled; it is {percent:.0} % of the commanded travel");
            LeftOut::column(&sideways.name, reason)
        }));
        let Cells { times, rows, lines, starts, .. } = cells;
        let times = times.choose()?;
        left_out.extend(columns.left_out.iter().chain(&times.left_out).cloned());
        let pairs = Numbers::pairs(&rows.commands);
        let kind = columns.commands.as_ref().map(|commands| commands.kind(&table, pairs)).transpose()?;
        // The text of a long recording takes as much memory as its numbers.
        drop(table);
        let axes: Vec<Option<Axis>> = rows.poses.iter().map(Poses::axis).collect();
        let mut guessed = [columns.guessed.clone(), times.guessed].concat();
        guessed.extend(kind.as_ref().and_then(|kind| kind.guessed.clone()));
        if let Some(axis) = axes.iter().flatten().find(|axis| **axis != Axis::Z) {
            let what =
                format!("the {} axis points upwards: the robot turns about it and keeps its height", axis.name());
            guessed.push(what);
        }
        let mapped = [vec![format!("time = {}", times.name)], columns.mapped()].concat();
        let parts = Parts::of(file, times.ms, &starts, &lines)?;
        let mut read = parts.empty(file, &mapped, &guessed);
        read[0].source.unused = left_out.into_iter().map(|unused| unused.of(file)).collect();
        parts.fill(&mut read, rows, &columns, kind.as_ref(), &axes)?;
        Ok(read)
    }
}

impl Parts {
    /// Divides rows into parts: a header within the rows begins a new one if the clock goes back there.
    ///
    /// # Errors
    /// When the clock goes back elsewhere, or a part has fewer than two times.
    fn of(file: &Path, ms: Vec<f64>, starts: &[usize], lines: &[u32]) -> Result<Self> {
        let is_reset = |start: &&usize| **start > 0 && ms[**start] <= ms[**start - 1];
        let mut starts: Vec<usize> = [0].into_iter().chain(starts.iter().filter(is_reset).copied()).collect();
        starts.push(ms.len());
        let rows: Vec<Range<usize>> = starts.windows(2).map(|pair| pair[0]..pair[1]).collect();
        let mut is_kept = Vec::with_capacity(ms.len());
        for part in &rows {
            let kept = in_order(&ms[part.clone()])
                .map_err(|(at, what)| Error::at_line(file, lines[part.start + at].into(), what))?;
            let distinct = kept.iter().filter(|kept| **kept).count();
            if distinct < 2 {
                return Err(Error::in_file(file, format!("has {distinct} row(s) with distinct times")));
            }
            is_kept.extend(kept);
        }
        Ok(Parts { rows, ms, is_kept })
    }

    /// Returns the rows of a part with their times, ms.
    fn timed(&self, part: usize) -> impl Iterator<Item = (usize, f64)> {
        self.rows[part].clone().filter(|row| self.is_kept[*row]).map(|row| (row, self.ms[row]))
    }

    /// Returns streams without samples for each part.
    fn empty(&self, file: &Path, mapped: &[String], guessed: &[String]) -> Vec<FileStreams> {
        let parts = self.rows.len();
        let empty = |(part, rows): (usize, &Range<usize>)| {
            let times_ms: Vec<f64> = self.timed(part).map(|(_, ms)| ms).collect();
            let restarted = format!("part {} of {parts}: the recording was restarted", part + 1);
            let source = Source::of_file(file, &times_ms)
                .mapped(mapped.to_vec())
                .guessed(guessed.iter().cloned().chain((parts > 1).then_some(restarted)))
                .left_out(rows.len() - times_ms.len(), "with a time not later than the one before");
            let (bodies, readings, counters) = (Vec::new(), Vec::new(), Default::default());
            FileStreams { file: file.into(), commands: None, bodies, readings, counters, gyro: None, source }
        };
        self.rows.iter().enumerate().map(empty).collect()
    }

    /// Adds the samples. Columns are dropped one by one, since those of a long recording take much memory.
    ///
    /// # Errors
    /// When no robot could follow a command.
    fn fill(
        &self,
        read: &mut [FileStreams],
        rows: Rows,
        columns: &Columns,
        kind: Option<&CommandKind>,
        axes: &[Option<Axis>],
    ) -> Result<()> {
        let Rows { commands, poses, readings, counters, gyro } = rows;
        for (part, streams) in read.iter_mut().enumerate() {
            streams.commands = kind.map(|kind| kind.commands(self.timed(part), |row| Numbers::pair(&commands, row)));
            let is_impossible = |number: &f64| !number.is_finite() || number.abs() > MAX_COMMAND;
            let mut numbers = streams.commands.iter().flat_map(|of| of.samples.iter().flat_map(|(_, pair)| pair));
            if numbers.any(is_impossible) {
                return Err(Error::in_file(&streams.file, "has a command that no robot could follow"));
            }
        }
        drop(commands);
        for ((body, poses), axis) in columns.bodies.iter().zip(poses).zip(axes) {
            let axis = axis.or(axes.iter().flatten().next().copied()).unwrap_or(columns.upright);
            for (part, streams) in read.iter_mut().enumerate() {
                let frame = |(row, t_ms)| poses.get(row, axis).map(|pose| Frame { t_ms, pose });
                let frames: Vec<Option<Frame>> = self.timed(part).map(frame).collect();
                if let [_] = columns.bodies.as_slice() {
                    let lost = frames.iter().filter(|frame| frame.is_none()).count();
                    streams.source = streams.source.clone().left_out(lost, "without a pose");
                }
                streams.bodies.push(BodyTrack { name: body.name.clone(), frames });
            }
        }
        for ((sensor, _), readings) in columns.ranges.iter().zip(readings) {
            for (part, streams) in read.iter_mut().enumerate() {
                let samples = self.timed(part).map(|(row, ms)| (ms, readings.get(row))).collect();
                streams.readings.push((*sensor, samples));
            }
        }
        for (part, streams) in read.iter_mut().enumerate() {
            let samples =
                |numbers: &Numbers| self.timed(part).filter_map(|(row, ms)| Some((ms, numbers.get(row)?))).collect();
            streams.counters = counters.each_ref().map(|wheels| wheels.iter().map(samples).collect());
            streams.gyro = columns.gyro.as_ref().map(|_| samples(&gyro));
        }
        Ok(())
    }
}
