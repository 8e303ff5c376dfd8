//! Checks readings: wrong units, and numbers that stand for no echo.

use super::finding::{Finding, Handling, Part, RunRows};
use super::map::{fitting_fraction, ranges_along_axis};
use super::segments::MIN_SAMPLES;
use crate::{Logs, Row, Ultrasonic};
use mindgap_foundations::geometry::{Pose, cast};
use mindgap_foundations::statistics::summary::median;

/// Centimetres per unit, for units that sensor drivers use. Sound takes 58.3 us for a centimetre, there and back.
const UNITS: [(f64, &str); 4] =
    [(100.0, "metres"), (0.1, "millimetres"), (2.54, "inches"), (1.0 / 58.3, "microseconds of the echo")];
/// Minimum fraction of readings that fit the walls in their true unit.
const MIN_FITTING: f64 = 0.3;
/// That fraction must exceed the one in centimetres by this factor. With its wide beam, a real sensor fits a quarter to half
/// of its readings along the axis; readings in a wrong unit fit one time in ten by chance.
const MIN_FITTING_RATIO: f64 = 2.0;
/// Numbers from here on, including infinity, are not distances that any such sensor reads.
const UNBOUNDED_CM: f64 = 1e6;
/// The NXT and EV3 sensors report this number for no echo.
const NXT_NO_ECHO: f64 = 255.0;
/// A number beyond the sensor's range that occurs this often stands for no echo.
const MIN_REPEATS: usize = 3;

/// One number may stand for no echo within the sensor's range if at most this fraction of rows has no reading,
const MAX_EMPTY: f64 = 0.02;
/// and it makes up at least this fraction of the readings.
const MIN_NONE_FRACTION: f64 = 0.08;
/// Other readings stay below this fraction of a number that stands for no echo, or above its inverse;
const FAR_BELOW: f64 = 0.85;
/// or walls are nearer than the number in at least this fraction of its rows.
const MIN_NEARER: f64 = 0.3;
/// The end of the sensor's range, as a fraction of it.
const END_OF_RANGE: f64 = 0.98;
/// Readings at places closer than this, cm or rad, are of one place, where they may repeat.
const PLACE_CM: f64 = 1.0;
const PLACE_RAD: f64 = 0.03;
/// At most this fraction of other readings lies beyond a number that counts as the largest.
const BEYOND: f64 = 0.01;

/// The largest reading, if it repeats exactly at many places.
pub struct Repeated {
    /// The reading, cm.
    pub cm: f64,
    /// Its rows, as pairs of run and row index.
    pub rows: Vec<(usize, usize)>,
    /// Fraction of these rows in which the wall ahead is farther away than the reading; `None` if too few face a wall.
    pub farther: Option<f64>,
}

impl Repeated {
    /// Returns the largest reading within the sensor's range, if it makes up at least a fraction of the readings.
    pub fn largest(logs: &Logs, min_fraction: f64) -> Option<Self> {
        let max_cm = logs.robot.ultrasonic?.max_cm;
        let within = |row: &Row| row.echo_cm.filter(|echo| *echo <= max_cm);
        let mut readings: Vec<f64> =
            logs.runs.iter().flat_map(|run| &run.rows).filter_map(|row| within(&row)).collect();
        readings.sort_by(f64::total_cmp);
        let equal = readings.chunk_by(|a, b| a == b).max_by_key(|equal| equal.len())?;
        let cm = equal[0];
        let beyond = readings.iter().filter(|echo| **echo > cm).count() as f64;
        let others = (readings.len() - equal.len()) as f64;
        let is_frequent = equal.len() as f64 >= min_fraction * readings.len() as f64;
        if !is_frequent || beyond > BEYOND * others {
            return None;
        }
        let rows = rows_where(logs, |row| row.echo_cm == Some(cm));
        let places = places(logs, &rows);
        (places >= MIN_SAMPLES).then(|| {
            let distances_cm = distances_cm(logs, &rows);
            let farther = distances_cm.iter().filter(|distance_cm| **distance_cm > cm + margin_cm(cm)).count() as f64;
            let farther = (distances_cm.len() >= MIN_SAMPLES).then(|| farther / distances_cm.len() as f64);
            Repeated { cm, rows, farther }
        })
    }

