//! Conditions of sessions without names and texts: what may go with a difference stays the same.

use std::collections::BTreeSet;

use toml::{Table, Value};

/// Returns conditions with numbered names. Numbers and truth values stay, dates become their numbers in order, and all other values
/// are numbered, equal ones alike.
pub fn without_names<'a>(sessions: impl Iterator<Item = &'a Table> + Clone) -> Vec<Table> {
    let names: BTreeSet<&String> = sessions.clone().flat_map(Table::keys).collect();
    let digits = names.len().to_string().len();
    let mut nameless = vec![Table::new(); sessions.clone().count()];
    for (number, name) in (1..).zip(names) {
        let values = || sessions.clone().filter_map(|session| session.get(name));
        let texts: BTreeSet<String> = values().map(ToString::to_string).collect();
        let place = |value: &Value| texts.range(..value.to_string()).count() as i64 + 1;
        let shown = |value: &Value| match value {
            Value::Integer(_) | Value::Float(_) | Value::Boolean(_) => value.clone(),
            Value::Datetime(_) => place(value).into(),
            Value::String(_) | Value::Array(_) | Value::Table(_) => format!("value-{}", place(value)).into(),
        };
        for (session, nameless) in sessions.clone().zip(&mut nameless) {
            if let Some(value) = session.get(name) {
                nameless.insert(format!("condition-{number:0digits$}"), shown(value));
            }
        }
    }
    nameless
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_texts_become_numbers_and_numbers_stay() {
        let sessions: Vec<Table> = [
            "floor = 'tiles'\nload_g = 200\nwhen = 2026-11-29\nby = ['Anna']",
            "floor = 'carpet'\nload_g = 0.5\nwhen = 2026-11-27",
            "floor = 'tiles'\nwhen = 2026-11-28",
        ]
        .map(|text| toml::from_str(text).expect("conditions"))
        .into();
        let texts: Vec<String> =
            without_names(sessions.iter()).iter().map(|of| toml::to_string(of).expect("TOML")).collect();
        // In the order of the alphabet: by, floor, load_g, when.
        assert_eq!(
            texts,
            [
                "condition-1 = \"value-1\"\ncondition-2 = \"value-2\"\ncondition-3 = 200\ncondition-4 = 3\n",
                "condition-2 = \"value-1\"\ncondition-3 = 0.5\ncondition-4 = 1\n",
                "condition-2 = \"value-2\"\ncondition-4 = 2\n"
            ]
        );
    }
}
