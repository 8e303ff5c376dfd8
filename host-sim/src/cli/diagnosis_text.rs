//! A diagnosis in words, on one screen.

use crate::evaluation::final_position::FinalPositions;
use crate::gap::Diagnosis;
use crate::gap::diagnosis::{EffectFound, Place, Shrink, Unexplained};
use crate::gap::verdict::Verdict;

/// The words.
pub fn text(diagnosis: &Diagnosis) -> String {
    let mut lines = vec![verdict(diagnosis).to_string()];
    lines.extend(diagnosis.effects.iter().flat_map(effect));
    if !diagnosis.r#where.is_empty() {
        lines.push("Where it lies:".into());
        lines.extend(diagnosis.r#where.iter().map(place));
    }
    if !diagnosis.unexplained.is_empty() {
        lines.push("What is unexplained (logged minus predicted) follows:".into());
        lines.extend(diagnosis.unexplained.iter().map(unexplained));
    }
    lines.extend(diagnosis.shrink.iter().flat_map(shrink));
    lines.extend(diagnosis.endings.iter().map(endings));
    lines.extend(diagnosis.next_experiment.clone());
    if !diagnosis.untestable.is_empty() {
        let ids = diagnosis.untestable.join(", ");
        lines.push(format!("Not excited by these logs, so neither there nor absent: {ids}"));
    }
    lines.extend(diagnosis.notes.iter().cloned());
    lines.join("\n") + "\n"
}

fn verdict(diagnosis: &Diagnosis) -> &'static str {
    match diagnosis.verdict {
        Verdict::NoGap => "No gap: the logs agree with the simulator within its own error.",
        Verdict::Known => "There is a gap, and known effects explain it (probability, effect, strength):",
        Verdict::Unknown => "There is a gap, and no known effect explains it.",
    }
}

fn effect(effect: &EffectFound) -> Vec<String> {
    let parameters: Vec<String> = effect.parameters.iter().map(|(name, value)| format!("{name} {value}")).collect();
    let mut lines = vec![format!("  {:>3.0} %  {}: {}", 100.0 * effect.probability, effect.id, parameters.join(", "))];
    if !effect.ambiguous_with.is_empty() {
        lines.push(format!("         these logs cannot tell it from {}", effect.ambiguous_with.join(", ")));
    }
    lines
}

fn place(place: &Place) -> String {
    format!("  {:>3.0} % of the gap in {}: {}", 100.0 * place.share, place.channel.name(), place.context)
}

fn unexplained(part: &Unexplained) -> String {
    let bins = part.shape.iter().map(|b| format!("{:.0}..{:.0}: {:+.2}", b.from, b.to, b.off));
    let Unexplained { channel, depends_on, unit, .. } = part;
    format!("  {} ({unit}) by {depends_on}: {}", channel.name(), bins.collect::<Vec<_>>().join(" | "))
}

fn endings(of: &FinalPositions) -> String {
    let FinalPositions { runs, before_cm, after_cm, floor_cm } = of;
    format!(
        "The controller's {runs} run(s) end {before_cm:.1} cm from where the simulator expects, {after_cm:.1} cm with the \
         effects; scatter alone makes {floor_cm:.1} cm."
    )
}

/// A table of before, after and floor.
fn shrink(shrink: &Shrink) -> Vec<String> {
    let closed = |share: f64, [low, high]: [f64; 2]| {
        format!("{:.0} % ({:.0} to {:.0})", 100.0 * share, 100.0 * low, 100.0 * high)
    };
    let row = |what: &str, [before, after, floor]: [f64; 3], closed: String| {
        format!("  {what:<34}{before:>9.3}{after:>9.3}{floor:>9.3}  {closed}").trim_end().to_string()
    };
    let mut lines = vec![
        format!("{:<36}{:>9}{:>9}{:>9}  closed (95 %)", "How far it shrinks:", "before", "after", "floor"),
        row(
            "all channels, nats a step",
            [shrink.before, shrink.after, shrink.floor],
            closed(shrink.reducible_closed, shrink.ci95),
        ),
    ];
    lines.extend(shrink.channels.iter().map(|c| {
        let what = format!("  {}", c.channel.name());
        row(&what, [c.before, c.after, shrink.floor], closed(c.reducible_closed, c.ci95))
    }));
    lines.extend(shrink.paths.iter().map(|p| {
        let what = format!("end of paths of {} step(s), cm", p.steps);
        row(&what, [p.before_cm, p.after_cm, p.floor_cm], String::new())
    }));
    if let Some(next) = &shrink.runner_up {
        lines.push(format!("  The runner-up, {}, closes {:.0} %.", next.id, 100.0 * next.reducible_closed));
    }
    lines
}
