//! Checks for a sensor that is stuck, repeats old readings, or saturates.
//!
//! A row without a reading means no echo, so such readings cannot be removed: they withhold the sensor from comparison.

use super::echoes::Repeated;
use super::finding::Finding;
use super::segments::MIN_SAMPLES;
use crate::{Logs, Row, Run};
use mindgap_foundations::geometry::wrap_rad;

/// Minimum number of equal readings in a row of a stuck sensor.
const MIN_STUCK: usize = 12;
/// While its readings stay equal, a robot with a stuck sensor moves at least this far,
const STUCK_CM: f64 = 60.0;
/// or turns at least this much, rad: three quarters of a turn.
const STUCK_RAD: f64 = 4.7;
/// Minimum fraction of readings that are stuck, repeated or saturated.
const MIN_STUCK_FRACTION: f64 = 0.05;
const MIN_REPEATED_FRACTION: f64 = 0.3;
const MIN_SATURATED_FRACTION: f64 = 0.1;
/// A robot that approaches what it sees by at least this much, cm, gets another reading,
const CHANGED_CM: f64 = 5.0;
/// unless it turns by more than this, rad.
const STRAIGHT_RAD: f64 = 0.1;

/// Reports readings that stay equal while the robot moves far, or repeat while it drives straight ahead.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let readings = logs.runs.iter().flat_map(|run| &run.rows).filter(|row| row.echo_cm.is_some()).count() as f64;
    let stuck = rows_by_run(logs, stuck);
    if stuck.len() >= MIN_STUCK && stuck.len() as f64 >= MIN_STUCK_FRACTION * readings {
        let sentence = "Readings stay exactly equal while the robot moves far: the sensor is stuck, or its last reading is logged \
                        again and again; log a reading once, and leave the cell empty without one.";
        return vec![Finding::of_readings(logs, "echo_stuck", &stuck, sentence.into())];
    }
    let pairs: Vec<(usize, usize)> = rows_by_run(logs, approaching);
    let repeats = |(run, row): &&(usize, usize)| {
        let rows = &logs.runs[*run].rows;
        rows.at(*row).echo_cm == rows.at(row - 1).echo_cm
    };
    let repeated: Vec<(usize, usize)> = pairs.iter().filter(repeats).copied().collect();
    if repeated.len() >= MIN_SAMPLES && repeated.len() as f64 >= MIN_REPEATED_FRACTION * pairs.len() as f64 {
        let share = 100.0 * repeated.len() as f64 / pairs.len() as f64;
        let sentence = format!(
            "{share:.0} % of the readings repeat the one before although the robot drove on: old readings are logged again; log \
             each reading once, and leave the cell empty without a new one."
        );
        return vec![Finding::of_readings(logs, "echo_repeated", &repeated, sentence)];
    }
    saturated(logs).into_iter().collect()
}

/// Reports a largest reading that occurs far too often although walls are farther away.
fn saturated(logs: &Logs) -> Option<Finding> {
    let Repeated { cm, rows, farther } = Repeated::largest(logs, MIN_SATURATED_FRACTION)?;
    let is_farther = farther.is_none_or(|farther| farther > 0.5);
    is_farther.then(|| {
        let sentence = format!(
            "Readings pile up at {cm} cm: the sensor saturates there, and what is farther away is not measured; set max_cm in \
             robot.toml to less, and leave the cell empty for such readings."
        );
        Finding::of_readings(logs, "echo_saturated", &rows, sentence)
    })
}

fn rows_by_run(logs: &Logs, of_run: impl Fn(&Run) -> Vec<usize>) -> Vec<(usize, usize)> {
    let runs = logs.runs.iter().enumerate();
    runs.flat_map(|(run, r)| of_run(r).into_iter().map(move |row| (run, row))).collect()
}

/// Returns the rows whose readings are stuck.
fn stuck(run: &Run) -> Vec<usize> {
    let mut rows = Vec::new();
    let mut from = 0;
    while from < run.rows.len() {
        let echo_cm = run.rows.at(from).echo_cm;
        let count = run.rows.between(from..run.rows.len()).take_while(|row| row.echo_cm == echo_cm).count();
        if echo_cm.is_some() && count >= MIN_STUCK && moves_far(run, from, from + count) {
            rows.extend(from + 1..from + count);
        }
        from += count.max(1);
    }
    rows
}

fn moves_far(run: &Run, from: usize, to: usize) -> bool {
    let poses: Vec<_> = run.rows.between(from..to).filter_map(|row| row.pose).collect();
    let Some(first) = poses.first() else { return false };
    let turned = poses.windows(2).map(|pair| wrap_rad(pair[1].heading_rad - pair[0].heading_rad));
    let turned = turned.scan(0.0, |sum: &mut f64, rad| {
        *sum += rad;
        Some(sum.abs())
    });
    turned.fold(0.0, f64::max) >= STUCK_RAD
        || poses.iter().any(|pose| pose.position_cm.distance(first.position_cm) >= STUCK_CM)
}

/// Returns the rows with a reading, as the row before, between which the robot drove straight ahead.
fn approaching(run: &Run) -> Vec<usize> {
    let drives = |[a, b]: [Row; 2]| {
        let change = a.pose?.relative(&b.pose?);
        let is_straight = change.heading_rad.abs() <= STRAIGHT_RAD && change.position_cm.x.abs() >= CHANGED_CM;
        (is_straight && a.echo_cm.is_some() && b.echo_cm.is_some()).then_some(())
    };
    run.rows.pairs().enumerate().filter_map(|(k, pair)| drives(pair).map(|()| k + 1)).collect()
}