    /// Returns whether it stands for no echo: it comes at the end of the range, or nothing comes close to it, or walls are nearer.
    fn is_no_echo(&self, logs: &Logs) -> bool {
        let Some(sensor) = logs.robot.ultrasonic else { return false };
        let others =
            || logs.runs.iter().flat_map(|run| &run.rows).filter_map(|row| row.echo_cm).filter(|cm| *cm < self.cm);
        let (all, close) = (others().count() as f64, others().filter(|cm| *cm > FAR_BELOW * self.cm).count() as f64);
        let nearer = || {
            let distances_cm = distances_cm(logs, &self.rows);
            let nearer = distances_cm.iter().filter(|distance_cm| **distance_cm < self.cm - margin_cm(self.cm)).count();
            distances_cm.len() >= MIN_SAMPLES && nearer as f64 >= MIN_NEARER * distances_cm.len() as f64
        };
        self.cm >= END_OF_RANGE * sensor.max_cm || close <= BEYOND * all || nearer()
    }
}

/// Returns how far a wall may be from a reading of it.
fn margin_cm(cm: f64) -> f64 {
    (0.1 * cm).max(10.0)
}

/// Returns the number of different places among rows.
fn places(logs: &Logs, rows: &[(usize, usize)]) -> usize {
    let poses = rows.iter().filter_map(|(run, row)| logs.runs[*run].rows.at(*row).pose);
    let mut last: Option<Pose> = None;
    poses
        .filter(|pose| {
            let is_new = last.is_none_or(|last| {
                let change = last.relative(pose);
                change.position_cm.length() > PLACE_CM || change.heading_rad.abs() > PLACE_RAD
            });
            if is_new {
                last = Some(*pose);
            }
            is_new
        })
        .count()
}

/// Returns the distances along the sensor's axis at rows that face a wall, cm.
fn distances_cm(logs: &Logs, rows: &[(usize, usize)]) -> Vec<f64> {
    let sides = logs.scene.sides();
    let distance = |(run, row): &(usize, usize)| {
        let sensor = logs.robot.sensor_pose(&logs.runs[*run].rows.at(*row).pose?);
        Some(cast(&sides, sensor.position_cm, sensor.direction())?.distance_cm)
    };
    rows.iter().filter_map(distance).collect()
}

/// Converts readings that fit the walls in another unit and not in centimetres.
pub fn units(logs: &mut Logs) -> Vec<Finding> {
    let pairs: Vec<[f64; 2]> = ranges_along_axis(logs, |pose| *pose)
        .into_iter()
        .filter(|pair| (f64::MIN_POSITIVE..UNBOUNDED_CM).contains(&pair[0]))
        .collect();
    if pairs.len() < MIN_SAMPLES {
        return Vec::new();
    }
    let in_cm = fitting_fraction(&pairs, 1.0);
    let ratio = median(pairs.iter().map(|[echo, distance_cm]| echo / distance_cm));
    let is_decisive = |factor: &f64| {
        let fit = fitting_fraction(&pairs, *factor);
        fit >= MIN_FITTING && fit >= MIN_FITTING_RATIO * in_cm
    };
    // The median ratio must agree too: within the square root of the factor between inches and centimetres.
    let is_near = |factor: f64| (factor * ratio).max(1.0 / (factor * ratio)) < libm::sqrt(2.54);
    let Some((factor, unit)) = UNITS.into_iter().find(|(factor, _)| is_near(*factor) && is_decisive(factor)) else {
        return Vec::new();
    };
    let rows = rows_where(logs, |row| row.echo_cm.is_some_and(|echo| echo < UNBOUNDED_CM));
    for (run, row) in &rows {
        logs.runs[*run].rows.edit(*row, |row| row.echo_cm = row.echo_cm.map(|echo| echo * factor));
    }
    vec![Finding {
        id: "echo_unit",
        rows_by_run: RunRows::group(logs, &rows),
        handling: Handling::Corrected,
        withholds: &[],
        sentence: format!("Readings are in {unit}: write echo_cm in centimetres."),
    }]
}

