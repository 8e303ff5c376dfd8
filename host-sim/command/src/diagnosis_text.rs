//! A diagnosis as text for one screen.

use super::budget_text;
use mindgap_diagnosis::Diagnosis;
use mindgap_diagnosis::account::GapReduction;
use mindgap_diagnosis::channel::Channel;
use mindgap_diagnosis::explain::profile::ResidualProfile;
use mindgap_diagnosis::explain::strata::Stratum;
use mindgap_diagnosis::formula::Statement;
use mindgap_diagnosis::propose::Experiment;
use mindgap_diagnosis::verdict::{NamedEffect, Verdict};
use mindgap_learning::evaluation::final_position::FinalPositionErrors;
use mindgap_pages::words;

/// Returns a diagnosis as text.
pub fn text(diagnosis: &Diagnosis) -> String {
    let mut lines = Vec::new();
    if !diagnosis.data.is_empty() {
        lines.push("Data:".into());
        lines.extend(diagnosis.data.iter().map(|found| format!("  {}", found.line())));
    }
    lines.push(verdict(diagnosis.verdict));
    lines.extend(budget_text::lines(diagnosis));
    if !diagnosis.effects.is_empty() {
        lines.push("Effects (probability, effect, strength with 95 % interval):".into());
        lines.extend(diagnosis.effects.iter().flat_map(effect));
    }
    if !diagnosis.strata.is_empty() {
        lines.push("Where it is:".into());
        lines.extend(diagnosis.strata.iter().map(stratum));
    }
    if !diagnosis.profiles.is_empty() {
        lines.push("Unexplained residual (logged minus predicted):".into());
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
        lines.push(format!("Untestable with these logs (not excited): {ids}"));
    }
    lines.extend(diagnosis.notes.iter().cloned());
    lines.join("\n") + "\n"
}

fn verdict(verdict: Verdict) -> String {
    let made_of = if verdict == Verdict::NoGap { "" } else { " Its parts:" };
    format!("{}{made_of}", words::verdict(verdict))
}

fn effect(effect: &NamedEffect) -> Vec<String> {
    let mut lines = vec![format!("  {:>3.0} %  {}: {}", 100.0 * effect.probability, effect.id, effect.strength())];
    if !effect.ambiguous_with.is_empty() {
        lines.push(format!("         these logs cannot distinguish it from {}", effect.ambiguous_with.join(", ")));
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

/// Formats a range, or a single number if both ends are equal.
fn range(from: f64, to: f64) -> String {
    // Adding zero turns -0 into 0.
    let [from, to] = [from, to].map(|bound| (libm::round(bound) + 0.0).to_string());
    if from == to { from } else { format!("{from} to {to}") }
}

fn formula(of: &Statement) -> String {
    let Statement { channel, text, share, ci95: [low, high] } = of;
    let unit = if *channel == Channel::Turn { "rad per step" } else { "cm" };
    format!(
        "The unexplained {} residual follows {text} ({unit}): {:.0} % of the gap ({:.0} to {:.0}).",
        channel.name(),
        100.0 * share,
        100.0 * low,
        100.0 * high
    )
}

fn final_positions(of: &FinalPositionErrors) -> String {
    let FinalPositionErrors { runs, before_cm, after_cm, floor_cm } = of;
    format!(
        "The controller's {runs} run(s) end {before_cm:.1} cm from the simulated final positions, {after_cm:.1} cm with the \
         effects applied; process noise alone accounts for {floor_cm:.1} cm."
    )
}

/// Returns a table of the size of a gap without named effects.
fn size(found: &GapReduction) -> Vec<String> {
    let row = |what: &str, size: f64, floor: &str| format!("  {what:<34}{size:>9.3}{floor:>9}").trim_end().to_string();
    let mut lines = vec![
        format!("{:<36}{:>9}{:>9}", "Size of the gap:", "gap", "floor"),
        row("all channels, nats per step", found.whole.before, ""),
    ];
    lines.extend(found.channels.iter().map(|c| row(&format!("  {}", c.channel.name()), c.reduction.before, "")));
    lines.extend(
        found.paths.iter().map(|p| {
            row(&format!("end point after {} step(s), cm", p.steps), p.before_cm, &format!("{:.3}", p.floor_cm))
        }),
    );
    lines
}

/// Returns a table of the gap before and after, with the noise floor where there is a measured one.
fn reduction(found: &GapReduction) -> Vec<String> {
    let closed = |share: f64, [low, high]: [f64; 2]| {
        format!("{:.0} % ({:.0} to {:.0})", 100.0 * share, 100.0 * low, 100.0 * high)
    };
    let row = |what: &str, [before, after]: [f64; 2], floor: &str, closed: &str| {
        format!("  {what:<34}{before:>9.3}{after:>9.3}{floor:>9}  {closed}").trim_end().to_string()
    };
    let whole = &found.whole;
    let mut lines = vec![
        format!("{:<36}{:>9}{:>9}{:>9}  closed (95 %)", "Gap reduction:", "before", "after", "floor"),
        row(
            "all channels, nats per step",
            [whole.before, whole.after],
            "",
            &closed(whole.reducible_closed, whole.ci95),
        ),
    ];
    lines.extend(found.channels.iter().map(|c| {
        let r = &c.reduction;
        let what = format!("  {}", c.channel.name());
        row(&what, [r.before, r.after], "", &closed(r.reducible_closed, r.ci95))
    }));
    lines.extend(found.paths.iter().map(|p| {
        let what = format!("end point after {} step(s), cm", p.steps);
        row(&what, [p.before_cm, p.after_cm], &format!("{:.3}", p.floor_cm), "")
    }));
    if let Some(next) = &found.runner_up {
        lines.push(format!("  The runner-up, {}, closes {:.0} %.", next.id, 100.0 * next.reducible_closed));
    }
    lines
}
