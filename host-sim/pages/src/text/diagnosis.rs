//! A diagnosis as text for one screen.

use super::budget;
use crate::words;
use mindgap_diagnosis::Diagnosis;
use mindgap_diagnosis::account::{ChannelReduction, GapReduction, Reduction};
use mindgap_diagnosis::confirm::unconfirmed::Unconfirmed;
use mindgap_diagnosis::excitation::Detectable;
use mindgap_diagnosis::explain::profile::ResidualProfile;
use mindgap_diagnosis::explain::strata::Stratum;
use mindgap_diagnosis::formula::Statement;
use mindgap_diagnosis::outliers::Outliers;
use mindgap_diagnosis::propose::Experiment;
use mindgap_diagnosis::scope::of_sensor;
use mindgap_diagnosis::sessions;
use mindgap_diagnosis::verdict::{NamedEffect, Verdict};
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_learning::evaluation::final_position::FinalPositionErrors;

/// Number of smallest departures on one line.
const PER_LINE: usize = 4;

/// Returns a diagnosis as text.
pub fn text(diagnosis: &Diagnosis) -> String {
    let mut lines = Vec::new();
    if !diagnosis.data.is_empty() {
        lines.push("Data:".into());
        lines.extend(diagnosis.data.iter().map(|found| format!("  {}", found.line())));
    }
    lines.push(verdict(diagnosis.verdict));
    lines.extend(budget::lines(diagnosis));
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
    lines.extend(sessions::lines(&diagnosis.sessions));
    lines.extend(diagnosis.experiment.as_ref().map(Experiment::sentence));
    lines.extend(diagnosis.unconfirmed.iter().map(Unconfirmed::sentence));
    lines.extend(diagnosis.outliers.iter().map(Outliers::sentence));
    if diagnosis.verdict == Verdict::NoGap {
        lines.extend(would_show(&diagnosis.detectable));
    }
    if !diagnosis.untestable.is_empty() {
        let ids = diagnosis.untestable.join(", ");
        lines.push(format!("Untestable with these logs (not excited): {ids}"));
    }
    lines.extend(diagnosis.scope.sensors_not_compared());
    lines.extend(diagnosis.notes.iter().cloned());
    lines.join("\n") + "\n"
}

fn verdict(verdict: Verdict) -> String {
    let made_of = if verdict == Verdict::NoGap { "" } else { " Its parts:" };
    format!("{}{made_of}", words::verdict(verdict))
}

fn effect(effect: &NamedEffect) -> Vec<String> {
    let name = of_sensor(effect.id, effect.sensor.as_deref());
    let mut lines = vec![format!("  {:>3.0} %  {}: {}", 100.0 * effect.probability, name, effect.strength())];
    lines.extend(effect.ruler.iter().map(|ruler| format!("         {ruler}")));
    if !effect.ambiguous_with.is_empty() {
        lines.push(format!("         these logs cannot distinguish it from {}", effect.ambiguous_with.join(", ")));
    }
    if !effect.witness.is_empty() {
        lines.push(format!("         {} show that it is there and not elsewhere", effect.witness.join(", ")));
    }
    lines
}

/// Returns which strengths logs like these would show, a few per line; nothing where they would show none.
pub fn would_show(detectable: &[Detectable]) -> Vec<String> {
    let from = |of: &Detectable| {
        let smallest = of.smallest?;
        let name = of_sensor(of.id, of.sensor.as_deref());
        Some(format!("{name} ({} by {})", of.parameter, three_digits(smallest)))
    };
    let shown: Vec<String> = detectable.iter().filter_map(from).collect();
    if shown.is_empty() {
        return Vec::new();
    }
    let lines = shown.chunks(PER_LINE).map(|few| format!("  {}", few.join(", ")));
    ["Smallest effects that these logs would show:".to_string()].into_iter().chain(lines).collect()
}

fn stratum(stratum: &Stratum) -> String {
    let channel = of_sensor(stratum.channel.name(), stratum.sensor.as_deref());
    format!("  {:>3.0} % of the gap in {channel}: {}", 100.0 * stratum.share, stratum.context)
}

fn profile(profile: &ResidualProfile) -> String {
    let bins = profile.bins.iter().map(|b| format!("{}: {:+.2}", range(b.from, b.to), b.off));
    let ResidualProfile { channel, depends_on, unit, sensor, .. } = profile;
    let channel = of_sensor(channel.name(), sensor.as_deref());
    format!("  {channel} ({unit}) by {depends_on}: {}", bins.collect::<Vec<_>>().join(" | "))
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

fn channel(of: &ChannelReduction) -> String {
    of_sensor(of.channel.name(), of.sensor.as_deref())
}

/// Returns a table of the size of a gap without named effects.
fn size(found: &GapReduction) -> Vec<String> {
    let row = |what: &str, size: f64, floor: &str| format!("  {what:<34}{size:>9.3}{floor:>9}").trim_end().to_string();
    let mut lines = vec![
        format!("{:<36}{:>9}{:>9}", "Size of the gap:", "gap", "floor"),
        row("all channels, nats per step", found.whole.before, ""),
    ];
    lines.extend(found.channels.iter().map(|c| row(&format!("  {}", channel(c)), c.reduction.before, "")));
    lines.extend(
        found.paths.iter().map(|p| {
            row(&format!("end point after {} step(s), cm", p.steps), p.before_cm, &format!("{:.3}", p.floor_cm))
        }),
    );
    lines
}

/// Returns a table of the gap before and after, with the noise floor where there is a measured one.
fn reduction(found: &GapReduction) -> Vec<String> {
    let closed = |reduction: &Reduction| match (reduction.reducible_closed, reduction.ci95) {
        (Some(share), Some([low, high])) => {
            format!("{:.0} % ({:.0} to {:.0})", 100.0 * share, 100.0 * low, 100.0 * high)
        }
        _ => String::new(),
    };
    let row = |what: &str, [before, after]: [f64; 2], floor: &str, closed: &str| {
        format!("  {what:<34}{before:>9.3}{after:>9.3}{floor:>9}  {closed}").trim_end().to_string()
    };
    let whole = &found.whole;
    let mut lines = vec![
        format!("{:<36}{:>9}{:>9}{:>9}  closed (95 %)", "Gap reduction:", "before", "after", "floor"),
        row("all channels, nats per step", [whole.before, whole.after], "", &closed(whole)),
    ];
    lines.extend(found.channels.iter().map(|c| {
        let r = &c.reduction;
        let what = format!("  {}", channel(c));
        row(&what, [r.before, r.after], "", &closed(r))
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