/// Removes numbers that stand for no echo; other readings beyond the sensor's range stay.
pub fn no_echo_numbers(logs: &mut Logs) -> Vec<Finding> {
    let Some(Ultrasonic { min_cm, max_cm, .. }) = logs.robot.ultrasonic else { return Vec::new() };
    let echoes = || logs.runs.iter().flat_map(|run| &run.rows).filter_map(|row| row.echo_cm);
    let mut beyond: Vec<f64> = echoes().filter(|echo| *echo > max_cm).collect();
    beyond.sort_by(f64::total_cmp);
    let equal = beyond.chunk_by(|a, b| a == b).max_by_key(|equal| equal.len());
    // Readings beyond the range scatter, unless one number stands for no echo and makes up most of them.
    let repeated =
        equal.filter(|equal| equal.len() >= MIN_REPEATS && 2 * equal.len() > beyond.len()).map(|equal| equal[0]);
    let within = no_echo_within_range(logs);
    let is_no_echo = |echo: f64| {
        let is_nxt_no_echo = echo == NXT_NO_ECHO && echo > max_cm;
        let is_repeated = Some(echo) == repeated || Some(echo) == within;
        echo == 0.0 && min_cm > 0.0 || echo >= UNBOUNDED_CM || is_nxt_no_echo || is_repeated
    };
    let mut numbers: Vec<f64> = echoes().filter(|echo| is_no_echo(*echo)).collect();
    let rows = rows_where(logs, |row| row.echo_cm.is_some_and(is_no_echo));
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    if rows.is_empty() {
        return mostly_beyond_range(logs, &beyond);
    }
    rows.iter().for_each(|(run, row)| logs.runs[*run].rows.edit(*row, |row| row.echo_cm = None));
    let word = |number: &f64| if *number >= UNBOUNDED_CM { "inf".into() } else { number.to_string() };
    let words: Vec<String> = numbers.iter().map(word).collect();
    vec![Finding {
        id: "echo_none_number",
        rows_by_run: RunRows::group(logs, &rows),
        handling: Handling::Corrected,
        withholds: &[],
        sentence: format!(
            "{} in echo_cm {} no echo: leave the cell empty instead.",
            words.join(" and "),
            if words.len() == 1 { "means" } else { "mean" }
        ),
    }]
}

/// Returns the number within the sensor's range that stands for no echo, if there is one.
fn no_echo_within_range(logs: &Logs) -> Option<f64> {
    let rows = logs.rows() as f64;
    let empty = logs.runs.iter().flat_map(|run| &run.rows).filter(|row| row.echo_cm.is_none()).count() as f64;
    let repeated = Repeated::largest(logs, MIN_NONE_FRACTION).filter(|_| empty <= MAX_EMPTY * rows)?;
    // A number that makes up nearly all readings is of a stuck sensor.
    (2 * repeated.rows.len() < logs.rows() && repeated.is_no_echo(logs)).then_some(repeated.cm)
}

/// Reports readings mostly beyond the sensor's range, whose unit is unknown.
fn mostly_beyond_range(logs: &Logs, beyond: &[f64]) -> Vec<Finding> {
    let rows = rows_where(logs, |row| row.echo_cm.is_some());
    if rows.len() < MIN_SAMPLES || 2 * beyond.len() <= rows.len() {
        return Vec::new();
    }
    vec![Finding {
        id: "echo_unit",
        rows_by_run: RunRows::group(logs, &rows),
        handling: Handling::Reported,
        withholds: &[Part::Sonar],
        sentence: "Most readings exceed ultrasonic.max_cm: write echo_cm in centimetres (microseconds of the echo divided by 58.3), \
                   or correct max_cm in robot.toml."
            .into(),
    }]
}

/// Returns the matching rows as pairs of run and row index.
pub fn rows_where(logs: &Logs, matches: impl Fn(&Row) -> bool) -> Vec<(usize, usize)> {
    let matching = |run: usize| {
        let rows = logs.runs[run].rows.iter().enumerate().filter(|(_, row)| matches(row));
        rows.map(|(row, _)| (run, row)).collect::<Vec<_>>()
    };
    (0..logs.runs.len()).flat_map(matching).collect()
}
