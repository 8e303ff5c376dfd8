//! What differs between sessions of one robot, as data and as text.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

use super::strength::strength;
use mindgap_models::effects::parameter::Settings;

/// A session and what differs in it from others.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SessionFindings {
    /// Its folder, as it was given.
    pub folder: String,
    /// Its conditions, as `session.toml` states them.
    #[schemars(with = "BTreeMap<String, Value>")]
    pub conditions: Map<String, Value>,
    /// The effects that differ between the sessions, with their parameters in this one.
    pub effects: Vec<SessionEffect>,
}

/// An effect that differs between sessions, in one of them.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SessionEffect {
    /// Its id.
    pub id: &'static str,
    /// Its strength in this session, by the names in docs/reference/effects.md.
    #[schemars(with = "Settings")]
    pub parameters: Map<String, Value>,
    /// 95 % intervals of the numeric parameters.
    #[schemars(with = "BTreeMap<String, Option<[f64; 2]>>")]
    pub intervals: Map<String, Value>,
    /// Names of the conditions that go with the difference: sessions that share them have the same effect.
    pub goes_with: Vec<String>,
}

/// Returns the differences between sessions as text, line by line; none of a single one.
pub fn lines(sessions: &[SessionFindings]) -> Vec<String> {
    let Some(first) = sessions.iter().max_by_key(|session| session.effects.len()) else { return Vec::new() };
    if first.effects.is_empty() {
        return vec![format!("No difference between the {} sessions was found.", sessions.len())];
    }
    let of_effect = |differing: &SessionEffect| {
        let with = match differing.goes_with.as_slice() {
            [] => "with no stated condition".into(),
            conditions => format!("with {}", conditions.join(", ")),
        };
        let in_session = |session: &SessionFindings| {
            let effect = session.effects.iter().find(|effect| effect.id == differing.id)?;
            Some(format!("    {}: {}", session.title(), effect.strength()))
        };
        [format!("  {} goes {with}:", differing.id)].into_iter().chain(sessions.iter().filter_map(in_session)).collect()
    };
    let effects = first.effects.iter().flat_map(|effect| -> Vec<String> { of_effect(effect) });
    ["Differences between sessions:".to_string()].into_iter().chain(effects).collect()
}

impl SessionFindings {
    /// Returns its folder, with its conditions if it states any.
    pub fn title(&self) -> String {
        let word = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let conditions: Vec<String> =
            self.conditions.iter().map(|(key, value)| format!("{key} {}", word(value))).collect();
        match conditions.as_slice() {
            [] => self.folder.clone(),
            conditions => format!("{} ({})", self.folder, conditions.join(", ")),
        }
    }
}

impl SessionEffect {
    /// Describes its parameters, each number with its interval.
    pub fn strength(&self) -> String {
        strength(&self.parameters, &self.intervals, &[])
    }
}

#[cfg(test)]
mod tests;
