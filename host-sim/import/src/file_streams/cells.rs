//! The cells of a file, column by column, as numbers.

use crate::column::Column;
use crate::columns::{Columns, ReadTimes};
use crate::spatial_pose::SpatialPose;
use crate::table::{Line, Table};
use crate::upright::Axis;
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;

/// The cells of a file. All columns have as many rows.
pub struct Cells<'a> {
    columns: &'a Columns,
    part: usize,
    /// Sums of the absolute speeds ahead and to the left.
    speeds: [f64; 2],
    /// The times.
    pub times: ReadTimes<'a>,
    /// What is in the rows.
    pub rows: Rows,
    /// Numbers of the rows' lines.
    pub lines: Vec<u32>,
    /// The first rows below repeated headers.
    pub starts: Vec<usize>,
}

/// The columns of a file but for its times.
pub struct Rows {
    /// The two numbers of a command; none unless the file has commands.
    pub commands: [Numbers; 2],
    /// Poses by body.
    pub poses: Vec<Poses>,
    /// Readings by range sensor, cm.
    pub readings: Vec<Numbers>,
    /// Angles of the left and of the right wheels, rad.
    pub counters: [Vec<Numbers>; 2],
    /// Yaw rates, rad/s; none unless the file has a gyro.
    pub gyro: Numbers,
}

/// Optional numbers; NaN stands for none.
#[derive(Clone, Default)]
pub struct Numbers(Vec<f64>);

/// The poses of a body. Most are in the plane, which takes a third of the memory.
pub enum Poses {
    /// x and y, cm, and heading, rad.
    Planar([Numbers; 3]),
    /// In space, so that any axis may point upwards.
    Spatial(Vec<Option<SpatialPose>>),
}

impl<'a> Cells<'a> {
    /// Begins to read a table.
    pub fn of(table: &'a Table, columns: &'a Columns) -> Self {
        let numbers = |columns: &Vec<Column>| vec![Numbers::default(); columns.len()];
        let poses = columns
            .bodies
            .iter()
            .map(|body| if body.is_spatial() { Poses::Spatial(Vec::new()) } else { Poses::Planar(Default::default()) });
        let rows = Rows {
            commands: Default::default(),
            poses: poses.collect(),
            readings: vec![Numbers::default(); columns.ranges.len()],
            counters: columns.counters.each_ref().map(numbers),
            gyro: Numbers::default(),
        };
        let times = ReadTimes::new(table, &columns.times);
        Cells { columns, part: 0, speeds: [0.0; 2], times, rows, lines: Vec::new(), starts: Vec::new() }
    }

    /// Reads a line. A line that cannot be read adds nothing.
    ///
    /// # Errors
    /// When a cell is invalid.
    pub fn push(&mut self, line: &Line) -> Result<()> {
        let rows = self.lines.len();
        let pushed = self.rows.push(line, self.columns).and_then(|speeds| self.times.push(line).map(|()| speeds));
        let [ahead, left] = pushed.inspect_err(|_| self.rows.truncate(rows))?;
        self.speeds = [self.speeds[0] + ahead, self.speeds[1] + left];
        if line.part > self.part {
            self.part = line.part;
            self.starts.push(rows);
        }
        self.lines.push(line.number as u32);
        Ok(())
    }

    /// Returns the share of the commanded travel that is to the side, percent.
    pub fn percent_sideways(&self) -> f64 {
        let [ahead, left] = self.speeds;
        if left > 0.0 { 100.0 * left / (ahead + left) } else { 0.0 }
    }
}

impl Rows {
    /// Reads a line, and returns the absolute speeds ahead and to the left.
    fn push(&mut self, line: &Line, columns: &Columns) -> Result<[f64; 2]> {
        let mut speeds = [0.0; 2];
        if let Some(commands) = &columns.commands {
            let pair = commands.pair(line)?;
            self.commands.iter_mut().enumerate().for_each(|(i, numbers)| numbers.push(pair.map(|pair| pair[i])));
            let sideways = columns.sideways.as_ref().map_or(Ok(None), |sideways| sideways.value(line))?;
            if let (Some([ahead, _]), Some(sideways)) = (pair, sideways) {
                speeds = [ahead.abs(), sideways.abs()];
            }
        }
        for (poses, body) in self.poses.iter_mut().zip(&columns.bodies) {
            poses.push(body.pose(line)?);
        }
        for (numbers, (_, range)) in self.readings.iter_mut().zip(&columns.ranges) {
            numbers.push(range.reading_cm(line)?);
        }
        for (numbers, wheel) in self.counters.iter_mut().flatten().zip(columns.counters.iter().flatten()) {
            numbers.push(wheel.value(line)?);
        }
        if let Some(gyro) = &columns.gyro {
            self.gyro.push(gyro.value(line)?);
        }
        Ok(speeds)
    }

    fn truncate(&mut self, rows: usize) {
        let own = self.commands.iter_mut().chain(&mut self.readings).chain([&mut self.gyro]);
        own.chain(self.counters.iter_mut().flatten()).for_each(|numbers| numbers.0.truncate(rows));
        self.poses.iter_mut().for_each(|poses| match poses {
            Poses::Planar(columns) => columns.iter_mut().for_each(|numbers| numbers.0.truncate(rows)),
            Poses::Spatial(poses) => poses.truncate(rows),
        });
    }
}

impl Numbers {
    fn push(&mut self, number: Option<f64>) {
        self.0.push(number.unwrap_or(f64::NAN));
    }

    /// Returns the number of a row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn get(&self, row: usize) -> Option<f64> {
        Some(self.0[row]).filter(|number| !number.is_nan())
    }

    /// Returns the pair of numbers in a row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn pair([a, b]: &[Numbers; 2], row: usize) -> Option<[f64; 2]> {
        Some([a.get(row)?, b.get(row)?])
    }

    /// Returns the pairs of numbers in all rows.
    pub fn pairs(columns: &[Numbers; 2]) -> impl Iterator<Item = [f64; 2]> {
        (0..columns[0].0.len()).filter_map(|row| Numbers::pair(columns, row))
    }
}

impl Poses {
    fn push(&mut self, pose: Option<SpatialPose>) {
        match self {
            Poses::Planar([x, y, heading]) => {
                let pose = pose.map(|pose| Axis::Z.on_floor(&pose));
                x.push(pose.map(|pose| pose.position_cm.x));
                y.push(pose.map(|pose| pose.position_cm.y));
                heading.push(pose.map(|pose| pose.heading_rad));
            }
            Poses::Spatial(poses) => poses.push(pose),
        }
    }

    /// Returns the upright axis; `None` if the poses do not show it.
    pub fn axis(&self) -> Option<Axis> {
        match self {
            Poses::Planar(_) => Some(Axis::Z),
            Poses::Spatial(poses) => Axis::upright(poses.iter().flatten().copied()),
        }
    }

    /// Returns the pose in a row, by this upright axis; `None` where the body was lost.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn get(&self, row: usize, axis: Axis) -> Option<Pose> {
        match self {
            Poses::Planar([x, y, heading]) => {
                Some(Pose { position_cm: glam::DVec2::new(x.get(row)?, y.get(row)?), heading_rad: heading.get(row)? })
            }
            Poses::Spatial(poses) => poses[row].map(|pose| axis.on_floor(&pose)),
        }
    }
}
