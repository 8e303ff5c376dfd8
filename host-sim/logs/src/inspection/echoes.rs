//! Checks readings: wrong units, and numbers that stand for no echo.

use super::finding::{Finding, Handling, Part, RunRows};
use super::map::{fitting_fraction, ranges_along_axis};
use super::segments::MIN_SAMPLES;
use crate::{Logs, Row, Ultrasonic};
use mindgap_foundations::statistics::summary::median;

/// Centimetres per unit, for units that sensor drivers use.
const UNITS: [(f64, &str); 3] = [(100.0, "metres"), (0.1, "millimetres"), (2.54, "inches")];
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
    let is_no_echo = |echo: f64| {
        let is_nxt_no_echo = echo == NXT_NO_ECHO && echo > max_cm;
        echo == 0.0 && min_cm > 0.0 || echo >= UNBOUNDED_CM || is_nxt_no_echo || Some(echo) == repeated
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
        sentence:
            "Most readings exceed ultrasonic.max_cm: write echo_cm in centimetres, or correct max_cm in robot.toml."
                .into(),
    }]
}

fn rows_where(logs: &Logs, matches: impl Fn(&Row) -> bool) -> Vec<(usize, usize)> {
    let matching = |run: usize| {
        let rows = logs.runs[run].rows.iter().enumerate().filter(|(_, row)| matches(row));
        rows.map(|(row, _)| (run, row)).collect::<Vec<_>>()
    };
    (0..logs.runs.len()).flat_map(matching).collect()
}
