//! The rows of a run, stored by column, which takes a quarter of the memory of a vector of rows.

mod column;

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use glam::DVec2;

use self::column::{Column, Unit};
use super::commands::CommandChanges;
use super::range_sensor::Sensors;
use super::row::Row;
use mindgap_foundations::geometry::Pose;

/// The rows of a run. Rows are returned exactly as they were set, except that NaN becomes a missing number.
#[derive(Clone)]
pub struct Rows {
    len: usize,
    t_ms: Column,
    left: Column,
    right: Column,
    x_cm: Column,
    y_cm: Column,
    heading_rad: Column,
    echo_cm: Column,
    rot_left_deg: Column,
    rot_right_deg: Column,
    battery_mv: Column,
    gyro_deg_s: Column,
    changes: Option<CommandChanges>,
    sensors: Arc<Sensors>,
    /// Readings of the further range sensors, in their order.
    further: Vec<Column>,
}

impl Rows {
    /// Returns no rows yet, of a robot with these range sensors.
    pub fn of(sensors: Arc<Sensors>) -> Self {
        Rows::default().of_sensors(sensors)
    }

    /// Returns the rows of a robot with these range sensors: with the readings of the first, and of those further ones that it had
    /// by the same name.
    pub fn of_sensors(self, sensors: Arc<Sensors>) -> Self {
        let had = |name: &str| self.sensors.further().iter().position(|sensor| sensor.name == name);
        let column =
            |index: Option<usize>| index.map_or(Column::new(Unit::AsWritten), |index| self.further[index].clone());
        let further = sensors.further().iter().map(|sensor| column(had(&sensor.name))).collect();
        Rows { sensors, further, ..self }
    }

    /// Returns the range sensors of the robot.
    pub fn sensors(&self) -> &Sensors {
        &self.sensors
    }

    /// Returns the reading of a further range sensor at a row, cm; `None` if it produced no value.
    pub fn further_cm(&self, sensor: usize, row: usize) -> Option<f64> {
        self.further.get(sensor)?.get(row)
    }

    /// Sets the reading of a further range sensor at a row, cm.
    ///
    /// # Panics
    /// If there is no such sensor.
    pub fn set_further_cm(&mut self, sensor: usize, row: usize, reading_cm: Option<f64>) {
        self.further[sensor].set(row, reading_cm);
    }

    /// Returns the rows with the readings of one further range sensor alone.
    ///
    /// # Panics
    /// If there is no such sensor.
    pub fn heard_by(&self, sensor: usize) -> Self {
        let echo_cm = self.further[sensor].clone();
        Rows { echo_cm, sensors: Arc::default(), further: Vec::new(), ..self.clone() }
    }

    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns row `row`.
    ///
    /// # Panics
    /// If `row >= self.len()`.
    #[inline]
    pub fn at(&self, row: usize) -> Row {
        assert!(row < self.len, "row {row} of {}", self.len);
        let pose = |x_cm, y_cm, heading_rad| Pose { position_cm: DVec2::new(x_cm, y_cm), heading_rad };
        Row {
            t_ms: self.t_ms.get(row).unwrap_or_default(),
            left: self.left.get(row).unwrap_or_default(),
            right: self.right.get(row).unwrap_or_default(),
            pose: self
                .x_cm
                .get(row)
                .zip(self.y_cm.get(row))
                .zip(self.heading_rad.get(row))
                .map(|((x_cm, y_cm), heading_rad)| pose(x_cm, y_cm, heading_rad)),
            echo_cm: self.echo_cm.get(row),
            rot_left_deg: self.rot_left_deg.get(row),
            rot_right_deg: self.rot_right_deg.get(row),
            battery_mv: self.battery_mv.get(row),
            gyro_deg_s: self.gyro_deg_s.get(row),
        }
    }

    /// Returns row `row`, or `None` if out of bounds.
    #[inline]
    pub fn get(&self, row: usize) -> Option<Row> {
        (row < self.len).then(|| self.at(row))
    }

    /// Returns the first row, if any.
    pub fn first(&self) -> Option<Row> {
        self.get(0)
    }

    /// Returns the last row, if any.
    pub fn last(&self) -> Option<Row> {
        self.get(self.len.checked_sub(1)?)
    }

