//! Prints the budgets of real robots against the textbook as a table in Markdown, for docs/reference/real-robots.md:
//! `cargo run --release -p mindgap-tests --example real-budgets -- FOLDER…`, one folder of logs each.

use std::path::Path;

use mindgap_diagnosis::budget::Part;
use mindgap_diagnosis::verdict::NamedEffect;
use mindgap_diagnosis::{Diagnosis, diagnose};
use mindgap_logs::Logs;
use mindgap_models::simulator::kinematic;

fn main() -> std::process::ExitCode {
    println!("| logs | verdict | what the gap is made of, share (95 %) | closed of what can be (95 %) |");
    println!("| --- | --- | --- | --- |");
    for folder in std::env::args().skip(1) {
        let row = Logs::read(Path::new(&folder), |_| ())
            .and_then(|logs| diagnose(kinematic::baseline(&logs), &logs))
            .map(|diagnosis| row(Path::new(&folder), &diagnosis));
        match row {
            Ok(row) => println!("{row}"),
            Err(error) => {
                eprintln!("{folder}: {error}");
                return std::process::ExitCode::FAILURE;
            }
        }
    }
    std::process::ExitCode::SUCCESS
}

fn row(folder: &Path, diagnosis: &Diagnosis) -> String {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    let verdict = serde_json::to_value(diagnosis.verdict).unwrap_or_default();
    let parts: Vec<String> = diagnosis.budget.iter().map(|part| cell(part, &diagnosis.effects)).collect();
    let closed = diagnosis.reduction.as_ref().and_then(|reduction| {
        let (closed, ends) = reduction.whole.reducible_closed.zip(reduction.whole.ci95)?;
        let [low, high] = ends.map(|share| 100.0 * share);
        Some(format!("{:.0} % ({low:.0} to {high:.0})", 100.0 * closed))
    });
    let closed = closed.unwrap_or_default();
    format!("| {name} | {} | {} | {closed} |", verdict.as_str().unwrap_or_default(), parts.join("; "))
}

fn cell(part: &Part, effects: &[NamedEffect]) -> String {
    let [low, high] = part.ci95.map(|share| 100.0 * share);
    let share = format!("{:.0} % ({low:.0} to {high:.0})", 100.0 * part.share);
    let strength = effects.iter().find(|effect| effect.id == part.id).map_or(String::new(), strength);
    format!("`{}`{strength} {share}", part.id)
}

fn strength(effect: &NamedEffect) -> String {
    format!(" ({})", effect.strength())
}
