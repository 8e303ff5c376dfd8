//! The page of a diagnosis: is there a gap, what is it made of, where does it lie, and what to do next.

mod causes;
mod compared;
pub mod comparison;
mod places;
mod runs;
mod sessions;
mod speeds;

use maud::{Markup, html};
use serde_json::Map;

use self::comparison::Comparison;
use super::document::{Document, Section, chart, table};
use super::replay::Replay;
use super::{glossary, words};
use mindgap_diagnosis::Findings;
use mindgap_diagnosis::budget::{Part, UNEXPLAINED};
use mindgap_diagnosis::diagnosis::Diagnosis;
use mindgap_diagnosis::ruler::by_ruler;
use mindgap_diagnosis::scope::of_sensor;
use mindgap_diagnosis::verdict::Verdict;
use mindgap_figures::pictures;
use mindgap_figures::report::room::Room;
use mindgap_foundations::error::Result;
use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_logs::{Logs, Robot};
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
    /// What was written into model files, and runs of both sides.
    pub comparison: Comparison<'a>,
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
    let mut sections = Vec::from_iter(speeds::section(subject));
    if !diagnosis.budget.is_empty() {
        sections.push(Section { id: "budget", title: "What the gap is made of", body: budget(diagnosis, catalogue) });
    }
    sections.extend(causes::section(subject));
    sections.extend(comparison::sections(&subject.comparison));
    sections.extend(sessions::section(diagnosis, catalogue));
    sections.extend(places::section(findings, &room));
    sections.extend(runs::ends(diagnosis));
    let replay = runs::replay(subject, room);
    sections.push(runs::section(replay.as_ref(), diagnosis));
    sections.push(next(diagnosis, catalogue));
    sections.push(compared::section(subject));
    sections.push(glossary::section());
    Ok(Document {
        kind: "Diagnosis",
        headline: &headline(diagnosis, catalogue, &logs.robot),
        subject: &format!("{} against {}", source.logs, source.simulator),
        lead: lead(diagnosis, catalogue, logs),
        sections,
        script: replay.as_ref().map(Replay::script).transpose()?,
    }
    .html())
}

/// The verdict, and each effect with its side and size where a ruler would show them, and its probability.
fn headline(diagnosis: &Diagnosis, catalogue: &[&'static Effect], robot: &Robot) -> String {
    let named = diagnosis.effects.iter().map(|effect| {
        let size = by_ruler(effect.id, &effect.parameters, &Map::new(), robot);
        let what = size.as_deref().unwrap_or_else(|| words::name(effect.id, catalogue));
        format!("{} ({} sure)", of_sensor(what, effect.sensor.as_deref()), words::percent(effect.probability))
    });
    let named: Vec<String> = named.collect();
    let sentence = words::verdict(diagnosis.verdict);
    match words::list(&named.iter().map(String::as_str).collect::<Vec<_>>()) {
        list if list.is_empty() => sentence.into(),
        list => format!("{}: {list}.", sentence.trim_end_matches('.')),
    }
}

fn lead(diagnosis: &Diagnosis, catalogue: &[&'static Effect], logs: &Logs) -> Markup {
    let compared: Vec<&str> = diagnosis.scope.compared.iter().map(|channel| words::channel(*channel)).collect();
    let rows: usize = logs.runs.iter().map(|run| run.rows.len()).sum();
    html! {
        @if let Some(astray) = runs::astray(diagnosis) { p { (astray) } }
        @if let Some((closed, ci95)) = diagnosis.reduction.as_ref().and_then(|r| r.whole.reducible_closed.zip(r.whole.ci95)) {
            @let [low, high] = ci95.map(words::percent);
            p {
                "With " @if diagnosis.effects.len() == 1 { "it" } @else { "them" } " the simulator closes "
                strong { (words::percent(closed)) }
                " of the gap, apart from chance (95 % interval: " (low) " to " (high) ")."
                @if let Some(next) = diagnosis.reduction.as_ref().and_then(|reduction| reduction.runner_up.as_ref()) {
                    @let names: Vec<&str> = next.id.split('+').map(|id| words::name(id, catalogue)).collect();
                    " The next best explanation, " (words::list(&names)) ", closes " (words::percent(next.reducible_closed)) "."
                }
            }
        }
        @if diagnosis.verdict != Verdict::NoGap { p { "See " a href="#next" { "what to do next" } "." } }
        p.quiet {
            "Compared: " (words::list(&compared)) " in " (rows) " rows of " (logs.runs.len())
            @if logs.runs.len() == 1 { " run." } @else { " runs." }
        }
        @for missing in diagnosis.scope.not_compared.chunk_by(|a, b| a.reason == b.reason) {
            @let channels = missing.iter().map(|one| of_sensor(words::channel(one.channel), one.sensor.as_deref()));
            @let channels: Vec<String> = channels.collect();
            p.bad { "Not compared: " (words::list(&channels.iter().map(String::as_str).collect::<Vec<_>>())) ". " (missing[0].reason) }
        }
        @for unconfirmed in &diagnosis.unconfirmed { p.bad { (unconfirmed.sentence()) } }
        @for outliers in &diagnosis.outliers { p.bad { (outliers.sentence()) } }
    }
}

fn budget(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> Markup {
    let parts = &diagnosis.budget;
    let name = |part: &Part| of_sensor(words::name(&part.id, catalogue), part.sensor.as_deref());
    let said: Vec<String> = parts.iter().map(|part| format!("{} {}", name(part), words::percent(part.share))).collect();
    let rows: Vec<[String; 2]> =
        parts.iter().map(|part| [name(part), words::percent_within(part.share, part.ci95)]).collect();
    let drawn = pictures::budget(diagnosis, name).draw();
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
                    li { "Check " strong { (of_sensor(cause.name, part.sensor.as_deref())) } ", " (words::percent(part.share))
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
            @if diagnosis.verdict == Verdict::NoGap {
                li { "Departures from neutral as large as these would have shown:" (would_show(diagnosis, catalogue)) }
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

/// The smallest strengths that the logs would have shown.
fn would_show(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> Markup {
    let shown = diagnosis.detectable.iter().filter_map(|of| {
        let strength = format!("{} {}", of.parameter, three_digits(of.smallest?));
        Some([of_sensor(words::name(of.id, catalogue), of.sensor.as_deref()), strength])
    });
    table("What these logs would have shown", ["effect", "smallest departure"], &shown.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests;
