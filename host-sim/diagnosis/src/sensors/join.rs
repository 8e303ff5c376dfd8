//! Joins what the sensors of one robot show into one diagnosis.

use super::{Further, not_compared};
use crate::account::{GapReduction, Reduction};
use crate::budget::{Part, SCATTER, UNEXPLAINED};
use crate::diagnose::Findings;
use crate::diagnosis::Diagnosis;
use crate::scope::{NotCompared, Scope};
use crate::verdict::{NamedEffect, Verdict, in_order};
use mindgap_foundations::channel::Channel;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::{Place, catalogue};

/// Puts the name of a sensor on all that concerns it.
pub fn named(mut findings: Findings, sensor: &str) -> Findings {
    let own = |channel: Channel| Channel::SONAR.contains(&channel).then(|| sensor.to_owned());
    let in_sensor = |id: &str| (catalogue::place(id) == Some(Place::Sensor)).then(|| sensor.to_owned());
    findings.evidence.iter_mut().for_each(|evidence| evidence.sensor = in_sensor(&evidence.effect));
    let diagnosis = &mut findings.diagnosis;
    diagnosis.effects.iter_mut().for_each(|effect| effect.sensor = in_sensor(effect.id));
    diagnosis.budget.iter_mut().for_each(|part| part.sensor = in_sensor(&part.id));
    diagnosis.detectable.iter_mut().for_each(|of| of.sensor = in_sensor(of.id));
    diagnosis.unconfirmed.iter_mut().for_each(|of| of.sensor = in_sensor(of.id));
    diagnosis.strata.iter_mut().for_each(|stratum| stratum.sensor = own(stratum.channel));
    diagnosis.profiles.iter_mut().for_each(|profile| profile.sensor = own(profile.channel));
    diagnosis.outliers.iter_mut().for_each(|outliers| outliers.sensor = own(outliers.channel));
    diagnosis.scope.not_compared.iter_mut().for_each(|not| not.sensor = own(not.channel));
    let channels = diagnosis.reduction.iter_mut().flat_map(|reduction| &mut reduction.channels);
    channels.for_each(|of| of.sensor = own(of.channel));
    findings
}

/// Joins what a further sensor shows.
pub fn joined(main: Findings, Further { sensor, found }: Further) -> Findings {
    match found {
        Ok(found) => both(main, named(found, &sensor), &sensor),
        Err(why) => {
            let Findings { mut diagnosis, .. } = main;
            diagnosis.scope.not_compared.extend(not_compared(&sensor, &why));
            Findings { diagnosis, ..main }
        }
    }
}

fn both(main: Findings, other: Findings, sensor: &str) -> Findings {
    let [main_nats, other_nats] = [main.gap_nats, other.gap_nats];
    let applied = other.applied.into_iter().map(|effect| AppliedEffect { sensor: Some(sensor.into()), ..effect });
    let applied = main.applied.iter().cloned().chain(applied).collect();
    let evidence = main.evidence.iter().cloned().chain(other.evidence).collect();
    let (one, two) = (main.diagnosis, other.diagnosis);
    let budget = budget([(one.budget, main_nats), (two.budget, other_nats)]);
    let effects = shared(one.effects.into_iter().chain(two.effects).collect(), &budget);
    let mut diagnosis = Diagnosis {
        verdict: verdict(one.verdict, two.verdict),
        effects,
        budget,
        reduction: reduction(one.reduction, two.reduction),
        scope: scope(one.scope, &two.scope),
        ..one
    };
    diagnosis.strata.extend(two.strata);
    diagnosis.strata.sort_by(|a, b| b.gap.total_cmp(&a.gap));
    diagnosis.profiles.extend(two.profiles);
    diagnosis.detectable.extend(two.detectable);
    diagnosis.unconfirmed.extend(two.unconfirmed);
    diagnosis.outliers.extend(two.outliers);
    let known = diagnosis.data.clone();
    let of_sensor = two.data.into_iter().filter(|found| !known.contains(found));
    diagnosis.data.extend(of_sensor.map(|found| found.of_sensor(sensor)));
    if !two.untestable.is_empty() {
        let ids = two.untestable.join(", ");
        diagnosis.notes.push(format!("Untestable with range sensor {sensor} (not excited): {ids}."));
    }
    Findings { diagnosis, applied, evidence, gap_nats: main_nats + other_nats, ..main }
}

/// A gap is known as far as every part of it is.
fn verdict(one: Verdict, two: Verdict) -> Verdict {
    match (one, two) {
        (Verdict::NoGap, verdict) | (verdict, Verdict::NoGap) => verdict,
        (one, two) if one == two => one,
        _ => Verdict::PartlyKnown,
    }
}

fn scope(mut main: Scope, other: &Scope) -> Scope {
    let further = other.compared.iter().filter(|channel| !main.compared.contains(channel));
    let further: Vec<Channel> = further.copied().collect();
    main.compared.extend(further);
    let is_own = |not: &&NotCompared| not.sensor.is_some();
    main.not_compared.extend(other.not_compared.iter().filter(is_own).cloned());
    main
}

/// Divides the gap of both: shares are weighted by the nats that they are shares of.
fn budget(both: [(Vec<Part>, f64); 2]) -> Vec<Part> {
    let total: f64 = both.iter().map(|(_, nats)| nats).sum();
    let weighted = both.into_iter().flat_map(|(parts, nats)| {
        let weight = if total > 0.0 { nats / total } else { 0.0 };
        let scaled =
            move |part: Part| Part { share: weight * part.share, ci95: part.ci95.map(|end| weight * end), ..part };
        parts.into_iter().map(scaled)
    });
    let (rest, mut parts): (Vec<Part>, Vec<Part>) =
        weighted.partition(|part| part.id == SCATTER || part.id == UNEXPLAINED);
    for id in [SCATTER, UNEXPLAINED] {
        parts.extend(rest.iter().filter(|part| part.id == id).cloned().reduce(sum));
    }
    parts
}

