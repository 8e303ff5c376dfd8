//! The causes, one by one: description, strength, probability, check and evidence.

use maud::{Markup, html};

use super::Subject;
use crate::document::{Section, chart, table};
use crate::words;
use mindgap_diagnosis::explain::evidence::Evidence;
use mindgap_diagnosis::explain::profile::{Bin, ResidualProfile};
use mindgap_diagnosis::scope::of_sensor;
use mindgap_diagnosis::verdict::NamedEffect;
use mindgap_figures::pictures;
use mindgap_foundations::channel::Channel;
use mindgap_models::effects::Effect;

/// The causes, and what none of them explains; `None` where there is no gap.
pub fn section(subject: &Subject) -> Option<Section> {
    let diagnosis = &subject.findings.diagnosis;
    let (effects, profiles) = (&diagnosis.effects, &diagnosis.profiles);
    if effects.is_empty() && profiles.is_empty() && diagnosis.formula.is_none() {
        return None;
    }
    let body = html! {
        @for effect in effects {
            (cause(effect, &subject.findings.evidence, subject.catalogue))
        }
        @if !profiles.is_empty() || diagnosis.formula.is_some() {
            h3 { "What no effect explains" }
            @if let Some(formula) = &diagnosis.formula {
                @let unit = if formula.channel == Channel::Turn { "radians a step" } else { "cm" };
                p {
                    "The simplest expression for it in the " (words::channel(formula.channel)) " is "
                    code { (formula.text) }
                    " (" (unit) "): " (words::percent_within(formula.share, formula.ci95)) " of the gap."
                }
            }
            @for profile in profiles { (unexplained(profile)) }
        }
    };
    Some(Section { id: "causes", title: if effects.is_empty() { "What is unexplained" } else { "The causes" }, body })
}

fn cause(effect: &NamedEffect, evidence: &[Evidence], catalogue: &[&'static Effect]) -> Markup {
    let named = words::cause(effect.id, catalogue);
    let sensor = effect.sensor.as_deref();
    let name = of_sensor(words::name(effect.id, catalogue), sensor);
    let anchor =
        sensor.map_or_else(|| format!("cause-{}", effect.id), |sensor| format!("cause-{}-{sensor}", effect.id));
    let rivals: Vec<&str> = effect.ambiguous_with.iter().map(|id| words::name(id, catalogue)).collect();
    html! {
        article.card aria-labelledby=(anchor) {
            h3 #(anchor) {
                (name) " " small.quiet { code { (effect.id) } }
            }
            dl {
                @if let Some(cause) = named { dt { "What it is" } dd { (cause.what) } }
                @if !effect.parameters.is_empty() {
                    dt { "How strong (95\u{a0}%)" }
                    dd { (effect.strength()) @if has_direction(effect) { ". Directions: 0 is along x, 90 along y." } }
                }
                @if let Some(ruler) = effect.ruler.as_ref() { dt { "By ruler and watch" } dd { (ruler) } }
                @if let Some(share) = effect.share { dt { "Of the gap" } dd { (words::percent(share)) } }
                dt { "Probability" }
                dd {
                    (words::percent(effect.probability))
                    @if !rivals.is_empty() { ". These logs cannot tell it from " (words::list(&rivals)) "." }
                }
                @if !effect.witness.is_empty() { dt { "Shown by" } dd { (words::list(&effect.witness)) } }
                @if let Some(cause) = named { dt { "How to check" } dd { (cause.check) } }
            }
            @if let Some(evidence) = evidence.iter().find(|e| e.effect == effect.id && e.sensor == effect.sensor) {
                h4 { "The evidence" }
                @let kinds = [("without the effect", evidence.without.as_slice()), ("with it", &evidence.with)];
                @let drawn = pictures::residuals(evidence.depends_on, evidence.unit, &kinds).draw();
                (chart("evidence", &drawn, &format!(
                    "Logged minus predicted {} along {}: {} without the effect, {} with it.",
                    words::channel(evidence.channel), evidence.depends_on,
                    reach(&evidence.without), reach(&evidence.with),
                ), html! {
                    "Logged minus predicted " (words::channel(evidence.channel))
                    ". On the zero line the simulator is right. The vertical lines are 95 % intervals."
                }))
                (table("The same in numbers", [evidence.depends_on, "without the effect", "with it"], &rows(evidence)))
            }
        }
    }
}

fn has_direction(effect: &NamedEffect) -> bool {
    effect.parameters.contains_key("direction_deg")
}

fn unexplained(profile: &ResidualProfile) -> Markup {
    let off = |bin: &Bin| format!("{} ± {}", words::number(bin.off, 2), words::number(1.96 * bin.error, 2));
    let rows: Vec<[String; 2]> = profile.bins.iter().map(|bin| [range(bin), off(bin)]).collect();
    let name = of_sensor(words::channel(profile.channel), profile.sensor.as_deref());
    let alternative = format!("Logged minus predicted {name} along {}: {}.", profile.depends_on, reach(&profile.bins));
    let kinds = [("remaining residual", profile.bins.as_slice())];
    let drawn = pictures::residuals(profile.depends_on, profile.unit, &kinds).draw();
    html! {
        (chart("profile", &drawn, &alternative,
            html! { "The remaining residual of the " (name) " depends most on " (profile.depends_on) "." }))
        (table("The same in numbers", [profile.depends_on, "logged minus predicted"], &rows))
    }
}

fn rows(evidence: &Evidence) -> Vec<[String; 3]> {
    let off = |bin: &Bin| format!("{} ± {}", words::number(bin.off, 2), words::number(1.96 * bin.error, 2));
    evidence
        .without
        .iter()
        .zip(&evidence.with)
        .map(|(without, with)| [range(without), off(without), off(with)])
        .collect()
}

fn range(bin: &Bin) -> String {
    let decimals = if bin.to - bin.from < 10.0 { 1 } else { 0 };
    match [bin.from, bin.to].map(|end| words::number(end, decimals)) {
        [from, to] if from == to => from,
        [from, to] => format!("{from} to {to}"),
    }
}

/// Least and largest value of the bins.
fn reach(bins: &[Bin]) -> String {
    let (low, high) = bins.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), b| (l.min(b.off), h.max(b.off)));
    format!("{} to {}", words::number(low, 2), words::number(high, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_written_in_words() {
        let written = |from: f64, to: f64| range(&Bin { from, to, off: 0.0, error: 0.0 });
        assert_eq!([written(-62.0, 0.0), written(0.0, 0.0), written(1.25, 3.5)], ["−62 to 0", "0.0", "1.2 to 3.5"]);
    }
}
