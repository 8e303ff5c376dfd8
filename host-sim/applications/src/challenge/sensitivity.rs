//! Sensitivity of the diagnosis to its thresholds: each halved and doubled, on cases with known effects.

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::bench::Bench;
use super::cases::{Case, Size};
use mindgap_diagnosis::Method;
use mindgap_diagnosis::calibration::Calibration;
use mindgap_diagnosis::confirm::Confirmed;
use mindgap_diagnosis::diagnose::confirmed;
use mindgap_diagnosis::verdict::{Conclusion, Verdict};
use mindgap_foundations::counter::Counter;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::{self, Executor};

/// The results of all cases with one threshold changed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the threshold in calibration.toml; empty for the unchanged calibration.
    pub threshold: String,
    /// Value of the threshold.
    pub value: f64,
    /// Cases without an effect in which a gap is detected.
    pub false_alarms: usize,
    /// Cases with known effects in which the most probable named effect is true.
    pub named: usize,
    /// Cases with known effects that are called unknown.
    pub false_unknowns: usize,
    /// Cases with unknown effects that are called unknown or partly known.
    pub unknowns: usize,
    /// Cases in which the most probable named effect is false.
    pub wrong: usize,
}

/// The outcome of a case, as counted by [`Row`].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Ending {
    false_alarm: bool,
    named: bool,
    false_unknown: bool,
    unknown: bool,
    wrong: bool,
}

/// Factors by which a threshold is multiplied.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// Returns the sensitivity table for `count` cases. `watch` is called with the number of finished cases and the total.
///
/// # Errors
/// If a case cannot be recorded.
pub fn sensitivity(
    executor: &dyn Executor,
    cases: usize,
    seed: u64,
    watch: impl Fn(usize, usize) + Sync,
) -> Result<Vec<Row>> {
    let bench = Bench::new(executor, cases, seed, Size::USUAL)?;
    let shipped = Calibration::shipped();
    let thresholds = names(&table(&shipped)?, "");
    let mut changed = vec![(String::new(), 0.0, shipped)];
    for name in &thresholds {
        for factor in FACTORS {
            changed
                .extend(with(&shipped, name, factor)?.map(|(value, calibration)| (name.clone(), value, calibration)));
        }
    }
    let calibrations: Vec<Calibration> = changed.iter().map(|(_, _, calibration)| *calibration).collect();
    let counter = Counter::new(cases, watch);
    let counted = |number| of_case(&bench, number, &calibrations).inspect(|_| counter.increment());
    let by_case = executor::map(executor, cases, counted)?;
    let row = |(place, (threshold, value, _)): (usize, (String, f64, Calibration))| {
        let count = |is: fn(&Ending) -> bool| by_case.iter().filter(|endings| is(&endings[place])).count();
        Row {
            threshold,
            value,
            false_alarms: count(|case| case.false_alarm),
            named: count(|case| case.named),
            false_unknowns: count(|case| case.false_unknown),
            unknowns: count(|case| case.unknown),
            wrong: count(|case| case.wrong),
        }
    };
    Ok(changed.into_iter().enumerate().map(row).collect())
}

/// Returns the outcome of a case with each calibration.
fn of_case(bench: &Bench, number: usize, calibrations: &[Calibration]) -> Result<Vec<Ending>> {
    let (case, baseline) = bench.case(number)?;
    let trained_on = baseline.trained_on();
    // Most thresholds of the verdict do not affect the search.
    let mut searched: Vec<Calibration> = Vec::new();
    for calibration in calibrations.iter().map(Calibration::for_search) {
        if !searched.contains(&calibration) {
            searched.push(calibration);
        }
    }
    let found = confirmed(baseline, &case.logs, &searched, |found, _, _| found)?;
    let of = |calibration: &Calibration| {
        let place = searched.iter().position(|searched| *searched == calibration.for_search())?;
        Some(judged(&case, trained_on, &found[place], calibration))
    };
    Ok(calibrations.iter().filter_map(of).collect())
}

/// Returns the outcome of a case with these confirmed effects, under a calibration.
fn judged(case: &Case, trained_on: Option<f64>, found: &Confirmed, calibration: &Calibration) -> Ending {
    let method = Method { calibration: *calibration, ..Method::default() };
    let rows = found.chosen.scores.rows().len();
    let calibration = method.calibration_for(rows, trained_on);
    let Conclusion { verdict, effects } = Conclusion::of(found, &case.logs.robot, &calibration);
    let in_table = case.effects.iter().all(|active| active.effect.in_table());
    let (is_null, is_unknown) = (case.effects.is_empty(), verdict == Verdict::Unknown);
    let first = effects.first().map(|effect| effect.id);
    let is_there = first.is_some_and(|id| case.effects.iter().any(|active| active.effect.id() == id));
    Ending {
        false_alarm: is_null && verdict != Verdict::NoGap,
        named: in_table && is_there,
        false_unknown: !is_null && in_table && is_unknown,
        unknown: !in_table && matches!(verdict, Verdict::Unknown | Verdict::PartlyKnown),
        wrong: first.is_some() && !is_there,
    }
}

fn table(calibration: &Calibration) -> Result<Table> {
    Table::try_from(calibration).map_err(|e| Error::new(format!("the calibration cannot be written: {e}")))
}

/// Returns the dotted names of all numbers in a table.
fn names(table: &Table, within: &str) -> Vec<String> {
    let of = |(key, value): (&String, &Value)| match value {
        Value::Table(inner) => names(inner, &format!("{within}{key}.")),
        _ => vec![format!("{within}{key}")],
    };
    table.iter().flat_map(of).collect()
}

/// Returns the calibration with one threshold multiplied, and its value; `None` if that changes nothing or is invalid.
fn with(shipped: &Calibration, name: &str, factor: f64) -> Result<Option<(f64, Calibration)>> {
    let mut changed = table(shipped)?;
    let (path, key) = name.rsplit_once('.').map_or((None, name), |(path, key)| (Some(path), key));
    let holder = match path {
        Some(path) => changed.get_mut(path).and_then(Value::as_table_mut),
        None => Some(&mut changed),
    };
    let Some(value) = holder.and_then(|holder| holder.get_mut(key)) else { return Ok(None) };
    let number = match value {
        Value::Integer(count) => {
            let other = (*count as f64 * factor).round();
            *count = other as i64;
            other
        }
        Value::Float(number) => {
            *number *= factor;
            *number
        }
        _ => return Ok(None),
    };
    Ok(changed.try_into().ok().filter(|calibration| calibration != shipped).map(|calibration| (number, calibration)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_threshold_can_be_changed_by_name() {
        let shipped = Calibration::shipped();
        let names = names(&table(&shipped).unwrap(), "");
        assert!(["effect_nats", "judgement.rival_z"].iter().all(|name| names.iter().any(|n| n == name)), "{names:?}");
        for name in &names {
            let (value, changed) = with(&shipped, name, 2.0).unwrap().expect(name);
            assert!(value > 0.0 && changed != shipped, "{name}");
        }
        let (_, surer) = with(&shipped, "temperature", 2.0).unwrap().unwrap();
        let (_, stricter) = with(&shipped, "effect_nats", 2.0).unwrap().unwrap();
        assert!(surer.for_search() == shipped.for_search() && stricter.for_search() != shipped.for_search());
    }
}
