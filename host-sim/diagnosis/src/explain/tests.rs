use super::*;
use crate::calibration::Judgement;
use crate::fit::{FitContext, Fitted};
use crate::remainder::remainders;
use crate::test_support::*;
use mindgap_learning::evaluation::paths::{PathError, Paths};
use mindgap_models::effects::Effect;

/// Calls `check` with the context of two rows in two blocks.
fn with_context(check: impl Fn(&FitContext)) {
    let (baseline, rows) = (baseline(), observations(2, 1, |_, _| Made::default()));
    check(&FitContext::new(&baseline, &rows, METHOD));
}

/// A remainder of this many nats in a channel, half of them in each of two blocks.
fn remainder(channel: Channel, nats: f64, context: &FitContext) -> Remainder {
    let mut remainder = remainders(&Fitted::none(context), context).swap_remove(channel.index());
    remainder.by_block = vec![0.5 * nats; 2];
    remainder
}

/// Effects that gain this many nats of forward motion and leave these.
fn leaving(effects: &[&'static Effect], gained: f64, left: Vec<Remainder>, context: &FitContext) -> Comparison {
    let mut found = comparison(effects, &[0.5 * gained; 2], context);
    found.chosen.log_likelihood.motion = vec![[0.5 * gained, 0.0, 0.0]; 2];
    Comparison { beyond_chosen: left, ..found }
}

fn judged(found: &Comparison) -> Judged {
    Judged::of(found, &robot(), &CALIBRATION)
}

#[test]
fn the_explained_fraction_is_that_of_what_could_be_explained() {
    with_context(|context| {
        let fraction = |gained: f64, left: f64| {
            let left = vec![remainder(Channel::Forward, left, context)];
            Explained::at_least(&leaving(&[&LONGER], gained, left, context)).fraction
        };
        assert_eq!(fraction(30.0, 10.0), 0.75);
        assert_eq!(fraction(30.0, 0.0), 1.0);
        assert_eq!(fraction(30.0, -10.0), 1.0, "less than nothing cannot be left");
        assert_eq!(fraction(-5.0, 10.0), 0.0);
        assert_eq!(fraction(0.0, 0.0), 1.0, "nothing is wholly explained");
    });
}

/// Where just enough is explained the odds are even, one width beyond e to one; and equally likely rivals share.
#[test]
fn the_probability_of_an_answer() {
    let explained = |fraction: f64| Explained { fraction, error: 0.0 };
    let probability = |fraction, rivals: &[f64]| probability(explained(fraction), rivals.iter().copied(), &CALIBRATION);
    let e = std::f64::consts::E;
    assert!((probability(0.8, &[]) - 0.5 * 0.9).abs() < 1e-12);
    assert!((probability(0.85, &[]) - e / (1.0 + e) * 0.9).abs() < 1e-12);
    assert!((probability(0.8, &[1.0]) - 0.25 * 0.9).abs() < 1e-12);
    assert!((probability(0.8, &[0.5, 0.5]) - 0.25 * 0.9).abs() < 1e-12);
    let doubtful = Calibration { temperature: 2.0, ..CALIBRATION };
    assert!((super::probability(explained(0.8), [0.25].into_iter(), &doubtful) - 0.9 / 3.0).abs() < 1e-12);
}

#[test]
fn where_nothing_gains_there_is_no_gap() {
    with_context(|context| assert!(matches!(judged(&comparison(&[], &[0.0; 2], context)), Judged::NoGap)));
}

#[test]
fn an_effect_that_leaves_nothing_over_is_known() {
    with_context(|context| {
        // Fifteen nats beyond the gate of five: five times strong evidence.
        let Judged::Known { effects } = judged(&comparison(&[&LONGER], &[10.0; 2], context)) else {
            panic!("the effect explains all")
        };
        let [effect] = effects.as_slice() else { panic!("{effects:?}") };
        assert_eq!((effect.id, effect.parameters["cm"].as_f64()), ("longer", Some(0.5)));
        let expected = logistic(5.0) * 0.9 * logistic((1.0 - 0.8) / 0.05);
        assert!((effect.probability - expected).abs() < 1e-12, "{} {expected}", effect.probability);
        assert!(effect.ambiguous_with.is_empty());
    });
}

#[test]
fn what_could_stand_for_an_effect_is_named_beside_it_and_lowers_its_probability() {
    with_context(|context| {
        let fit = |effect: &'static Effect, each: f64| made_up(&[effect], &[0.5], &[each; 2], context);
        // A lead of three nats, of three nats' error: a relative likelihood of exp(−1/2). One of 18 is out of reach.
        let rivals = vec![vec![fit(&LONGER, 10.0), fit(&LONGER_TO_THE_LEFT, 8.5), fit(&FARTHER, 1.0)]];
        let found = Comparison { rivals, ..comparison(&[&LONGER], &[10.0; 2], context) };
        let Judged::Known { effects } = judged(&found) else { panic!("the effect explains all") };
        assert_eq!(effects[0].ambiguous_with, ["longer_to_the_left"]);
        let doubt = libm::exp(-0.5) + libm::exp(-18.0);
        let expected = logistic(5.0) * 0.9 * logistic(4.0) / (1.0 + doubt);
        assert!((effects[0].probability - expected).abs() < 1e-12, "{} {expected}", effects[0].probability);
    });
}

#[test]
fn the_more_probable_effect_is_named_first() {
    with_context(|context| {
        let fit = |effects: &[&'static Effect], each: f64| made_up(effects, &[0.5; 2], &[each; 2], context);
        let rivals = vec![vec![fit(&[&FARTHER, &LONGER_TO_THE_LEFT], 9.0)], Vec::new()];
        let found = Comparison { rivals, ..comparison(&[&LONGER, &FARTHER], &[10.0; 2], context) };
        let Judged::Known { effects } = judged(&found) else { panic!("the effects explain all") };
        assert_eq!(effects.iter().map(|e| e.id).collect::<Vec<_>>(), ["farther", "longer"]);
        assert!(effects[0].probability > 1.5 * effects[1].probability);
    });
}

#[test]
fn a_gap_that_no_effect_explains_is_unknown() {
    with_context(|context| {
        let left = |effects: &[&'static Effect], gained: f64, left: f64| {
            judged(&leaving(effects, gained, vec![remainder(Channel::Forward, left, context)], context))
        };
        assert!(matches!(left(&[], 0.0, 10.0), Judged::Unknown));
        // 79 % are less than the 80 % that are asked for, 90 % are enough.
        assert!(matches!(left(&[&LONGER], 79.0, 21.0), Judged::Unknown));
        assert!(matches!(left(&[&LONGER], 90.0, 10.0), Judged::Known { .. }));
    });
}

/// However little it is beside what the effect explains elsewhere.
#[test]
fn what_is_left_where_an_effect_explains_nothing_is_another_cause_s() {
    with_context(|context| {
        let left = |forward: f64, turn: f64| {
            let left = [(Channel::Forward, forward), (Channel::Turn, turn)];
            let left = left.map(|(channel, nats)| remainder(channel, nats, context)).into();
            judged(&leaving(&[&LONGER], 90.0, left, context))
        };
        assert!(matches!(left(10.0, 0.0), Judged::Known { .. }), "what its form lacks");
        let Judged::PartlyKnown { effects } = left(0.0, 10.0) else { panic!("it explains all where it explains") };
        let expected = 0.9 * logistic((1.0 - 0.8) / 0.05);
        assert!((effects[0].probability - expected).abs() < 1e-9, "{} {expected}", effects[0].probability);
        assert!(matches!(left(30.0, 10.0), Judged::Unknown));
        // Sideways it explains nothing either, but forms of a way forward leave something there.
        let sideways =
            |nats: f64| judged(&leaving(&[&LONGER], 90.0, vec![remainder(Channel::Lateral, nats, context)], context));
        assert!(matches!(sideways(10.0), Judged::Known { .. }));
        assert!(matches!(sideways(30.0), Judged::PartlyKnown { .. }));
    });
}

/// A comparison whose rollouts of so many steps the effect brings nearer by this share of what it foretells.
fn bringing_nearer(steps: usize, nearer_ci95: Option<[f64; 2]>, context: &FitContext) -> Comparison {
    let error = PathError { steps, before_cm: 3.0, after_cm: 3.2, floor_cm: 1.0 };
    Comparison { paths: vec![Paths { error, nearer_ci95 }], ..leaving(&[&LONGER], 20.0, Vec::new(), context) }
}

#[test]
fn an_effect_that_brings_rollouts_no_nearer_is_no_whole_cause() {
    with_context(|context| {
        let judged = |steps, nearer_ci95| judged(&bringing_nearer(steps, nearer_ci95, context));
        for steps in [2, 5, 10] {
            let Judged::PartlyKnown { effects } = judged(steps, Some([-0.3, 0.49])) else { panic!("{steps}") };
            assert_eq!(effects[0].probability, 0.5, "{steps}");
            let Judged::Known { effects } = judged(steps, Some([-0.3, 0.51])) else { panic!("{steps}") };
            assert!(effects[0].probability > 0.8, "{steps}");
        }
        for (steps, nearer) in [(1, Some([0.0; 2])), (25, Some([0.0; 2])), (5, None)] {
            assert!(matches!(judged(steps, nearer), Judged::Known { .. }), "{steps}");
        }
    });
}

#[test]
fn rollouts_that_stay_as_far_off_are_told() {
    with_context(|context| {
        let told = |nearer| rollouts::refutation(&bringing_nearer(5, Some(nearer), context), &CALIBRATION);
        assert!(told([-0.3, 0.1]).is_some_and(|told| told.starts_with("Paths of 5 steps end 3.20 cm from where")));
        assert_eq!(told([0.7, 1.2]), None);
    });
}

/// What is judged where so many others lag behind the first of these effects by seven nats: each is named beside it, and the
/// doubt of six is that of one that is 0.4 as likely.
fn with_others(count: usize, effects: &[&'static Effect], context: &FitContext) -> Judged {
    const IDS: [&str; 6] = ["a", "b", "c", "d", "e", "f"];
    let other = |id: &&'static str| {
        let mut fit = made_up(effects, &[0.5; 2][..effects.len()], &[6.5; 2], context);
        fit.hypothesis.candidates[0].effect = id;
        fit
    };
    let mut found = comparison(effects, &[10.0; 2], context);
    found.rivals = vec![IDS[..count].iter().map(other).collect()];
    let judgement = Judgement { rival_z: 2.45, ..CALIBRATION.judgement };
    Judged::of(&found, &robot(), &Calibration { judgement, ..CALIBRATION })
}

/// However many others could stand for an effect: the gap is explained, though not by which.
#[test]
fn an_effect_for_which_many_could_stand_is_told_with_them() {
    with_context(|context| {
        let Judged::Known { effects } = with_others(6, &[&LONGER], context) else { panic!("it explains all") };
        let [effect] = effects.as_slice() else { panic!("{effects:?}") };
        assert_eq!((effect.id, effect.ambiguous_with.len()), ("longer", 6));
        let Judged::Known { effects } = with_others(6, &[&LONGER, &FARTHER], context) else {
            panic!("they explain all")
        };
        let told: Vec<(&str, usize)> = effects.iter().map(|e| (e.id, e.ambiguous_with.len())).collect();
        assert_eq!(told, [("farther", 0), ("longer", 6)]);
    });
}

/// Of forward motion an effect explains 79 of a hundred nats, where 80 are asked for; of the 21 that are left each of two
/// blocks shows as much, or one shows 4 more than the other: an error of 4 nats, and of 3 % of the whole.
#[test]
fn an_effect_that_may_leave_no_more_than_a_right_one_is_told_with_its_doubt() {
    with_context(|context| {
        let judged = |more: f64| {
            let mut left = remainder(Channel::Forward, 21.0, context);
            left.by_block = vec![10.5 - 0.5 * more, 10.5 + 0.5 * more];
            judged(&leaving(&[&LONGER], 79.0, vec![left], context))
        };
        assert!(matches!(judged(0.0), Judged::Unknown));
        let Judged::PartlyKnown { effects } = judged(4.0) else { panic!("80 of a hundred are within two errors") };
        let width = libm::hypot(0.05, LOGISTIC_SCALE * 0.79 * 0.04);
        let expected = 0.9 * logistic(-0.01 / width);
        assert!((effects[0].probability - expected).abs() < 1e-9, "{} {expected}", effects[0].probability);
    });
}

#[test]
fn effects_that_are_as_probable_come_by_their_shares() {
    let effect = |id: &'static str, probability: f64| NamedEffect {
        id,
        probability,
        parameters: serde_json::Map::new(),
        ambiguous_with: Vec::new(),
        share: None,
        intervals: serde_json::Map::new(),
        at_bound: Vec::new(),
    };
    let part = |id: &str, share: f64| Part { id: id.into(), share, ci95: [share; 2] };
    let budget = [part("slope", 0.1), part("latency", 0.2), part("slip", 0.7)];
    let effects = vec![effect("slope", 0.9), effect("latency", 0.901), effect("slip", 0.5)];
    let told = with_shares(effects, &budget);
    assert_eq!(told.iter().map(|e| e.id).collect::<Vec<_>>(), ["latency", "slope", "slip"]);
    assert_eq!(told[0].share, Some(0.2));
}
