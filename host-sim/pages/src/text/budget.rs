//! The budget of a gap as a bar chart in text, so that the largest cause is seen at once.

use crate::words;
use mindgap_diagnosis::Diagnosis;
use mindgap_diagnosis::budget::Part;
use mindgap_diagnosis::scope::of_sensor;
use mindgap_diagnosis::verdict::NamedEffect;

/// Width of the whole gap in characters.
const BAR: usize = 30;

/// Returns one line per part of the budget.
pub fn lines(diagnosis: &Diagnosis) -> Vec<String> {
    let parts = &diagnosis.budget;
    let width = parts.iter().map(|part| name(part).chars().count()).max().unwrap_or(0);
    parts.iter().map(|part| line(part, width, &diagnosis.effects)).collect()
}

fn line(part: &Part, width: usize, effects: &[NamedEffect]) -> String {
    let Part { share, ci95: [low, high], .. } = part;
    let name = name(part);
    let filled = ((share * BAR as f64).round() as usize).min(BAR);
    let bar = "█".repeat(filled) + &"·".repeat(BAR - filled);
    let percent = format!("{:>3.0} % ({:.0} to {:.0})", 100.0 * share, 100.0 * low, 100.0 * high);
    format!("  {name:<width$}  {bar} {percent:<18} {}", meaning(part, effects)).trim_end().to_string()
}

fn name(part: &Part) -> String {
    of_sensor(&part.id, part.sensor.as_deref())
}

/// Returns the strength of an effect, or what another part of the budget is.
fn meaning(part: &Part, effects: &[NamedEffect]) -> String {
    match effects.iter().find(|effect| effect.id == part.id && effect.sensor == part.sensor) {
        Some(effect) => effect.strength(),
        None => words::cause(&part.id, &[]).map_or_else(String::new, |cause| cause.what.into()),
    }
}
