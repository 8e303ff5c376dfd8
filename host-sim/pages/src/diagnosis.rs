//! The page of a diagnosis: is there a gap, what is it made of, where does it lie, and what to do next.

mod causes;
mod compared;
mod places;
mod runs;

use maud::{Markup, html};

use super::document::{Document, Section, chart, table};
use super::replay::Replay;
use super::{glossary, words};
use mindgap_diagnosis::Findings;
use mindgap_diagnosis::budget::{Part, UNEXPLAINED};
use mindgap_diagnosis::diagnosis::Diagnosis;
use mindgap_diagnosis::verdict::Verdict;
use mindgap_figures::pictures;
use mindgap_figures::report::room::Room;
use mindgap_foundations::error::Result;
use mindgap_logs::Logs;
use mindgap_models::effects::Effect;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::rollout::REACHED_CM;

/// The contents of a page.
pub struct Subject<'a> {
    /// What was found.
    pub findings: &'a Findings,
    /// In these logs,
    pub logs: &'a Logs,
    /// against this simulator.
    pub baseline: &'a Baseline<'a>,
    /// Among these effects.
    pub catalogue: &'a [&'static Effect],
    /// Where both come from.
    pub source: Source,
}

/// Where a simulator and logs come from.
pub struct Source {
    /// The simulator's file, or the word for the textbook.
    pub simulator: String,
    /// The folder of logs.
    pub logs: String,
    /// First and last day on which the logs were written, if known.
    pub written: Option<[String; 2]>,
    /// Seed of the draws.
    pub seed: u64,
}

/// Share of the gap above which a cause is worth checking on the robot: less changes no controller's fate.
const WORTH_A_CHECK: f64 = 0.05;

/// Returns the page, whole in one file.
///
/// # Errors
/// When a number in it has no form in JSON.
pub fn page(subject: &Subject) -> Result<String> {
    let Subject { findings, logs, catalogue, source, .. } = subject;
    let diagnosis = &findings.diagnosis;
    let poses = logs.runs.iter().flat_map(|run| run.rows.iter().filter_map(|row| row.pose));
    let room = Room::new(&logs.scene, REACHED_CM, poses.map(|pose| pose.position_cm));
    let mut sections = Vec::new();
    if !diagnosis.budget.is_empty() {
        sections.push(Section { id: "budget", title: "What the gap is made of", body: budget(diagnosis, catalogue) });
    }
    sections.extend(causes::section(subject));
    sections.extend(places::section(findings, &room));
    sections.extend(runs::ends(diagnosis));
    let replay = runs::replay(subject, room);
    sections.push(runs::section(replay.as_ref(), diagnosis));
    sections.push(next(diagnosis, catalogue));
    sections.push(compared::section(subject));
    sections.push(glossary::section());
    Ok(Document {
        kind: "Diagnosis",
        headline: &headline(diagnosis, catalogue),
        subject: &format!("{} against {}", source.logs, source.simulator),
        lead: lead(diagnosis, catalogue, logs),
        sections,
        script: replay.as_ref().map(Replay::script).transpose()?,
    }
    .html())
}