    /// Iterates over all rows.
    pub fn iter(&self) -> Iter<'_> {
        self.between(0..self.len)
    }

    /// Iterates over a range of rows.
    ///
    /// # Panics
    /// If the range ends beyond `self.len()`.
    pub fn between(&self, range: Range<usize>) -> Iter<'_> {
        assert!(range.end <= self.len, "rows up to {} of {}", range.end, self.len);
        Iter { rows: self, range }
    }

    /// Iterates over pairs of consecutive rows.
    pub fn pairs(&self) -> impl Iterator<Item = [Row; 2]> + '_ {
        (1..self.len).map(|end| [self.at(end - 1), self.at(end)])
    }

    /// Returns the commands at their own times, where these are known. Those of the rows are then their means.
    pub fn changes(&self) -> Option<&CommandChanges> {
        self.changes.as_ref()
    }

    /// Returns the command that holds when the first row begins: none, unless one is known to be older.
    pub fn command_before_start(&self) -> [f64; 2] {
        let before = self.changes.as_ref().zip(self.first()).and_then(|(changes, row)| changes.before(row.t_ms).last());
        before.map_or([0.0; 2], |change| change.command)
    }

    /// Returns when the step of row `row` ends, ms; that of the last row would last as long as the one before.
    pub fn end_ms(&self, row: usize) -> f64 {
        let t_ms = |row: usize| self.t_ms.get(row).unwrap_or_default();
        if row + 1 < self.len { t_ms(row + 1) } else { 2.0 * t_ms(row) - t_ms(row.saturating_sub(1)) }
    }

    /// Sets the commands at their own times, and those of the rows to their means. Returns the largest difference from
    /// those that the rows had.
    pub fn set_changes(&mut self, changes: CommandChanges) -> f64 {
        let mut largest = 0.0_f64;
        for k in 0..self.len {
            let (row, end_ms) = (self.at(k), self.end_ms(k));
            if end_ms > row.t_ms {
                let [left, right] = changes.mean(row.t_ms, end_ms);
                largest = largest.max((left - row.left).abs()).max((right - row.right).abs());
                self.set(k, Row { left, right, ..row });
            }
        }
        self.changes = Some(changes);
        largest
    }

    /// Multiplies all times, also those of commands.
    pub fn scale_times(&mut self, factor: f64) {
        self.edit_each(|row| row.t_ms *= factor);
        self.changes.iter_mut().for_each(|changes| changes.edit_each(|change| change.t_ms *= factor));
    }

    /// Multiplies all commands.
    pub fn scale_commands(&mut self, factor: f64) {
        self.edit_each(|row| (row.left, row.right) = (row.left * factor, row.right * factor));
        let scale = |command: &mut [f64; 2]| *command = command.map(|command| command * factor);
        self.changes.iter_mut().for_each(|changes| changes.edit_each(|change| scale(&mut change.command)));
    }

    /// Returns the first `rows` rows, or all if there are fewer.
    pub fn beginning(&self, rows: usize) -> Rows {
        let first: Rows = self.between(0..rows.min(self.len)).collect();
        Rows { changes: self.changes.clone(), ..first }
    }

    /// Returns the index of the first row later than `t_ms`, or `self.len()`.
    pub fn first_later_than(&self, t_ms: f64) -> usize {
        let (mut low, mut high) = (0, self.len);
        while low < high {
            let middle = low.midpoint(high);
            if self.at(middle).t_ms <= t_ms { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// Appends a row.
    pub fn push(&mut self, row: Row) {
        self.len += 1;
        self.set(self.len - 1, row);
    }

    /// Changes row `row`.
    ///
    /// # Panics
    /// If `row >= self.len()`.
    pub fn edit(&mut self, row: usize, change: impl FnOnce(&mut Row)) {
        let mut changed = self.at(row);
        change(&mut changed);
        self.set(row, changed);
    }

    /// Changes the pose of row `row`, if it has one.
    ///
    /// # Panics
    /// If `row >= self.len()`.
    pub fn edit_pose(&mut self, row: usize, change: impl FnOnce(&mut Pose)) {
        self.edit(row, |row| {
            if let Some(pose) = &mut row.pose {
                change(pose);
            }
        });
    }

    /// Changes every row.
    pub fn edit_each(&mut self, mut change: impl FnMut(&mut Row)) {
        (0..self.len).for_each(|row| self.edit(row, &mut change));
    }

    /// Changes every pose.
    pub fn edit_poses(&mut self, mut change: impl FnMut(&mut Pose)) {
        self.edit_each(|row| row.pose.iter_mut().for_each(&mut change));
    }

    /// Keeps only the first `rows` rows.
    pub fn truncate(&mut self, rows: usize) {
        self.len = self.len.min(rows);
        self.columns().for_each(|column| column.truncate(rows));
    }

    /// Releases spare capacity.
    pub fn shrink(&mut self) {
        self.columns().for_each(Column::shrink);
    }

    fn set(&mut self, at: usize, row: Row) {
        self.t_ms.set(at, Some(row.t_ms));
        self.left.set(at, Some(row.left));
        self.right.set(at, Some(row.right));
        self.x_cm.set(at, row.pose.map(|pose| pose.position_cm.x));
        self.y_cm.set(at, row.pose.map(|pose| pose.position_cm.y));
        self.heading_rad.set(at, row.pose.map(|pose| pose.heading_rad));
        self.echo_cm.set(at, row.echo_cm);
        self.rot_left_deg.set(at, row.rot_left_deg);
        self.rot_right_deg.set(at, row.rot_right_deg);
        self.battery_mv.set(at, row.battery_mv);
        self.gyro_deg_s.set(at, row.gyro_deg_s);
    }

    fn columns(&mut self) -> impl Iterator<Item = &mut Column> {
        let first = [
            &mut self.t_ms,
            &mut self.left,
            &mut self.right,
            &mut self.x_cm,
            &mut self.y_cm,
            &mut self.heading_rad,
            &mut self.echo_cm,
            &mut self.rot_left_deg,
            &mut self.rot_right_deg,
            &mut self.battery_mv,
            &mut self.gyro_deg_s,
        ];
        first.into_iter().chain(&mut self.further)
    }
}

impl Default for Rows {
    fn default() -> Self {
        let column = || Column::new(Unit::AsWritten);
        Rows {
            len: 0,
            t_ms: column(),
            left: column(),
            right: column(),
            x_cm: column(),
            y_cm: column(),
            heading_rad: Column::new(Unit::DegreesToRadians),
            echo_cm: column(),
            rot_left_deg: column(),
            rot_right_deg: column(),
            battery_mv: column(),
            gyro_deg_s: column(),
            changes: None,
            sensors: Arc::default(),
            further: Vec::new(),
        }
    }
}

impl FromIterator<Row> for Rows {
    fn from_iter<I: IntoIterator<Item = Row>>(rows: I) -> Self {
        let mut all = Rows::default();
        rows.into_iter().for_each(|row| all.push(row));
        all
    }
}

impl PartialEq for Rows {
    fn eq(&self, other: &Self) -> bool {
        self.len == other.len && self.changes == other.changes && self.iter().eq(other)
    }
}

impl fmt::Debug for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self).finish()
    }
}