/// Adds two independent parts: their errors add up as squares.
fn sum(one: Part, two: Part) -> Part {
    let share = one.share + two.share;
    let off = |end: usize| libm::hypot(one.ci95[end] - one.share, two.ci95[end] - two.share);
    Part { share, ci95: [(share - off(0)).max(0.0), (share + off(1)).min(1.0)], ..one }
}

fn shared(effects: Vec<NamedEffect>, budget: &[Part]) -> Vec<NamedEffect> {
    let share = |effect: &NamedEffect| budget.iter().find(|part| part.id == effect.id && part.sensor == effect.sensor);
    let with_share = |effect: NamedEffect| NamedEffect { share: share(&effect).map(|part| part.share), ..effect };
    in_order(effects.into_iter().map(with_share).collect())
}

/// Gaps in nats per step add up.
fn reduction(main: Option<GapReduction>, other: Option<GapReduction>) -> Option<GapReduction> {
    let (mut main, other) = match (main, other) {
        (Some(main), Some(other)) => (main, other),
        (main, other) => return main.or(other),
    };
    let [one, two] = [main.whole, other.whole];
    let before = one.before + two.before;
    let closed = |of: &Reduction| of.before * of.reducible_closed.unwrap_or(0.0);
    if let Some(runner_up) = &mut main.runner_up {
        runner_up.reducible_closed = (one.before * runner_up.reducible_closed + closed(&two)) / before;
    }
    main.whole = Reduction {
        before,
        after: one.after + two.after,
        reducible_closed: one.reducible_closed.or(two.reducible_closed).map(|_| (closed(&one) + closed(&two)) / before),
        ci95: interval([&one, &two], before),
    };
    main.channels.extend(other.channels);
    Some(main)
}

/// Returns the interval of the fraction closed in both parts together. Their errors are independent, since their readings are, so
/// the squares add up.
fn interval(both: [&Reduction; 2], before: f64) -> Option<[f64; 2]> {
    let known = both.into_iter().filter_map(|of| Some((of.before / before, of.reducible_closed?, of.ci95?)));
    let (mut closed, mut squares) = (None, [0.0; 2]);
    for (weight, share, ci95) in known {
        closed = Some(closed.unwrap_or(0.0) + weight * share);
        squares = [0, 1].map(|end| squares[end] + (weight * (ci95[end] - share)) * (weight * (ci95[end] - share)));
    }
    closed.map(|closed| [closed - squares[0].sqrt(), closed + squares[1].sqrt()])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(id: &str, share: f64, sensor: Option<&str>) -> Part {
        Part { id: id.into(), share, ci95: [share - 0.1, share + 0.1], sensor: sensor.map(str::to_owned) }
    }

    #[test]
    fn gap_is_known_as_far_as_every_part_is() {
        use Verdict::{Known, NoGap, PartlyKnown, Unknown};
        assert_eq!([verdict(NoGap, NoGap), verdict(NoGap, Known), verdict(Unknown, NoGap)], [NoGap, Known, Unknown]);
        assert_eq!([verdict(Known, Known), verdict(Unknown, Unknown)], [Known, Unknown]);
        assert_eq!([verdict(Known, Unknown), verdict(PartlyKnown, Known)], [PartlyKnown; 2]);
    }

    #[test]
    fn shares_are_weighted_by_nats_and_add_up_to_one() {
        let one = vec![part("slip", 0.6, None), part(SCATTER, 0.1, None), part(UNEXPLAINED, 0.3, None)];
        let two = vec![part("sonar_yaw", 0.9, Some("left")), part(SCATTER, 0.0, None), part(UNEXPLAINED, 0.1, None)];
        let parts = budget([(one, 30.0), (two, 10.0)]);
        let ids: Vec<&str> = parts.iter().map(|part| part.id.as_str()).collect();
        assert_eq!(ids, ["slip", "sonar_yaw", SCATTER, UNEXPLAINED]);
        for (part, share) in parts.iter().zip([0.45, 0.225, 0.075, 0.25]) {
            assert!((part.share - share).abs() < 1e-12, "{part:?}");
        }
        let [low, high] = parts[3].ci95;
        assert!(low < 0.25 && high > 0.25 && high - low < 0.16, "independent errors add up as squares");
        assert_eq!(budget([(Vec::new(), 0.0), (Vec::new(), 0.0)]), []);
    }

    #[test]
    fn closed_shares_are_those_of_the_gap_of_both() {
        let of = |before: f64, closed: f64| GapReduction {
            whole: Reduction {
                before,
                after: before * (1.0 - closed),
                reducible_closed: Some(closed),
                ci95: Some([closed - 0.1, closed + 0.1]),
            },
            ..GapReduction::NONE
        };
        let both = reduction(Some(of(3.0, 0.9)), Some(of(1.0, 0.5))).expect("a gap").whole;
        assert!((both.reducible_closed.expect("effects") - 0.8).abs() < 1e-12, "{both:?}");
        assert!((both.before - both.after - 3.2).abs() < 1e-12, "{both:?}");
        let [low, high] = both.ci95.expect("effects");
        assert!(low > 0.7 && high < 0.9, "{both:?}");
        assert_eq!(reduction(None, Some(of(1.0, 0.5))), Some(of(1.0, 0.5)));
    }
}
