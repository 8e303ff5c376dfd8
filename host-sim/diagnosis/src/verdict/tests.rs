use super::*;
use crate::calibration::Judgement;
use crate::confirm::unconfirmed::Unconfirmed;
use crate::fit::{FitContext, Fitted};
use crate::gain::Gain;
use crate::outliers::Outliers;
use crate::remainder::remainders;
use crate::slot::{FurtherGain, Slot};
use crate::test_support::*;
use mindgap_learning::evaluation::paths::{PathError, Paths};
use mindgap_models::effects::Effect;

/// Makes a remainder of this many nats in a channel, half of them in each of two blocks.
fn remainder(channel: Channel, nats: f64, context: &FitContext) -> Remainder {
    let mut remainder = remainders(&Fitted::null(context), context).swap_remove(channel.index());
    remainder.by_block = vec![0.5 * nats; 2];
    remainder
}

/// Confirms effects that gain this many nats of forward motion and leave these remainders.
fn leaving(effects: &[&'static Effect], gained: f64, left: Vec<Remainder>, context: &FitContext) -> Confirmed {
    let mut found = confirmed(effects, &[0.5 * gained; 2], context);
    found.chosen.scores = context.rows.scores_of(Channel::Forward, &[0.5 * gained; 2]);
    Confirmed { beyond_chosen: left, ..found }
}

fn concluded(found: &Confirmed) -> Conclusion {
    Conclusion::of(found, &robot(), &CALIBRATION)
}

/// Returns the effects of a conclusion with this verdict.
fn effects_of(conclusion: Conclusion, verdict: Verdict) -> Vec<NamedEffect> {
    assert_eq!(conclusion.verdict, verdict, "{conclusion:?}");
    conclusion.effects
}

/// Makes a slot of an effect that is certainly needed, with these rivals.
fn slot(rivals: Vec<Fitted>, context: &FitContext) -> Slot {
    let gain = FurtherGain { gain: Gain { nats: 1e300, ..Gain::NONE }, form_error_nats: 0.0 };
    Slot { without: made_up(&[], &[], &[0.0; 2], context), rivals, gain }
}

#[test]
fn explained_fraction_is_that_of_the_explainable_gap() {
    with_two_rows(|context| {
        let fraction = |gained: f64, left: f64| {
            let left = vec![remainder(Channel::Forward, left, context)];
            Explained::at_least(&leaving(&[&LONGER], gained, left, context)).fraction
        };
        assert_eq!(fraction(30.0, 10.0), 0.75);
        assert_eq!(fraction(30.0, 0.0), 1.0);
        assert_eq!(fraction(30.0, -10.0), 1.0, "a negative remainder counts as zero");
        assert_eq!(fraction(-5.0, 10.0), 0.0);
        assert_eq!(fraction(0.0, 0.0), 1.0, "an empty gap is fully explained");
    });
}

/// At the required fraction the odds are even, one width above they are e to one, and equally likely rivals share.
#[test]
fn probability_follows_adequacy_and_rivals() {
    let explained = |fraction: f64| Explained { fraction, error: 0.0 };
    let probability = |fraction, rivals: &[f64]| probability(explained(fraction), rivals.iter().copied(), &CALIBRATION);
    let e = std::f64::consts::E;
    assert!((probability(0.8, &[]) - 0.5 * 0.9).abs() < 1e-12);
    assert!((probability(0.85, &[]) - e / (1.0 + e) * 0.9).abs() < 1e-12);
    assert!((probability(0.8, &[1.0]) - 0.25 * 0.9).abs() < 1e-12);
    assert!((probability(0.8, &[0.5, 0.5]) - 0.25 * 0.9).abs() < 1e-12);
    let warm = Calibration { temperature: 2.0, ..CALIBRATION };
    assert!((super::probability(explained(0.8), [0.25].into_iter(), &warm) - 0.9 / 3.0).abs() < 1e-12);
}

#[test]
fn no_gain_is_no_gap() {
    with_two_rows(|context| {
        assert_eq!(concluded(&confirmed(&[], &[0.0; 2], context)).verdict, Verdict::NoGap);
    });
}

#[test]
fn what_was_found_and_not_confirmed_is_no_silence() {
    with_two_rows(|context| {
        let unconfirmed = vec![Unconfirmed { id: "longer", found_nats: 244.0, confirmed_nats: -16.0, sensor: None }];
        let found = Confirmed { unconfirmed, ..confirmed(&[], &[0.0; 2], context) };
        assert_eq!(concluded(&found).verdict, Verdict::Unknown);
        let clump =
            Outliers { channel: Channel::Turn, run: Some(3), place_cm: None, share: 0.2, nats: 30.0, sensor: None };
        let found = Confirmed { outliers: vec![clump], ..confirmed(&[], &[0.0; 2], context) };
        assert_eq!(concluded(&found).verdict, Verdict::Unknown);
    });
}

#[test]
fn effect_without_remainder_is_known() {
    with_two_rows(|context| {
        // Fifteen nats beyond the gate of five: five times strong evidence.
        let effects = effects_of(concluded(&confirmed(&[&LONGER], &[10.0; 2], context)), Verdict::Known);
        let [effect] = effects.as_slice() else { panic!("{effects:?}") };
        assert_eq!((effect.id, effect.parameters["cm"].as_f64()), ("longer", Some(0.5)));
        let expected = logistic(5.0) * 0.9 * logistic((1.0 - 0.8) / 0.05);
        assert!((effect.probability - expected).abs() < 1e-12, "{} {expected}", effect.probability);
        assert!(effect.ambiguous_with.is_empty());
    });
}

#[test]
fn rivals_are_named_and_lower_the_probability() {
    with_two_rows(|context| {
        let fit = |effect: &'static Effect, each: f64| made_up(&[effect], &[0.5], &[each; 2], context);
        // A lead of three nats with an error of three nats has a relative likelihood of exp(−1/2). One of 18 is out of reach.
        let rivals = vec![fit(&LONGER, 10.0), fit(&LONGER_TO_THE_LEFT, 8.5), fit(&FARTHER, 1.0)];
        let slots = vec![slot(rivals, context)];
        let found = Confirmed { slots, ..confirmed(&[&LONGER], &[10.0; 2], context) };
        let effects = effects_of(concluded(&found), Verdict::Known);
        assert_eq!(effects[0].ambiguous_with, ["longer_to_the_left"]);
        let doubt = libm::exp(-0.5) + libm::exp(-18.0);
        let expected = logistic(5.0) * 0.9 * logistic(4.0) / (1.0 + doubt);
        assert!((effects[0].probability - expected).abs() < 1e-12, "{} {expected}", effects[0].probability);
    });
}

const LATENCY: Effect = Effect { id: "latency", ..LONGER };
const TRACKER_DELAY: Effect = Effect { id: "tracker_delay", ..LONGER };

#[test]
fn old_poses_are_named_as_rivals_and_leave_no_doubt_about_a_delay() {
    with_two_rows(|context| {
        let fit = |effect: &'static Effect| made_up(&[effect], &[0.5], &[10.0; 2], context);
        let effects = |effect: &'static Effect, rival: &'static Effect| {
            let slots = vec![slot(vec![fit(effect), fit(rival)], context)];
            effects_of(concluded(&Confirmed { slots, ..confirmed(&[effect], &[10.0; 2], context) }), Verdict::Known)
        };
        let [late, longer] = [effects(&LATENCY, &TRACKER_DELAY), effects(&LONGER, &TRACKER_DELAY)];
        assert_eq!([&late[0].ambiguous_with, &longer[0].ambiguous_with], [&["tracker_delay"]; 2]);
        assert!((late[0].probability - 2.0 * longer[0].probability).abs() < 1e-12);
    });
}

#[test]
fn more_probable_effect_is_named_first() {
    with_two_rows(|context| {
        let rival = made_up(&[&FARTHER, &LONGER_TO_THE_LEFT], &[0.5; 2], &[9.0; 2], context);
        let slots = vec![slot(vec![rival], context), slot(Vec::new(), context)];
        let found = Confirmed { slots, ..confirmed(&[&LONGER, &FARTHER], &[10.0; 2], context) };
        let effects = effects_of(concluded(&found), Verdict::Known);
        assert_eq!(effects.iter().map(|e| e.id).collect::<Vec<_>>(), ["farther", "longer"]);
        assert!(effects[0].probability > 1.5 * effects[1].probability);
    });
}

#[test]
fn gap_that_no_effect_explains_is_unknown() {
    with_two_rows(|context| {
        let verdict = |effects: &[&'static Effect], gained: f64, left: f64| {
            let left = vec![remainder(Channel::Forward, left, context)];
            concluded(&leaving(effects, gained, left, context)).verdict
        };
        assert_eq!(verdict(&[], 0.0, 10.0), Verdict::Unknown);
        // 80 % have to be explained.
        assert_eq!(verdict(&[&LONGER], 79.0, 21.0), Verdict::Unknown);
        assert_eq!(verdict(&[&LONGER], 90.0, 10.0), Verdict::Known);
    });
}

/// However small it is compared with what the effect explains elsewhere.
#[test]
fn remainder_where_an_effect_explains_nothing_has_another_cause() {
    with_two_rows(|context| {
        let left = |remainders: &[(Channel, f64)]| {
            let left = remainders.iter().map(|(channel, nats)| remainder(*channel, *nats, context)).collect();
            concluded(&leaving(&[&LONGER], 90.0, left, context))
        };
        let forward_and_turn = |forward, turn| left(&[(Channel::Forward, forward), (Channel::Turn, turn)]);
        assert_eq!(forward_and_turn(10.0, 0.0).verdict, Verdict::Known, "model-form error");
        let effects = effects_of(forward_and_turn(0.0, 10.0), Verdict::PartlyKnown);
        let expected = 0.9 * logistic((1.0 - 0.8) / 0.05);
        assert!((effects[0].probability - expected).abs() < 1e-9, "{} {expected}", effects[0].probability);
        assert_eq!(forward_and_turn(30.0, 10.0).verdict, Verdict::Unknown);
        // It explains nothing sideways either, but model-form error of forward motion leaves something there.
        let sideways = |nats| left(&[(Channel::Lateral, nats)]).verdict;
        assert_eq!((sideways(10.0), sideways(30.0)), (Verdict::Known, Verdict::PartlyKnown));
    });
}

/// Confirms an effect that improves paths of this length by a fraction of what it predicts.
fn improving(steps: usize, improvement_ci95: Option<[f64; 2]>, context: &FitContext) -> Confirmed {
    let error = PathError { steps, before_cm: 3.0, after_cm: 3.2, floor_cm: 1.0 };
    Confirmed { paths: vec![Paths { error, improvement_ci95 }], ..leaving(&[&LONGER], 20.0, Vec::new(), context) }
}

#[test]
fn effect_that_open_loop_paths_refute_is_not_the_whole_cause() {
    with_two_rows(|context| {
        let concluded = |steps, improvement_ci95| concluded(&improving(steps, improvement_ci95, context));
        for steps in [2, 5, 10] {
            let effects = effects_of(concluded(steps, Some([-0.3, 0.49])), Verdict::PartlyKnown);
            assert_eq!(effects[0].probability, 0.5, "{steps}");
            let effects = effects_of(concluded(steps, Some([-0.3, 0.51])), Verdict::Known);
            assert!(effects[0].probability > 0.8, "{steps}");
        }
        for (steps, improvement) in [(1, Some([0.0; 2])), (25, Some([0.0; 2])), (5, None)] {
            assert_eq!(concluded(steps, improvement).verdict, Verdict::Known, "{steps}");
        }
    });
}

#[test]
fn refuting_paths_are_noted() {
    with_two_rows(|context| {
        let note = |improvement| predictive_check::note(&improving(5, Some(improvement), context), &CALIBRATION);
        assert!(note([-0.3, 0.1]).is_some_and(|note| note.starts_with("Open-loop paths of 5 steps end 3.20 cm from")));
        assert_eq!(note([0.7, 1.2]), None);
    });
}

/// Concludes with six rivals of the first of these effects, each seven nats behind. They are in reach here, and together as
/// doubtful as one rival of relative likelihood 0.4.
fn with_six_rivals(effects: &[&'static Effect], context: &FitContext) -> Vec<NamedEffect> {
    let rival = |id: &&'static str| {
        let mut fit = made_up(effects, &[0.5; 2][..effects.len()], &[6.5; 2], context);
        fit.hypothesis.candidates[0].effect = id;
        fit
    };
    let slots = vec![slot(["a", "b", "c", "d", "e", "f"].iter().map(rival).collect(), context)];
    let found = Confirmed { slots, ..confirmed(effects, &[10.0; 2], context) };
    let judgement = Judgement { rival_z: 2.45, ..CALIBRATION.judgement };
    let calibration = Calibration { judgement, ..CALIBRATION };
    effects_of(Conclusion::of(&found, &robot(), &calibration), Verdict::Known)
}

/// The gap is explained, though not by which of them.
#[test]
fn ambiguous_effect_is_named_with_all_its_rivals() {
    with_two_rows(|context| {
        let rivals = |effects: Vec<NamedEffect>| -> Vec<(&str, usize)> {
            effects.iter().map(|e| (e.id, e.ambiguous_with.len())).collect()
        };
        assert_eq!(rivals(with_six_rivals(&[&LONGER], context)), [("longer", 6)]);
        assert_eq!(rivals(with_six_rivals(&[&LONGER, &FARTHER], context)), [("farther", 0), ("longer", 6)]);
    });
}

/// An effect explains 79 of a hundred nats of forward motion, where 80 are required. The remaining 21 lie evenly on two blocks, or
/// one block shows 4 more than the other: an error of 4 nats, 3 % of the whole.
#[test]
fn effect_within_the_error_of_adequacy_is_partly_known() {
    with_two_rows(|context| {
        let concluded = |more: f64| {
            let mut left = remainder(Channel::Forward, 21.0, context);
            left.by_block = vec![10.5 - 0.5 * more, 10.5 + 0.5 * more];
            concluded(&leaving(&[&LONGER], 79.0, vec![left], context))
        };
        assert_eq!(concluded(0.0).verdict, Verdict::Unknown);
        let effects = effects_of(concluded(4.0), Verdict::PartlyKnown);
        let width = libm::hypot(0.05, LOGISTIC_SCALE * 0.79 * 0.04);
        let expected = 0.9 * logistic(-0.01 / width);
        assert!((effects[0].probability - expected).abs() < 1e-9, "{} {expected}", effects[0].probability);
    });
}

/// Makes a named effect without a share.
fn effect(id: &'static str, probability: f64) -> NamedEffect {
    NamedEffect {
        place: None,
        sensor: None,
        id,
        probability,
        parameters: Map::new(),
        ambiguous_with: Vec::new(),
        share: None,
        intervals: Map::new(),
        at_bound: Vec::new(),
        witness: Vec::new(),
        ruler: None,
    }
}

#[test]
fn one_of_several_that_explains_next_to_nothing_is_doubtful() {
    let part = |id: &str, share: f64| Part { id: id.into(), share, ci95: [share; 2], sensor: None };
    let budget = [part("slip", 0.95), part("track_width", 0.05)];
    let both = with_shares(vec![effect("slip", 0.9), effect("track_width", 0.8)], &budget);
    assert_eq!(both.iter().map(|e| (e.id, e.probability)).collect::<Vec<_>>(), [("slip", 0.9), ("track_width", 0.5)]);
    let alone = with_shares(vec![effect("track_width", 0.8)], &budget);
    assert_eq!(alone[0].probability, 0.8, "scatter may be the larger part");
}

#[test]
fn equally_probable_effects_are_sorted_by_share() {
    let part = |id: &str, share: f64| Part { id: id.into(), share, ci95: [share; 2], sensor: None };
    let budget = [part("slope", 0.1), part("latency", 0.2), part("slip", 0.7)];
    let effects = vec![effect("slope", 0.9), effect("latency", 0.901), effect("slip", 0.5)];
    let sorted = with_shares(effects, &budget);
    assert_eq!(sorted.iter().map(|e| e.id).collect::<Vec<_>>(), ["latency", "slope", "slip"]);
    assert_eq!(sorted[0].share, Some(0.2));
}
