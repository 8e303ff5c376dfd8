//! The page of logs at a glance: where the robot drove, how fast, what its sensor read, which defects the logs have and where, what
//! they hold, and which effects they can identify.

mod contents;
mod defects;
mod drawn;
mod identified;
mod over_time;
mod paths;
mod readings;

use maud::{Markup, html};

use self::drawn::Drawn;
use super::document::{Document, Section};
use super::words::count;
use mindgap_diagnosis::survey::Survey;
use mindgap_logs::Logs;

/// The contents of a page.
pub struct Subject<'a> {
    /// What there is to say about the logs.
    pub survey: &'a Survey,
    /// The logs as they were recorded,
    pub logged: &'a Logs,
    /// and with what can be corrected corrected.
    pub corrected: &'a Logs,
    /// Their folder.
    pub folder: &'a str,
    /// What was noticed when they were read, one line each.
    pub notes: &'a [String],
}

/// Returns the page, whole in one file.
pub fn page(subject: &Subject) -> String {
    let Subject { survey, logged, corrected, folder, .. } = subject;
    let runs = Drawn::all(survey, logged, corrected);
    let mut sections: Vec<Section> = defects::section(survey, logged).into_iter().collect();
    sections.push(paths::section(&runs, corrected));
    sections.push(over_time::section(&runs, corrected));
    sections.extend(readings::section(&runs, corrected));
    sections.push(contents::section(survey));
    sections.push(identified::section(survey));
    Document { kind: "Logs", headline: &headline(survey), subject: folder, lead: lead(subject), sections, script: None }
        .html()
}

/// Amount and soundness of the logs in one sentence.
fn headline(survey: &Survey) -> String {
    let minutes = survey.holds.duration_s / 60.0;
    let defects = match survey.findings.len() {
        0 => "no defects found".into(),
        defects => count(defects, "defect"),
    };
    let usable = if survey.refused.is_some() { ", to be fixed before the logs can be used" } else { "" };
    format!("{} over {minutes:.1} minutes: {defects}{usable}.", count(survey.holds.runs, "run"))
}

fn lead(Subject { survey, notes, .. }: &Subject) -> Markup {
    html! {
        @if let Some(refused) = &survey.refused { p.bad { "Training and evaluation refuse these logs: " (refused) } }
        @for note in *notes { p.bad { (note) } }
        p.quiet {
            "Charts show the logs as they are used: with corrections applied, and without what is excluded. Lengths are in "
            "centimetres, angles in degrees and times in seconds."
        }
    }
}

#[cfg(test)]
mod tests;
