//! A diagnosis in words, on one screen.

use super::budget_text;
use crate::evaluation::final_position::FinalPositionErrors;
use crate::gap::Diagnosis;
use crate::gap::account::GapReduction;
use crate::gap::channel::Channel;
use crate::gap::explain::profile::ResidualProfile;
use crate::gap::explain::strata::Stratum;
use crate::gap::formula::Statement;
use crate::gap::propose::Experiment;
use crate::gap::verdict::{NamedEffect, Verdict};

/// The words.
pub fn text(diagnosis: &Diagnosis) -> String {
    let mut lines = Vec::new();
    if !diagnosis.data.is_empty() {
        lines.push("Data:".into());
        lines.extend(diagnosis.data.iter().map(|found| format!("  {}", found.line())));
    }
    lines.push(verdict(diagnosis.verdict).to_string());
    lines.extend(budget_text::lines(diagnosis));
    if !diagnosis.effects.is_empty() {
        lines.push("The effects (probability, effect, strength with 95 % interval):".into());
        lines.extend(diagnosis.effects.iter().flat_map(effect));
    }
    if !diagnosis.strata.is_empty() {
        lines.push("Where it lies:".into());
        lines.extend(diagnosis.strata.iter().map(stratum));
    }
    if !diagnosis.profiles.is_empty() {
        lines.push("What is unexplained (logged minus predicted) follows:".into());
        lines.extend(diagnosis.profiles.iter().map(profile));
    }
    lines.extend(diagnosis.formula.iter().map(formula));
    let is_explained = diagnosis.verdict != Verdict::Unknown;
    let table = |found| if is_explained { reduction(found) } else { size(found) };
    lines.extend(diagnosis.reduction.as_ref().into_iter().flat_map(table));
    lines.extend(diagnosis.final_positions.iter().map(final_positions));
    lines.extend(diagnosis.experiment.as_ref().map(Experiment::sentence));
    if !diagnosis.untestable.is_empty() {
        let ids = diagnosis.untestable.join(", ");
        lines.push(format!("Not excited by these logs, so neither there nor absent: {ids}"));
    }
    lines.extend(diagnosis.notes.iter().cloned());
    lines.join("\n") + "\n"
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NoGap => "No gap: the logs agree with the simulator within its own error.",
        Verdict::Known => "There is a gap, and known effects explain it. What it is made of:",
        Verdict::PartlyKnown => {
            "There is a gap. Known effects explain a part of it, and something is left. What it is made of:"
        }
        Verdict::Unknown => "There is a gap, and no known effect explains it. What it is made of:",
    }
}

fn effect(effect: &NamedEffect) -> Vec<String> {
    let mut lines = vec![format!("  {:>3.0} %  {}: {}", 100.0 * effect.probability, effect.id, effect.strength())];
    if !effect.ambiguous_with.is_empty() {
        lines.push(format!("         these logs cannot tell it from {}", effect.ambiguous_with.join(", ")));
    }
    lines
}

fn stratum(stratum: &Stratum) -> String {
    format!("  {:>3.0} % of the gap in {}: {}", 100.0 * stratum.share, stratum.channel.name(), stratum.context)
}

fn profile(profile: &ResidualProfile) -> String {
    let bins = profile.bins.iter().map(|b| format!("{}: {:+.2}", range(b.from, b.to), b.off));
    let ResidualProfile { channel, depends_on, unit, .. } = profile;
    format!("  {} ({unit}) by {depends_on}: {}", channel.name(), bins.collect::<Vec<_>>().join(" | "))
}

/// From one number to another, or the number that both are.
fn range(from: f64, to: f64) -> String {
    // Zero has no sign.
    let [from, to] = [from, to].map(|bound| (libm::round(bound) + 0.0).to_string());
    if from == to { from } else { format!("{from} to {to}") }
}

fn formula(of: &Statement) -> String {
    let Statement { channel, text, share, ci95: [low, high] } = of;
    let unit = if *channel == Channel::Turn { "rad a step" } else { "cm" };
    format!(
        "What no effect explains of {} follows {text} ({unit}): {:.0} % of the gap ({:.0} to {:.0}).",
        channel.name(),
        100.0 * share,
        100.0 * low,
        100.0 * high
    )
}

fn final_positions(of: &FinalPositionErrors) -> String {
    let FinalPositionErrors { runs, before_cm, after_cm, floor_cm } = of;
    format!(
        "The controller's {runs} run(s) end {before_cm:.1} cm from where the simulator expects, {after_cm:.1} cm with the \
         effects; scatter alone makes {floor_cm:.1} cm."
    )
}

/// A table of how large a gap is that nothing explains which could be named.
fn size(found: &GapReduction) -> Vec<String> {
    let row = |what: &str, size: f64, floor: &str| format!("  {what:<34}{size:>9.3}{floor:>9}").trim_end().to_string();
    let mut lines = vec![
        format!("{:<36}{:>9}{:>9}", "How large it is:", "gap", "floor"),
        row("all channels, nats a step", found.whole.before, ""),
    ];
    lines.extend(found.channels.iter().map(|c| row(&format!("  {}", c.channel.name()), c.reduction.before, "")));
    lines.extend(
        found.paths.iter().map(|p| {
            row(&format!("end of paths of {} step(s), cm", p.steps), p.before_cm, &format!("{:.3}", p.floor_cm))
        }),
    );
    lines
}

/// A table of before and after, and of the floor where there is a measured one.
fn reduction(found: &GapReduction) -> Vec<String> {
    let closed = |share: f64, [low, high]: [f64; 2]| {
        format!("{:.0} % ({:.0} to {:.0})", 100.0 * share, 100.0 * low, 100.0 * high)
    };
    let row = |what: &str, [before, after]: [f64; 2], floor: &str, closed: &str| {
        format!("  {what:<34}{before:>9.3}{after:>9.3}{floor:>9}  {closed}").trim_end().to_string()
    };
    let whole = &found.whole;
    let mut lines = vec![
        format!("{:<36}{:>9}{:>9}{:>9}  closed (95 %)", "How far it shrinks:", "before", "after", "floor"),
        row("all channels, nats a step", [whole.before, whole.after], "", &closed(whole.reducible_closed, whole.ci95)),
    ];
    lines.extend(found.channels.iter().map(|c| {
        let r = &c.reduction;
        let what = format!("  {}", c.channel.name());
        row(&what, [r.before, r.after], "", &closed(r.reducible_closed, r.ci95))
    }));
    lines.extend(found.paths.iter().map(|p| {
        let what = format!("end of paths of {} step(s), cm", p.steps);
        row(&what, [p.before_cm, p.after_cm], &format!("{:.3}", p.floor_cm), "")
    }));
    if let Some(next) = &found.runner_up {
        lines.push(format!("  The runner-up, {}, closes {:.0} %.", next.id, 100.0 * next.reducible_closed));
    }
    lines
}
