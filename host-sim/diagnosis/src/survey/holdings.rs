//! What logs hold, in numbers.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::Serialize;

use crate::excitation::Detectable;
use mindgap_foundations::statistics::rounding;
use mindgap_foundations::statistics::summary::median;
use mindgap_logs::{Logs, Row, Run, Ultrasonic, rows, samples};

/// Amount, rates, ranges and coverage of logs. Ranges are none where there is nothing.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Holdings {
    /// Number of runs.
    pub runs: usize,
    /// Number of rows.
    pub rows: usize,
    /// Number of steps with a pose at both ends.
    pub steps: usize,
    /// Duration of all runs, s.
    #[serde(serialize_with = "rounding::number")]
    pub duration_s: f64,
    /// Median time between rows, ms.
    #[serde(serialize_with = "rounding::number")]
    pub step_ms: f64,
    /// 95 % of the times between rows are within this of the median, ms.
    #[serde(serialize_with = "rounding::number")]
    pub jitter_ms: f64,
    /// Share of rows with a pose.
    #[serde(serialize_with = "rounding::number")]
    pub with_pose: f64,
    /// Share of rows with a reading.
    #[serde(serialize_with = "rounding::number")]
    pub with_reading: f64,
    /// Commands of the left motor.
    pub left: Option<Range>,
    /// Commands of the right motor.
    pub right: Option<Range>,
    /// Forward speed, cm/s.
    pub forward_cm_s: Option<Range>,
    /// Turn rate to the left, degrees/s.
    pub turn_deg_s: Option<Range>,
    /// Readings, cm.
    pub reading_cm: Option<Range>,
    /// Distance D where a pose is known and a wall is ahead, cm.
    pub distance_cm: Option<Range>,
    /// Incidence angle α where a pose is known and a wall is ahead, degrees.
    pub alpha_deg: Option<Range>,
    /// Share of the pairs of commands that occur, in cells of 20 by 20.
    #[serde(serialize_with = "rounding::number")]
    pub command_coverage: f64,
    /// Share of the pairs of D and α that occur, in cells of a tenth of the range by 15°.
    #[serde(serialize_with = "rounding::number")]
    pub sensor_coverage: f64,
    /// What the robot measures of its own motion, and what a diagnosis reads from it.
    pub witnesses: Vec<Witness>,
    /// Median number of steps for which a pair of commands is held.
    pub held_steps: f64,
    /// Maximum number of steps for which a pair of commands is held.
    pub longest_held_steps: u32,
    /// What the logs contain of further range sensors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<Heard>,
    /// The smallest strength of each effect that a diagnosis against `kinematic` would show.
    pub detectable: Vec<Detectable>,
}

/// What a further range sensor measures.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Heard {
    /// Its name.
    pub sensor: String,
    /// Share of rows with a reading.
    #[serde(serialize_with = "rounding::number")]
    pub with_reading: f64,
    /// Readings, cm.
    pub reading_cm: Option<Range>,
    /// Distance D where a pose is known and a wall is ahead, cm.
    pub distance_cm: Option<Range>,
    /// Incidence angle α where a pose is known and a wall is ahead, degrees.
    pub alpha_deg: Option<Range>,
    /// Share of the pairs of D and α that occur, in cells of a tenth of the range by 15°.
    #[serde(serialize_with = "rounding::number")]
    pub sensor_coverage: f64,
}

/// A column, or a pair of them, that the robot itself measures.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Witness {
    /// The columns.
    pub columns: &'static str,
    /// Share of rows that have them.
    #[serde(serialize_with = "rounding::number")]
    pub rows: f64,
    /// What a diagnosis reads from them.
    pub adds: &'static str,
}

/// Whether a row has some columns.
type HasColumns = fn(&Row) -> bool;

