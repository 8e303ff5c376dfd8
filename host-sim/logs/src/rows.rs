//! The rows of a run, column beside column: a long run takes a quarter of what its rows would take one by one.

mod column;

use std::fmt;
use std::ops::Range;

use glam::DVec2;

use self::column::{Column, Meaning};
use super::row::Row;
use mindgap_foundations::geometry::Pose;

/// The rows of a run. What is said of a row comes back as it was said, but NaN, which stands for no number.
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
}

impl Rows {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// A row.
    ///
    /// # Panics
    /// When there are not so many rows.
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
        }
    }

    /// A row, if there is such.
    #[inline]
    pub fn get(&self, row: usize) -> Option<Row> {
        (row < self.len).then(|| self.at(row))
    }

    /// The first row.
    pub fn first(&self) -> Option<Row> {
        self.get(0)
    }

    /// The last row.
    pub fn last(&self) -> Option<Row> {
        self.get(self.len.checked_sub(1)?)
    }

    /// All rows in order.
    pub fn iter(&self) -> Iter<'_> {
        self.between(0..self.len)
    }

    /// Some rows in order.
    ///
    /// # Panics
    /// When there are not so many rows.
    pub fn between(&self, places: Range<usize>) -> Iter<'_> {
        assert!(places.end <= self.len, "rows up to {} of {}", places.end, self.len);
        Iter { rows: self, places }
    }

    /// Every row with the one after it.
    pub fn pairs(&self) -> impl Iterator<Item = [Row; 2]> + '_ {
        (1..self.len).map(|end| [self.at(end - 1), self.at(end)])
    }

    /// Index of the first row later than a time.
    pub fn later_than(&self, t_ms: f64) -> usize {
        let (mut low, mut high) = (0, self.len);
        while low < high {
            let middle = low.midpoint(high);
            if self.at(middle).t_ms <= t_ms { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// Adds a row at the end.
    pub fn push(&mut self, row: Row) {
        self.len += 1;
        self.set(self.len - 1, row);
    }

    /// Changes a row.
    ///
    /// # Panics
    /// When there are not so many rows.
    pub fn edit(&mut self, row: usize, change: impl FnOnce(&mut Row)) {
        let mut changed = self.at(row);
        change(&mut changed);
        self.set(row, changed);
    }

    /// Changes the pose of a row, if it has one.
    ///
    /// # Panics
    /// When there are not so many rows.
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

    /// Keeps the first rows only.
    pub fn truncate(&mut self, rows: usize) {
        self.len = self.len.min(rows);
        self.columns().into_iter().for_each(|column| column.truncate(rows));
    }

    /// Gives back memory that is kept for further rows.
    pub fn shrink(&mut self) {
        self.columns().into_iter().for_each(Column::shrink);
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
    }

    fn columns(&mut self) -> [&mut Column; 10] {
        [
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
        ]
    }
}

impl Default for Rows {
    fn default() -> Self {
        let column = || Column::new(Meaning::Same);
        Rows {
            len: 0,
            t_ms: column(),
            left: column(),
            right: column(),
            x_cm: column(),
            y_cm: column(),
            heading_rad: Column::new(Meaning::Angle),
            echo_cm: column(),
            rot_left_deg: column(),
            rot_right_deg: column(),
            battery_mv: column(),
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
        self.len == other.len && self.iter().eq(other)
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

/// Rows in order.
#[derive(Clone)]
pub struct Iter<'a> {
    rows: &'a Rows,
    places: Range<usize>,
}

impl Iterator for Iter<'_> {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        self.places.next().map(|row| self.rows.at(row))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.places.size_hint()
    }
}

impl DoubleEndedIterator for Iter<'_> {
    fn next_back(&mut self) -> Option<Row> {
        self.places.next_back().map(|row| self.rows.at(row))
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
    fn rows_come_back_as_they_were_and_changed_as_they_were_changed() {
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
    fn the_first_row_later_than_a_time_is_found() {
        let rows: Rows = (0..5).map(row).collect();
        let later = [-1.0, 0.0, 399.0, 400.0, 1600.0].map(|t_ms| rows.later_than(t_ms));
        assert_eq!(later, [0, 1, 1, 2, 5]);
    }
}