impl<'a> IntoIterator for &'a Rows {
    type Item = Row;
    type IntoIter = Iter<'a>;

    fn into_iter(self) -> Iter<'a> {
        self.iter()
    }
}

/// An iterator over rows.
#[derive(Clone)]
pub struct Iter<'a> {
    rows: &'a Rows,
    range: Range<usize>,
}

impl Iterator for Iter<'_> {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        self.range.next().map(|row| self.rows.at(row))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.range.size_hint()
    }
}

impl DoubleEndedIterator for Iter<'_> {
    fn next_back(&mut self) -> Option<Row> {
        self.range.next_back().map(|row| self.rows.at(row))
    }
}

impl ExactSizeIterator for Iter<'_> {}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(k: u32) -> Row {
        let k = f64::from(k);
        Row { t_ms: 400.0 * k, left: k, pose: Some(Pose::new(k, 0.5, 0.1 * k)), ..Row::default() }
    }

    #[test]
    fn rows_round_trip_and_edits_persist() {
        let all: Vec<Row> = (0..5).map(row).collect();
        let mut rows: Rows = all.iter().copied().collect();
        assert!(rows.iter().eq(all.iter().copied()) && rows.iter().rev().eq(all.iter().rev().copied()));
        assert_eq!((rows.first(), rows.last(), rows.get(5)), (Some(all[0]), Some(all[4]), None));
        assert!(rows.pairs().eq(all.windows(2).map(|pair| [pair[0], pair[1]])));
        rows.edit(2, |row| row.pose = None);
        rows.edit_each(|row| row.echo_cm = Some(row.left / 3.0));
        assert_eq!(rows.at(2), Row { pose: None, echo_cm: Some(2.0 / 3.0), ..all[2] });
        assert_eq!(rows.at(1).pose, all[1].pose);
        rows.truncate(3);
        assert_eq!((rows.len(), rows.last().map(|row| row.t_ms)), (3, Some(800.0)));
    }

    #[test]
    fn first_later_than_finds_the_row() {
        let rows: Rows = (0..5).map(row).collect();
        let later = [-1.0, 0.0, 399.0, 400.0, 1600.0].map(|t_ms| rows.first_later_than(t_ms));
        assert_eq!(later, [0, 1, 1, 2, 5]);
    }
}