/// Columns, what a diagnosis reads from them, and whether a row has them.
const WITNESSES: [(&str, &str, HasColumns); 2] = [
    ("rot_left_deg, rot_right_deg", "motion of the wheels; used if the robot was not tracked", |row| {
        row.rot_left_deg.is_some() && row.rot_right_deg.is_some()
    }),
    ("gyro_deg_s", "turns of the body; used if the robot was not tracked", |row| row.gyro_deg_s.is_some()),
];

/// Least and largest of some numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Range {
    /// Smallest value.
    #[serde(serialize_with = "rounding::number")]
    pub low: f64,
    /// Largest value.
    #[serde(serialize_with = "rounding::number")]
    pub high: f64,
}

/// Cells along each command: 20 wide, half of what is called small and large.
const COMMAND_CELLS: usize = 10;
/// Cells along D: tenths of the range,
const DISTANCE_CELLS: usize = 10;
/// and along α: 15°, within which an echo changes little.
const ALPHA_CELLS: usize = 6;
/// Share of rows whose deviation is called jitter: beyond lie rows that are missing.
const USUAL: f64 = 0.95;

impl Holdings {
    /// Counts logs; `coarse` are the same in steps long enough for speeds.
    pub fn of(logs: &Logs, coarse: &Logs) -> Self {
        let rows = || logs.runs.iter().flat_map(|run| &run.rows);
        let count = rows().count();
        let share = |n: usize| if count > 0 { n as f64 / count as f64 } else { 0.0 };
        let times = || logs.runs.iter().flat_map(|run| run.rows.pairs()).map(|pair| pair[1].t_ms - pair[0].t_ms);
        let step_ms = median(times());
        let duration_ms = logs.runs.iter().filter_map(|run| Some(run.rows.last()?.t_ms - run.rows.first()?.t_ms));
        let motion = || samples::steps(coarse);
        let per_s = 1000.0 / coarse.robot.step_ms;
        let held = held_steps(logs);
        let faced = Faced::of(logs);
        Holdings {
            runs: logs.runs.len(),
            rows: count,
            steps: samples::steps(logs).count(),
            duration_s: duration_ms.sum::<f64>() / 1000.0,
            step_ms,
            jitter_ms: usual(times().map(|ms| (ms - step_ms).abs())),
            with_pose: share(rows().filter(|row| row.pose.is_some()).count()),
            with_reading: share(rows().filter(|row| row.echo_cm.is_some()).count()),
            left: Range::of(commands(logs).map(|[left, _]| left)),
            right: Range::of(commands(logs).map(|[_, right]| right)),
            forward_cm_s: Range::of(motion().map(|step| step.forward_cm * per_s)),
            turn_deg_s: Range::of(motion().map(|step| step.turn_rad.to_degrees() * per_s)),
            reading_cm: Range::of(rows().filter_map(|row| row.echo_cm)),
            distance_cm: faced.distance_cm,
            alpha_deg: faced.alpha_deg,
            command_coverage: covered(
                commands(logs).map(|pair| pair.map(|c| (c + 100.0) / 200.0)),
                [COMMAND_CELLS, COMMAND_CELLS],
            ),
            sensor_coverage: faced.coverage,
            witnesses: WITNESSES
                .into_iter()
                .map(|(columns, adds, is_there)| Witness {
                    columns,
                    rows: share(rows().filter(is_there).count()),
                    adds,
                })
                .collect(),
            held_steps: median(held.iter().map(|n| f64::from(*n))),
            longest_held_steps: held.into_iter().max().unwrap_or(0),
            sensors: Vec::new(),
            detectable: Vec::new(),
        }
    }
}

impl Heard {
    /// Counts the readings of logs as this sensor heard them.
    pub fn of(logs: &Logs, sensor: String) -> Self {
        let rows = || logs.runs.iter().flat_map(|run| &run.rows);
        let readings_cm = || rows().filter_map(|row| row.echo_cm);
        let faced = Faced::of(logs);
        Heard {
            sensor,
            with_reading: readings_cm().count() as f64 / rows().count().max(1) as f64,
            reading_cm: Range::of(readings_cm()),
            distance_cm: faced.distance_cm,
            alpha_deg: faced.alpha_deg,
            sensor_coverage: faced.coverage,
        }
    }
}