/// The verdict, and the names of the effects.
fn headline(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> String {
    let verdict = words::verdict(diagnosis.verdict);
    let names: Vec<&str> = diagnosis.effects.iter().map(|effect| words::name(effect.id, catalogue)).collect();
    match names.as_slice() {
        [] => verdict.into(),
        [name] => format!("{verdict} The effect: {name}."),
        names => format!("{verdict} The effects: {}.", words::list(names)),
    }
}

/// How probable each named effect is, in words.
fn sure(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> String {
    let named: Vec<String> = diagnosis
        .effects
        .iter()
        .map(|effect| format!("{} {}", words::name(effect.id, catalogue), words::percent(effect.probability)))
        .collect();
    words::list(&named.iter().map(String::as_str).collect::<Vec<_>>())
}

fn lead(diagnosis: &Diagnosis, catalogue: &[&'static Effect], logs: &Logs) -> Markup {
    let compared: Vec<&str> = diagnosis.scope.compared.iter().map(|channel| words::channel(*channel)).collect();
    let rows: usize = logs.runs.iter().map(|run| run.rows.len()).sum();
    html! {
        @if let Some(astray) = runs::astray(diagnosis) { p { (astray) } }
        @if let (Some(reduction), false) = (diagnosis.reduction.as_ref(), diagnosis.effects.is_empty()) {
            @let [low, high] = reduction.whole.ci95.map(words::percent);
            p {
                "With " @if diagnosis.effects.len() == 1 { "it" } @else { "them" } " the simulator closes "
                strong { (words::percent(reduction.whole.reducible_closed)) }
                " of the gap, apart from chance (95 % interval: " (low) " to " (high) "). "
                "Probabilities: " (sure(diagnosis, catalogue)) "."
            }
        }
        @if diagnosis.verdict != Verdict::NoGap { p { "See " a href="#next" { "what to do next" } "." } }
        p.quiet {
            "Compared: " (words::list(&compared)) " in " (rows) " rows of " (logs.runs.len())
            @if logs.runs.len() == 1 { " run." } @else { " runs." }
        }
        @for missing in diagnosis.scope.not_compared.chunk_by(|a, b| a.reason == b.reason) {
            @let channels: Vec<&str> = missing.iter().map(|one| words::channel(one.channel)).collect();
            p.bad { "Not compared: " (words::list(&channels)) ". " (missing[0].reason) }
        }
    }
}

fn budget(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> Markup {
    let parts = &diagnosis.budget;
    let said: Vec<String> = parts
        .iter()
        .map(|part| format!("{} {}", words::name(&part.id, catalogue), words::percent(part.share)))
        .collect();
    let rows: Vec<[String; 2]> = parts
        .iter()
        .map(|part| [words::name(&part.id, catalogue).into(), words::percent_within(part.share, part.ci95)])
        .collect();
    let drawn = pictures::budget(diagnosis, |id| words::name(id, catalogue)).draw();
    html! {
        (chart("budget", &drawn, &format!("Shares of the gap: {}", said.join(", ")), html! {
            "The share of the gap that each cause explains: repair the longest bar first. The thin lines are 95 % intervals. "
            "Scatter follows no rule; unexplained is what follows rules that no named effect describes."
        }))
        (table("The same in numbers", ["part of the gap", "share (95 % interval)"], &rows))
    }
}

/// What to do now.
fn next(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> Section {
    let mut parts: Vec<&Part> = diagnosis.budget.iter().filter(|part| part.share >= WORTH_A_CHECK).collect();
    parts.sort_by(|a, b| b.share.total_cmp(&a.share));
    let is_left = |part: &&Part| part.id == UNEXPLAINED;
    let left = parts.iter().copied().find(is_left);
    parts.retain(|part| !is_left(part));
    let body = html! {
        ol {
            @for part in parts {
                @if let Some(cause) = words::cause(&part.id, catalogue) {
                    li { "Check " strong { (cause.name) } ", " (words::percent(part.share))
                        " of the gap: " (cause.check) }
                }
            }
            @if !diagnosis.effects.is_empty() {
                li {
                    "Repair the robot and log it again; or improve the simulator: the same command with "
                    code { "--apply better.json" } " writes a simulator with the effects, in which to evolve controllers."
                }
            }
            @if let Some(experiment) = diagnosis.experiment.as_ref() {
                @let [one, other] = experiment.between.map(|id| words::name(id, catalogue));
                li {
                    "These logs do not distinguish " (one) " from " (other) " for certain. Drive and log " (experiment.runs)
                    @if experiment.runs == 1 { " run" } @else { " runs" } " of " (experiment.script) "; "
                    code { "--next-experiment next.csv" } " writes the commands."
                }
            }
            @if left.is_some() || diagnosis.verdict == Verdict::Unknown {
                li {
                    @if let Some(left) = left { (words::percent(left.share)) " of the gap is not explained. " }
                    "See " a href="#where" { "where it lies" } ", watch the robot there, and state what you suspect as an "
                    "effect of your own: with " code { "--effects FILE" } " it competes with the built-in ones."
                }
            }
            @if diagnosis.verdict == Verdict::NoGap {
                li { "By these logs, nothing needs repair. If a controller fails all the same, it drives under other conditions: log "
                    "those runs and diagnose them." }
            }
            @if !diagnosis.untestable.is_empty() {
                li {
                    "These effects cannot be ruled out, because the logs do not excite them: "
                    (words::list(&diagnosis.untestable.iter().map(|id| words::name(id, catalogue)).collect::<Vec<_>>()))
                    ". Drive more varied commands if you suspect one."
                }
            }
        }
    };
    Section { id: "next", title: "What to do next", body }
}

#[cfg(test)]
mod tests;
