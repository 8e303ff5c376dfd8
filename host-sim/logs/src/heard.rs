//! Logs as one of several range sensors heard them.

use std::collections::BTreeSet;

use super::inspection::Inspection;
use super::range_sensor::{RangeSensor, Sensors, column_of};
use super::{Logs, Run};
use mindgap_foundations::error::{Error, Result};

/// Logs as one range sensor heard them.
pub struct Heard {
    /// The name of the sensor.
    pub sensor: String,
    /// The logs of a robot with this sensor alone.
    pub logs: Logs,
}

/// Removes the readings of sensors that lack a column in a run, since a reading that was not logged is no missing echo; `warn`
/// receives a line for each. `have_echoes` has an element for each run, with one for each sensor.
pub(super) fn silence_incomplete(runs: &mut [Run], have_echoes: &[Vec<bool>], mut warn: impl FnMut(String)) {
    let Some(sensors) = runs.first().map(|run| run.rows.sensors().clone()) else { return };
    for (index, sensor) in sensors.names().enumerate() {
        let Some(without) = have_echoes.iter().position(|run| !run[index]) else { continue };
        let (run, column) = (&runs[without].name, column_of(sensor));
        warn(format!("{run} has no column {column}: range sensor {sensor:?} is not compared"));
        for run in runs.iter_mut() {
            let rows = 0..run.rows.len();
            match index.checked_sub(1) {
                None => run.rows.edit_each(|row| row.echo_cm = None),
                Some(further) => rows.for_each(|row| run.rows.set_further_cm(further, row, None)),
            }
        }
    }
}

impl Logs {
    /// Returns the robot's range sensors; of logs that were not read from a folder, the usual ones.
    pub fn sensors(&self) -> Sensors {
        self.runs.first().map(|run| run.rows.sensors().clone()).unwrap_or_default()
    }

    /// Returns the logs for training and evaluation as each range sensor heard them, the first sensor first; `warn` receives the
    /// findings that were handled. A sensor whose readings must not be compared loses them, as long as another remains.
    ///
    /// # Errors
    /// When there is a defect that could not be handled.
    pub fn usable_by_sensor(self, mut warn: impl FnMut(String)) -> Result<Vec<Heard>> {
        let mut known = BTreeSet::new();
        let inspected = self.by_sensor().into_iter().map(|heard| (heard.sensor, Inspection::new(heard.logs)));
        let mut inspected: Vec<(String, Inspection)> = inspected.collect();
        if inspected.iter().any(|(_, inspection)| inspection.refusal().is_none()) {
            inspected.iter_mut().for_each(|(_, inspection)| inspection.silence_unsound());
        }
        let usable = |(index, (sensor, inspection)): (usize, (String, Inspection))| {
            let named = |line: String| if index == 0 { line } else { format!("range sensor {sensor}: {line}") };
            let mut lines = Vec::new();
            let logs = inspection.into_usable(|line| lines.push(line));
            // What concerns all columns is found again for each sensor.
            lines.into_iter().filter(|line| known.insert(line.clone())).for_each(|line| warn(named(line)));
            let logs = logs.map_err(|error| Error::new(named(error.to_string())))?;
            Ok(Heard { sensor, logs })
        };
        inspected.into_iter().enumerate().map(usable).collect()
    }

    /// Returns the logs as each range sensor heard them, the first sensor first.
    pub fn by_sensor(&self) -> Vec<Heard> {
        let first = Heard { sensor: self.sensors().first().into(), logs: self.clone() };
        std::iter::once(first).chain(self.by_further_sensor()).collect()
    }

    /// Returns the logs as each further range sensor heard them.
    pub fn by_further_sensor(&self) -> Vec<Heard> {
        let heard = |(index, sensor): (usize, &RangeSensor)| {
            let mut logs = Logs { robot: self.robot, scene: self.scene.clone(), runs: Vec::new() };
            logs.robot.ultrasonic = Some(sensor.mount());
            logs.runs
                .extend(self.runs.iter().map(|run| Run { name: run.name.clone(), rows: run.rows.heard_by(index) }));
            Heard { sensor: sensor.name.clone(), logs }
        };
        self.sensors().further().iter().enumerate().map(heard).collect()
    }
}
