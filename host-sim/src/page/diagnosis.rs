//! The page of a diagnosis: is there a gap, what is it made of, where does it lie, and what to do next.

mod causes;
mod compared;
mod places;
mod runs;

use maud::{Markup, html};
use serde::Serialize;

use super::document::{Document, Script, Section, chart, table};
use super::replay::Replay;
use super::room::Room;
use super::{glossary, words};
use crate::effects::Effect;
use crate::error::Result;
use crate::evaluation::paths::PathError;
use crate::gap::Findings;
use crate::gap::budget::{Part, SCATTER, UNEXPLAINED};
use crate::gap::diagnosis::Diagnosis;
use crate::gap::explain::evidence::Evidence;
use crate::gap::explain::profile::ResidualProfile;
use crate::gap::explain::room_map::RoomMap;
use crate::gap::verdict::Verdict;
use crate::logs::Logs;
use crate::simulator::baseline::Baseline;
use crate::simulator::rollout::REACHED_CM;

/// What a page is made of.
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
    /// First and last day on which the logs were written, if the files tell.
    pub written: Option<[String; 2]>,
    /// Seed of the draws.
    pub seed: u64,
}

/// What the charts draw.
#[derive(Serialize)]
struct Data<'a> {
    budget: Vec<BudgetBar<'a>>,
    evidence: &'a [Evidence],
    profiles: &'a [ResidualProfile],
    map: Option<&'a RoomMap>,
    channels: Vec<ChannelBar>,
    paths: &'a [PathError],
    room: Room,
    replay: Option<&'a Replay>,
}

#[derive(Serialize)]
struct BudgetBar<'a> {
    id: &'a str,
    name: &'a str,
    named: bool,
    share: f64,
    ci95: [f64; 2],
}

#[derive(Serialize)]
struct ChannelBar {
    name: &'static str,
    before: f64,
    after: f64,
}

/// A part of the gap from which on it is worth a walk to the robot: less than a twentieth changes no controller's fate.
const WORTH_A_CHECK: f64 = 0.05;

/// The page, whole in one file.
///
/// # Errors
/// When a number in it has no form in JSON.
pub fn page(subject: &Subject) -> Result<String> {
    let Subject { findings, logs, catalogue, source, .. } = subject;
    let diagnosis = &findings.diagnosis;
    let replay = runs::replay(subject);
    let poses = logs.runs.iter().flat_map(|run| run.rows.iter().filter_map(|row| row.pose));
    let mut bars: Vec<BudgetBar> = diagnosis.budget.iter().map(|part| bar(part, catalogue)).collect();
    // Effects come first, the strongest before the others.
    let effects = bars.partition_point(|bar| bar.named);
    bars[..effects].sort_by(|a, b| b.share.total_cmp(&a.share));
    let data = Data {
        budget: bars,
        evidence: &findings.evidence,
        profiles: &diagnosis.profiles,
        map: findings.room_map.as_ref(),
        channels: places::channels(diagnosis),
        paths: diagnosis.reduction.as_ref().map_or(&[], |reduction| &reduction.paths),
        room: Room::new(&logs.scene, REACHED_CM, poses.map(|pose| pose.position_cm)),
        replay: replay.as_ref(),
    };
    let mut sections = Vec::new();
    if !diagnosis.budget.is_empty() {
        sections.push(Section { id: "budget", title: "What the gap is made of", body: budget(diagnosis, catalogue) });
    }
    sections.extend(causes::section(subject));
    sections.extend(places::section(diagnosis, findings.room_map.is_some()));
    sections.extend(runs::ends(diagnosis));
    sections.push(runs::section(replay.as_ref(), diagnosis));
    sections.push(next(diagnosis, catalogue));
    sections.push(compared::section(subject));
    sections.push(glossary::section());
    let scripts: &[Script] = if replay.is_some() { &[Script::Diagnosis, Script::Replay] } else { &[Script::Diagnosis] };
    Document {
        kind: "Diagnosis",
        headline: &headline(diagnosis, catalogue),
        subject: &format!("{} against {}", source.logs, source.simulator),
        lead: lead(diagnosis, catalogue, logs),
        sections,
        scripts,
    }
    .html(&data)
}

