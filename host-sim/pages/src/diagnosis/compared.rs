//! What was compared, what was wrong with the logs, and what limits the answer.

use maud::html;

use super::{Source, Subject};
use crate::document::Section;

/// The section.
pub fn section(subject: &Subject) -> Section {
    let Subject { findings, logs, catalogue, source, .. } = subject;
    let Source { simulator, logs: folder, written, seed } = source;
    let diagnosis = &findings.diagnosis;
    let rows: usize = logs.runs.iter().map(|run| run.rows.len()).sum();
    let tracked = logs.runs.iter().flat_map(|run| &run.rows).filter(|row| row.pose.is_some()).count();
    let heard = logs.runs.iter().flat_map(|run| &run.rows).filter(|row| row.echo_cm.is_some()).count();
    let body = html! {
        dl {
            dt { "Simulator" } dd { (simulator) }
            dt { "Logs" } dd { (folder) }
            dt { "Runs" } dd { (logs.runs.len()) }
            dt { "Rows" } dd { (rows) ", " (tracked) " of them with a pose and " (heard) " with a reading, "
                (logs.robot.step_ms) " ms apart" }
            @if let Some([first, last]) = written {
                dt { "Logs written" } dd { (first) @if first != last { " to " (last) } }
            }
            dt { "Program" } dd { "mindgap " (env!("CARGO_PKG_VERSION")) ", seed " (seed) ", " (catalogue.len())
            " effects" }
        }
        @if !diagnosis.data.is_empty() {
            h3 { "What was wrong with the logs" }
            ul { @for found in &diagnosis.data { li { (found.line()) } } }
        }
        // The reasons for channels that are not compared are at the top of the page.
        @let is_shown = |note: &String| diagnosis.scope.not_compared.iter().any(|missing| missing.reason == *note);
        @let notes: Vec<&String> = diagnosis.notes.iter().filter(|note| !is_shown(note)).collect();
        @if !notes.is_empty() {
            h3 { "What else limits this answer" }
            ul { @for note in notes { li { (note) } } }
        }
    };
    Section { id: "compared", title: "What was compared", body }
}
