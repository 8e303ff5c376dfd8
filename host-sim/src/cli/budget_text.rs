//! The budget of a gap in words: one bar a line, so that one sees at once what to mend first.

use crate::gap::Diagnosis;
use crate::gap::budget::{Part, SCATTER, UNEXPLAINED};
use crate::gap::verdict::NamedEffect;

/// Width of a whole gap, characters.
const BAR: usize = 30;

/// The lines of a budget; none where there is none.
pub fn lines(diagnosis: &Diagnosis) -> Vec<String> {
    let parts = &diagnosis.budget;
    let width = parts.iter().map(|part| part.id.chars().count()).max().unwrap_or(0);
    parts.iter().map(|part| line(part, width, &diagnosis.effects)).collect()
}

fn line(part: &Part, width: usize, effects: &[NamedEffect]) -> String {
    let Part { id, share, ci95: [low, high] } = part;
    let filled = ((share * BAR as f64).round() as usize).min(BAR);
    let bar = "█".repeat(filled) + &"·".repeat(BAR - filled);
    let percent = format!("{:>3.0} % ({:.0} to {:.0})", 100.0 * share, 100.0 * low, 100.0 * high);
    format!("  {id:<width$}  {bar} {percent:<18} {}", meaning(id, effects)).trim_end().to_string()
}

fn meaning(id: &str, effects: &[NamedEffect]) -> String {
    match effects.iter().find(|effect| effect.id == id) {
        Some(effect) => effect.strength(),
        None if id == SCATTER => "steps scatter more than the simulator assumes".into(),
        None if id == UNEXPLAINED => "follows circumstances, and no named effect does so".into(),
        None => String::new(),
    }
}