/// What the sensor faced in all rows with a pose.
struct Faced {
    distance_cm: Option<Range>,
    alpha_deg: Option<Range>,
    /// The share of cells up to its reach.
    coverage: f64,
}

impl Faced {
    /// In one pass: each row is a ray through the room.
    fn of(logs: &Logs) -> Self {
        let Some(Ultrasonic { max_cm, .. }) = logs.robot.ultrasonic else {
            return Faced { distance_cm: None, alpha_deg: None, coverage: 0.0 };
        };
        let (mut distance, mut alpha) = (None, None);
        let seen = samples::readings(logs).map(|s| {
            let [distance_cm, alpha_deg] = [s.distance_cm, s.alpha_deg()];
            distance = Range::wider(distance, distance_cm);
            alpha = Range::wider(alpha, alpha_deg);
            [distance_cm, alpha_deg]
        });
        let within = seen.filter(|[distance_cm, _]| *distance_cm <= max_cm);
        let shares = within.map(|[distance_cm, alpha_deg]| [distance_cm / max_cm, alpha_deg / 90.0]);
        let coverage = covered(shares, [DISTANCE_CELLS, ALPHA_CELLS]);
        Faced { distance_cm: distance, alpha_deg: alpha, coverage }
    }
}

impl Range {
    fn of(numbers: impl Iterator<Item = f64>) -> Option<Self> {
        numbers.fold(None, Range::wider)
    }

    fn wider(range: Option<Range>, number: f64) -> Option<Self> {
        let Range { low, high } = range.unwrap_or(Range { low: number, high: number });
        Some(Range { low: low.min(number), high: high.max(number) })
    }
}

/// The commands of all steps: that of a run's last row is never observed.
pub fn commands(logs: &Logs) -> impl Iterator<Item = [f64; 2]> {
    logs.runs.iter().flat_map(steps).map(|row| row.command())
}

/// All rows of a run but the last.
pub fn steps(run: &Run) -> rows::Iter<'_> {
    run.rows.between(0..run.rows.len().saturating_sub(1))
}

/// For how many steps each pair of commands is held, run by run.
fn held_steps(logs: &Logs) -> Vec<u32> {
    let mut held = Vec::new();
    for run in &logs.runs {
        let mut before = None;
        for row in steps(run) {
            match held.last_mut().filter(|_| before == Some(row.command())) {
                Some(so_far) => *so_far += 1,
                None => held.push(1),
            }
            before = Some(row.command());
        }
    }
    held
}

/// The share of cells of the unit square in which there is something.
fn covered(places: impl Iterator<Item = [f64; 2]>, cells: [usize; 2]) -> f64 {
    let cell = |share: f64, n: usize| ((share * n as f64).max(0.0) as usize).min(n - 1);
    let found: BTreeSet<[usize; 2]> = places.map(|[x, y]| [cell(x, cells[0]), cell(y, cells[1])]).collect();
    found.len() as f64 / (cells[0] * cells[1]) as f64
}

/// What all but a few of some deviations in ms stay within, in whole parts of one; NaN of none. Counted and not kept: there
/// may be millions.
fn usual(deviations_ms: impl Iterator<Item = f64>) -> f64 {
    const PARTS: f64 = 100.0;
    let mut counts: BTreeMap<u64, usize> = BTreeMap::new();
    deviations_ms.for_each(|ms| *counts.entry((PARTS * ms).round() as u64).or_default() += 1);
    let place = (USUAL * counts.values().sum::<usize>() as f64) as usize;
    let mut before = 0;
    let found = counts.iter().find(|(_, count)| {
        before += **count;
        before > place
    });
    found.or(counts.iter().next_back()).map_or(f64::NAN, |(part, _)| *part as f64 / PARTS)
}
