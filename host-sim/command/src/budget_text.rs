//! The budget of a gap as a bar chart in text, so that the largest cause is seen at once.

use mindgap_diagnosis::Diagnosis;
use mindgap_diagnosis::budget::Part;
use mindgap_diagnosis::verdict::NamedEffect;
use mindgap_pages::words;

/// Width of the whole gap in characters.
const BAR: usize = 30;

/// Returns one line per part of the budget.
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

/// Returns the strength of an effect, or what another part of the budget is.
fn meaning(id: &str, effects: &[NamedEffect]) -> String {
    match effects.iter().find(|effect| effect.id == id) {
        Some(effect) => effect.strength(),
        None => words::cause(id, &[]).map_or_else(String::new, |cause| cause.what.into()),
    }
}
