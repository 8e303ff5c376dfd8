//! What differs between sessions.

use maud::html;

use crate::document::{Section, open_table};
use crate::words;
use mindgap_diagnosis::diagnosis::Diagnosis;
use mindgap_diagnosis::sessions::{SessionEffect, SessionFindings};
use mindgap_models::effects::Effect;

/// Returns the section; none of a single session.
pub fn section(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> Option<Section> {
    let sessions = &diagnosis.sessions;
    if sessions.is_empty() {
        return None;
    }
    let rows: Vec<[String; 4]> = sessions.iter().flat_map(|session| rows(session, catalogue)).collect();
    let body = html! {
        @if rows.is_empty() {
            p { "No difference between the " (sessions.len()) " sessions was found." }
        } @else {
            p {
                "These effects differ between the sessions. A condition goes with a difference where sessions under the same "
                "condition agree; conditions that change together are all listed."
            }
            (open_table(["effect", "session", "strength (95 % interval)", "goes with"], &rows))
        }
    };
    Some(Section { id: "sessions", title: "What differs between sessions", body })
}

fn rows(session: &SessionFindings, catalogue: &[&'static Effect]) -> Vec<[String; 4]> {
    let row = |effect: &SessionEffect| {
        let with = if effect.goes_with.is_empty() { "no stated condition".into() } else { effect.goes_with.join(", ") };
        [words::name(effect.id, catalogue).to_owned(), session.title(), effect.strength(), with]
    };
    session.effects.iter().map(row).collect()
}
