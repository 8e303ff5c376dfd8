//! The defects of logs, and where they are.

use maud::{Markup, html};

use super::drawn::is_marked;
use crate::document::Section;
use crate::words::{count, list};
use mindgap_diagnosis::survey::Survey;
use mindgap_logs::Logs;
use mindgap_logs::inspection::{Finding, RunRows};

/// Runs that are named for each defect.
const MOST_RUNS: usize = 8;
/// Ranges of lines that are named for each run.
const MOST_RANGES: usize = 8;

/// The section; `None` without defects.
pub fn section(survey: &Survey, logged: &Logs) -> Option<Section> {
    if survey.findings.is_empty() {
        return None;
    }
    let body = html! {
        @for found in &survey.findings { (defect(found, logged)) }
        p.quiet { code { "mindgap explain ID" } " says more about each of them. The first line of a file is its header." }
    };
    Some(Section { id: "defects", title: "Defects", body })
}

fn defect(found: &Finding, logged: &Logs) -> Markup {
    let (rows, all) = (found.rows(), logged.rows());
    html! {
        h3 { (found.id) ", " (found.handling.word()) }
        p { (found.sentence) }
        @if rows == all {
            p { "It concerns all rows." }
        } @else {
            p { "It concerns " (count(rows, "row")) " in " (count(found.rows_by_run.len(), "run")) ":" }
            ul {
                @for of in found.rows_by_run.iter().take(MOST_RUNS) { li { (place(of, logged)) } }
                @if found.rows_by_run.len() > MOST_RUNS { li { "and " (found.rows_by_run.len() - MOST_RUNS) " more runs" } }
            }
        }
        @if !is_marked(rows, logged) { p.quiet { "Charts do not mark what concerns most rows." } }
    }
}

/// Returns a run with the lines of its file that are concerned.
fn place(of: &RunRows, logged: &Logs) -> String {
    let is_whole = |run: &mindgap_logs::Run| run.name == of.run && run.rows.len() == of.rows.len();
    if logged.runs.iter().any(is_whole) {
        return format!("{}: all rows", of.run);
    }
    let lines = of.lines();
    let range = |[first, last]: &[usize; 2]| {
        if first == last { first.to_string() } else { format!("{first} to {last}") }
    };
    let mut shown: Vec<String> = lines.iter().take(MOST_RANGES).map(range).collect();
    if lines.len() > MOST_RANGES {
        shown.push(format!("{} more places", lines.len() - MOST_RANGES));
    }
    let word = if of.rows.len() == 1 { "line" } else { "lines" };
    format!("{}: {word} {}", of.run, list(&shown.iter().map(String::as_str).collect::<Vec<_>>()))
}
