//! Readings: in metres, millimetres or inches, and numbers that stand for none.

use super::finding::{Finding, Handling, Part, Place};
use super::map::{faced, fitting};
use super::ways::FEWEST;
use crate::{Logs, Row};
use mindgap_foundations::statistics::summary::median;

/// Centimetres in units that sensors' drivers use.
const UNITS: [(f64, &str); 3] = [(100.0, "metres"), (0.1, "millimetres"), (2.54, "inches")];
/// The least share of readings that fit the walls in their unit,
const LEAST_FITTING: f64 = 0.3;
/// and how many times as many that is as in centimetres. A wide beam of a real sensor fits a quarter to a half of its
/// readings to its axis, and readings in a wrong unit one in ten by chance.
const TIMES: f64 = 2.0;
/// A number beyond this is no distance that any such sensor reads, infinity included.
const ENDLESS_CM: f64 = 1e6;
/// What the sensors of NXT and EV3 say for none.
const NXT_NONE: f64 = 255.0;
/// A number beyond the range that comes this often is none by chance.
const OFTEN: usize = 3;

/// Readings in another unit are put right where they fit the walls in that unit and not in centimetres.
pub fn units(logs: &mut Logs) -> Vec<Finding> {
    let pairs: Vec<[f64; 2]> = faced(logs, |pose| *pose)
        .into_iter()
        .filter(|pair| (f64::MIN_POSITIVE..ENDLESS_CM).contains(&pair[0]))
        .collect();
    if pairs.len() < FEWEST {
        return Vec::new();
    }
    let as_is = fitting(&pairs, 1.0);
    let middle = median(pairs.iter().map(|[echo, distance_cm]| echo / distance_cm));
    let decisive = |factor: &f64| {
        let fit = fitting(&pairs, *factor);
        fit >= LEAST_FITTING && fit >= TIMES * as_is
    };
    // The median reading must say the same: within the square root of what lies between inches and centimetres.
    let near = |factor: f64| (factor * middle).max(1.0 / (factor * middle)) < libm::sqrt(2.54);
    let Some((factor, unit)) = UNITS.into_iter().find(|(factor, _)| near(*factor) && decisive(factor)) else {
        return Vec::new();
    };
    let rows = rows_where(logs, |row| row.echo_cm.is_some_and(|echo| echo < ENDLESS_CM));
    for (run, row) in &rows {
        logs.runs[*run].rows.edit(*row, |row| row.echo_cm = row.echo_cm.map(|echo| echo * factor));
    }
    vec![Finding {
        id: "echo_unit",
        places: Place::of(logs, &rows),
        handling: Handling::PutRight,
        withholds: &[],
        sentence: format!("Readings are in {unit}: write centimetres as echo_cm."),
    }]
}

/// Numbers that stand for no reading are taken out; other readings beyond the sensor's range stay.
pub fn none_numbers(logs: &mut Logs) -> Vec<Finding> {
    let max_cm = logs.robot.ultrasonic.max_cm;
    let echoes = || logs.runs.iter().flat_map(|run| &run.rows).filter_map(|row| row.echo_cm);
    let mut beyond: Vec<f64> = echoes().filter(|echo| *echo > max_cm).collect();
    beyond.sort_by(f64::total_cmp);
    let equal = beyond.chunk_by(|a, b| a == b).max_by_key(|equal| equal.len());
    // Readings that are too long scatter; a number that stands for none is nearly all of those beyond the range.
    let repeated = equal.filter(|equal| equal.len() >= OFTEN && 2 * equal.len() > beyond.len()).map(|equal| equal[0]);
    let is_none = |echo: f64| {
        let nxt = echo == NXT_NONE && echo > max_cm;
        echo == 0.0 && logs.robot.ultrasonic.min_cm > 0.0 || echo >= ENDLESS_CM || nxt || Some(echo) == repeated
    };
    let mut numbers: Vec<f64> = echoes().filter(|echo| is_none(*echo)).collect();
    let rows = rows_where(logs, |row| row.echo_cm.is_some_and(is_none));
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    if rows.is_empty() {
        return all_beyond(logs, &beyond);
    }
    rows.iter().for_each(|(run, row)| logs.runs[*run].rows.edit(*row, |row| row.echo_cm = None));
    let word = |number: &f64| if *number >= ENDLESS_CM { "inf".into() } else { number.to_string() };
    let words: Vec<String> = numbers.iter().map(word).collect();
    vec![Finding {
        id: "echo_none_number",
        places: Place::of(logs, &rows),
        handling: Handling::PutRight,
        withholds: &[],
        sentence: format!(
            "{} {} for no echo in echo_cm: leave the cell empty instead.",
            words.join(" and "),
            if words.len() == 1 { "stands" } else { "stand" }
        ),
    }]
}

/// Readings of which most lie beyond the sensor's range are in no unit that is known here.
fn all_beyond(logs: &Logs, beyond: &[f64]) -> Vec<Finding> {
    let rows = rows_where(logs, |row| row.echo_cm.is_some());
    if rows.len() < FEWEST || 2 * beyond.len() <= rows.len() {
        return Vec::new();
    }
    vec![Finding {
        id: "echo_unit",
        places: Place::of(logs, &rows),
        handling: Handling::Told,
        withholds: &[Part::Sonar],
        sentence:
            "Most readings lie beyond ultrasonic.max_cm: write echo_cm in centimetres, or mend max_cm in robot.toml."
                .into(),
    }]
}

fn rows_where(logs: &Logs, is_meant: impl Fn(&Row) -> bool) -> Vec<(usize, usize)> {
    let meant = |run: usize| {
        let rows = logs.runs[run].rows.iter().enumerate().filter(|(_, row)| is_meant(row));
        rows.map(|(row, _)| (run, row)).collect::<Vec<_>>()
    };
    (0..logs.runs.len()).flat_map(meant).collect()
}
