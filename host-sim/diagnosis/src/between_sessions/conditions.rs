//! Which conditions of sessions go with a difference between them.

use std::cmp::Ordering;

use serde_json::Map;
use toml::{Table, Value};

use mindgap_logs::sessions::Session;

/// An estimate with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

impl Estimate {
    /// Returns how far two estimates are from each other, in standard errors of their difference.
    pub fn errors_from(&self, other: &Estimate) -> f64 {
        let error = libm::hypot(self.error, other.error);
        let difference = (self.value - other.value).abs();
        if difference == 0.0 { 0.0 } else { difference / error }
    }
}

/// Returns the names of the conditions that go with a difference. Sessions in which such a condition is equal agree within `z`
/// standard errors. Where it is a number or a date and has at least three values, the estimates only rise with it or only fall.
/// Conditions that change together are all named: no log says which of them it is.
pub fn goes_with(estimates: &[Option<Estimate>], sessions: &[Session], z: f64) -> Vec<String> {
    let measured: Vec<(&Estimate, &Table)> = estimates
        .iter()
        .zip(sessions)
        .filter_map(|(estimate, session)| Some((estimate.as_ref()?, &session.conditions)))
        .collect();
    let Some((_, first)) = measured.first() else { return Vec::new() };
    let fits = |key: &&String| {
        let values: Option<Vec<(&Estimate, &Value)>> =
            measured.iter().map(|(estimate, conditions)| Some((*estimate, conditions.get(key.as_str())?))).collect();
        values.is_some_and(|values| varies(&values) && agrees_where_equal(&values, z) && is_one_way(&values, z))
    };
    first.keys().filter(fits).cloned().collect()
}

fn varies(values: &[(&Estimate, &Value)]) -> bool {
    values.iter().any(|(_, value)| *value != values[0].1)
}

fn agrees_where_equal(values: &[(&Estimate, &Value)], z: f64) -> bool {
    let pairs = values.iter().enumerate().flat_map(|(i, a)| values[..i].iter().map(move |b| (a, b)));
    pairs.into_iter().all(|(a, b)| a.1 != b.1 || a.0.errors_from(b.0) <= z)
}

/// Returns whether estimates do not both rise and fall with a condition that has an order.
fn is_one_way(values: &[(&Estimate, &Value)], z: f64) -> bool {
    let directions = values.iter().enumerate().flat_map(|(i, a)| values[..i].iter().map(move |b| (a, b)));
    let significant = directions.filter(|(a, b)| a.0.errors_from(b.0) > z);
    let signs: Vec<bool> = significant
        .filter_map(|(a, b)| match order(a.1, b.1)? {
            Ordering::Equal => None,
            order => Some((order == Ordering::Greater) == (a.0.value > b.0.value)),
        })
        .collect();
    signs.iter().all(|sign| *sign == signs[0])
}

/// Returns the order of two numbers or of two dates.
fn order(a: &Value, b: &Value) -> Option<Ordering> {
    let number = |value: &Value| match value {
        Value::Integer(number) => Some(*number as f64),
        Value::Float(number) => Some(*number),
        _ => None,
    };
    match (a, b) {
        // Dates of one form are ordered as their texts are.
        (Value::Datetime(a), Value::Datetime(b)) => Some(a.to_string().cmp(&b.to_string())),
        _ => number(a)?.partial_cmp(&number(b)?),
    }
}

/// Returns conditions as JSON; dates become text.
pub fn as_json(conditions: &Table) -> Map<String, serde_json::Value> {
    conditions.iter().map(|(key, value)| (key.clone(), json(value))).collect()
}

fn json(value: &Value) -> serde_json::Value {
    match value {
        Value::String(text) => text.clone().into(),
        Value::Integer(number) => (*number).into(),
        Value::Float(number) => (*number).into(),
        Value::Boolean(is) => (*is).into(),
        Value::Datetime(date) => date.to_string().into(),
        Value::Array(values) => values.iter().map(json).collect::<Vec<_>>().into(),
        Value::Table(table) => as_json(table).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sessions with an estimate of error 1 and conditions.
    fn going_with(sessions: &[(f64, &str)]) -> Vec<String> {
        let estimates: Vec<Option<Estimate>> =
            sessions.iter().map(|(value, _)| Some(Estimate { value: *value, error: 1.0 })).collect();
        let session = |(_, text): &(f64, &str)| Session {
            folder: "logs".into(),
            conditions: toml::from_str(text).expect("conditions"),
        };
        goes_with(&estimates, &sessions.iter().map(session).collect::<Vec<_>>(), 2.0)
    }

    #[test]
    fn a_condition_goes_with_a_difference_where_equal_sessions_agree() {
        let floors = [
            (0.0, "floor = 'tiles'\noperator = 'a'"),
            (9.0, "floor = 'carpet'\noperator = 'a'"),
            (0.5, "floor = 'tiles'\noperator = 'b'"),
            (9.5, "floor = 'carpet'\noperator = 'b'"),
        ];
        assert_eq!(going_with(&floors), ["floor"]);
        let both = [(0.0, "floor = 'tiles'\nload_g = 0"), (9.0, "floor = 'carpet'\nload_g = 200")];
        assert_eq!(going_with(&both), ["floor", "load_g"], "nobody knows which");
        assert!(going_with(&[(0.0, "floor = 'tiles'"), (9.0, "floor = 'tiles'")]).is_empty());
        assert!(going_with(&[(0.0, "floor = 'tiles'"), (9.0, "")]).is_empty(), "not stated everywhere");
    }

    #[test]
    fn numbers_and_dates_go_one_way() {
        let loads = |values: [f64; 3]| {
            let [a, b, c] = values;
            going_with(&[(a, "load_g = 0"), (b, "load_g = 100.0"), (c, "load_g = 200")])
        };
        assert_eq!(loads([0.0, 5.0, 10.0]), ["load_g"]);
        assert_eq!(loads([10.0, 5.0, 4.5]), ["load_g"]);
        assert!(loads([0.0, 9.0, 0.0]).is_empty());
        let dates = [(0.0, "date = 2026-11-29"), (9.0, "date = 2026-11-30"), (0.0, "date = 2026-12-01")];
        assert!(going_with(&dates).is_empty());
        let words = [(0.0, "floor = 'a'"), (9.0, "floor = 'b'"), (0.0, "floor = 'c'")];
        assert_eq!(going_with(&words), ["floor"], "words have no order");
    }

    #[test]
    fn dates_are_text_in_json() {
        let conditions: Table = toml::from_str("date = 2026-11-29\nload_g = 200\nfloor = 'tiles'").expect("TOML");
        assert_eq!(
            serde_json::Value::from(as_json(&conditions)),
            serde_json::json!({"date": "2026-11-29", "load_g": 200, "floor": "tiles"})
        );
    }
}