fn bar<'a>(part: &'a Part, catalogue: &[&'static Effect]) -> BudgetBar<'a> {
    let Part { id, share, ci95 } = part;
    let named = id != SCATTER && id != UNEXPLAINED;
    BudgetBar { id, name: words::name(id, catalogue), named, share: *share, ci95: *ci95 }
}

/// The verdict in one sentence.
fn headline(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> String {
    let names: Vec<&str> = diagnosis.effects.iter().map(|effect| words::name(effect.id, catalogue)).collect();
    let names = words::list(&names);
    match diagnosis.verdict {
        Verdict::NoGap => "There is no gap: the logs agree with the simulator within its own error.".into(),
        Verdict::Known => {
            format!("There is a gap between simulator and robot. Known effects explain it: {names}.")
        }
        Verdict::PartlyKnown => {
            format!("There is a gap between simulator and robot. Known effects explain a part of it: {names}.")
        }
        Verdict::Unknown => "There is a gap between simulator and robot, and no known effect explains it.".into(),
    }
}

/// How probable each named effect is, in words.
fn sure(diagnosis: &Diagnosis, catalogue: &[&'static Effect]) -> String {
    let told: Vec<String> = diagnosis
        .effects
        .iter()
        .map(|effect| format!("{} {}", words::name(effect.id, catalogue), words::percent(effect.probability)))
        .collect();
    words::list(&told.iter().map(String::as_str).collect::<Vec<_>>())
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
                " of the gap that is not chance (95 % interval: " (low) " to " (high) "). "
                "How sure each is: " (sure(diagnosis, catalogue)) "."
            }
        }
        @if diagnosis.verdict != Verdict::NoGap { p { a href="#next" { "What to do next" } " stands below." } }
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
    html! {
        (chart("budget", 0, &format!("Shares of the gap: {}", said.join(", ")), html! {
            "How much of the gap each cause makes: mend the longest bar first. The thin lines are 95 % intervals. "
            "Scatter is what no rule reduces; unexplained is what follows rules that no named effect describes."
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
                    li { "Check " strong { (cause.name) } ", which makes " (words::percent(part.share))
                        " of the gap: " (cause.check) }
                }
            }
            @if !diagnosis.effects.is_empty() {
                li {
                    "Mend the robot and log it again; or teach the simulator: the same command with "
                    code { "--apply better.json" } " writes a simulator with the effects, to evolve controllers in."
                }
            }
            @if let Some(experiment) = diagnosis.experiment.as_ref() {
                @let [one, other] = experiment.between.map(|id| words::name(id, catalogue));
                li {
                    "These logs do not tell " (one) " from " (other) " for sure. Drive and log " (experiment.runs)
                    @if experiment.runs == 1 { " run" } @else { " runs" } " of " (experiment.script) "; "
                    code { "--next-experiment next.csv" } " writes the commands."
                }
            }
            @if left.is_some() || diagnosis.verdict == Verdict::Unknown {
                li {
                    @if let Some(left) = left { (words::percent(left.share)) " of the gap is not explained. " }
                    "See " a href="#where" { "where it lies" } ", watch the robot there, and state what you suspect as an "
                    "effect of your own: " code { "--effects FILE" } " lets it compete with the built-in ones."
                }
            }
            @if diagnosis.verdict == Verdict::NoGap {
                li { "Nothing has to be mended for what these logs show. A controller that fails all the same drives "
                    "where they do not: log it, and diagnose those runs." }
            }
            @if !diagnosis.untestable.is_empty() {
                li {
                    "These effects may be there or not, for the logs do not excite them: "
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
