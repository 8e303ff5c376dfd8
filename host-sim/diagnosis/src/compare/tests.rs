use super::*;
use crate::hypothesis::LogLikelihood;
use crate::test_support::*;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_models::effects::{self, Candidate, Effect};
use mindgap_models::simulator::baseline::Baseline;

/// Eight blocks of twelve rows that turn left and right in turn: left turns go `left_cm` too far, right ones
/// `right_cm`, and readings are `echo_cm` too long.
fn rows([left_cm, right_cm]: [f64; 2], echo_cm: f64) -> Observations {
    observations(8, 12, move |_, at| {
        let (command, off_cm) = if at % 2 == 0 { ([40.0, 60.0], left_cm) } else { ([60.0, 40.0], right_cm) };
        let off = [off_cm + 0.9 * alternating(at / 2), 0.0, 0.0];
        let echo_off_cm = Some(echo_cm + alternating(at / 2));
        Made { commands: [command; 2], off, echo_off_cm, ..Made::default() }
    })
}

fn searched(rows: &Observations) -> Vec<&'static str> {
    let baseline = baseline_with_sonar();
    let context = FitContext::new(&baseline, rows, METHOD);
    let none = Fitted::none(&context);
    let alone = none.with_each(None, &context);
    Comparison::search(none, alone, &context).chosen.ids()
}

#[test]
fn nothing_is_found_where_nothing_is() {
    assert!(searched(&rows([0.0, 0.0], 0.0)).is_empty());
}

#[test]
fn the_effect_that_is_there_is_found() {
    assert_eq!(searched(&rows([1.0, 1.0], 0.0)), ["longer"]);
    assert_eq!(searched(&rows([1.5, 0.0], 0.0)), ["longer_to_the_left"]);
}

#[test]
fn a_second_effect_is_added_on_another_stage_and_on_the_same() {
    let mut both = searched(&rows([1.0, 1.0], 3.0));
    both.sort_unstable();
    assert_eq!(both, ["farther", "longer"]);
    let mut both = searched(&rows([3.0, 1.2], 0.0));
    both.sort_unstable();
    assert_eq!(both, ["longer", "longer_to_the_left"]);
}

#[test]
fn a_worse_effect_is_exchanged_for_a_better_one() {
    let (baseline, rows) = (baseline_with_sonar(), rows([1.0, 1.0], 0.0));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let alone = Fitted::none(&context).with_each(None, &context);
    let fit_of = |id: &str| alone.iter().find(|f| f.ids() == [id]).expect(id).clone();
    let (settled_on, places) = settled(fit_of("longer_to_the_left"), &alone, &context);
    assert_eq!(settled_on.ids(), ["longer"]);
    assert_eq!(places.len(), 1);
    assert_eq!(places[0].taken.iter().map(|f| f.ids()[0]).collect::<Vec<_>>(), ["longer", "longer_to_the_left"]);
    assert_eq!(settled(settled_on, &alone, &context).0.ids(), ["longer"], "the best one stays");
}

/// Calls `check` with the context of two rows in two blocks.
fn with_context(check: impl Fn(&FitContext)) {
    let (baseline, rows) = (baseline(), observations(2, 1, |_, _| Made::default()));
    check(&FitContext::new(&baseline, &rows, METHOD));
}

/// A lead of z times √(error² + 3²) nats has the relative likelihood exp(−z²/2).
#[test]
fn relative_likelihood_falls_with_the_lead_in_standard_errors() {
    with_context(|context| {
        let fit = |effect: &'static Effect, held_out: [f64; 2]| made_up(&[effect], &[0.0], &held_out, context);
        let winner = fit(&LONGER, [10.0, 10.0]);
        let against = |held_out| relative_likelihood(&winner, &fit(&FARTHER, held_out), &CALIBRATION);
        assert_eq!(against([10.0, 10.0]), 1.0);
        assert_eq!(against([12.0, 12.0]), 1.0, "a rival is never likelier than the winner");
        assert!((against([8.5, 8.5]) - libm::exp(-0.5)).abs() < 1e-12);
        assert!((against([7.0, 7.0]) - libm::exp(-2.0)).abs() < 1e-12);
        // Leads of 7 and −1 differ from their mean by 4: an error of 8 nats beside the 3 of strong evidence.
        let z_squared = 6.0 * 6.0 / (8.0 * 8.0 + 3.0 * 3.0);
        assert!((against([3.0, 11.0]) - libm::exp(-0.5 * z_squared)).abs() < 1e-12);
        // The price of freedom counts.
        let more = Fitted { occam: -1.0, ..fit(&FARTHER, [10.0, 10.0]) };
        let z = 1.0 / 3.0;
        assert!((relative_likelihood(&winner, &more, &CALIBRATION) - libm::exp(-0.5 * z * z)).abs() < 1e-12);
    });
}

/// In reach is what lags by two standard errors at most: six nats where all blocks agree.
#[test]
fn rivals_in_reach_are_counted() {
    with_context(|context| {
        let fit = |effect: &'static Effect, each: f64| made_up(&[effect], &[0.0], &[each; 2], context);
        let chosen = fit(&LONGER, 10.0);
        let count = |rivals: &[Fitted]| rivals_in_reach(&chosen, rivals, &CALIBRATION);
        assert_eq!(count(&[]), 0);
        assert_eq!(count(&[fit(&LONGER, 10.0)]), 0, "the effect itself is no rival");
        assert_eq!(count(&[fit(&FARTHER, 7.1), fit(&LONGER_TO_THE_LEFT, 6.9)]), 1);
    });
}

/// With more than three others in reach an effect has to gain twice as much.
#[test]
fn an_effect_for_which_many_can_stand_counts_half() {
    with_context(|context| {
        let fit = |effect: &'static Effect, each: f64| made_up(&[effect], &[0.0], &[each; 2], context);
        let none = made_up(&[], &[], &[0.0; 2], context);
        let nats = |singles: &[Fitted]| most_alone(singles, &none, context).nats;
        assert_eq!(nats(&[]), 0.0);
        let others = |count: usize, each: f64| {
            let other = |id: &&'static str| {
                let mut other = fit(&FARTHER, each);
                other.hypothesis.candidates[0].effect = id;
                other
            };
            let first = [fit(&LONGER, 10.0)].into_iter();
            first.chain(["a", "b", "c", "d"][..count].iter().map(other)).collect::<Vec<Fitted>>()
        };
        assert_eq!(nats(&others(3, 9.0)), 20.0);
        assert_eq!(nats(&others(4, 9.0)), 10.0);
        assert_eq!(nats(&others(4, 1.0)), 20.0);
    });
}

/// A fit of two rows whose log-likelihoods are these of forward motion and of readings each, so that they gain it as well.
fn of_channels(effects: &[&'static Effect], [forward, reading]: [f64; 2], context: &FitContext) -> Fitted {
    let fit = made_up(effects, &vec![0.0; effects.len()], &[forward + reading; 2], context);
    let log_likelihood = LogLikelihood { motion: vec![[forward, 0.0, 0.0]; 2], sonar: vec![[0.0, reading]; 2] };
    Fitted { log_likelihood, ..fit }
}

/// In a channel of which a hundred nats are explained a further effect has to gain eight besides what counts (five), and
/// where nothing is explained that alone. Both blocks gain the same here.
#[test]
fn a_further_effect_has_to_gain_more_where_others_explain_much() {
    with_context(|context| {
        let none = of_channels(&[], [0.0; 2], context);
        let so_far = of_channels(&[&LONGER], [50.0, 0.0], context);
        let worth = |more: [f64; 2]| {
            let fit = of_channels(&[&LONGER, &FARTHER], [50.0 + more[0], more[1]], context);
            is_worth_adding(&fit, &so_far, &none, CALIBRATION.further_share, context)
        };
        assert!(worth([0.0, 2.6]) && !worth([0.0, 2.4]));
        assert!(worth([6.6, 0.0]) && !worth([6.4, 0.0]));
        assert!(worth([1.0, 2.6]) && !worth([1.0, 2.4]), "what could be feigned does not count");
    });
}

/// Steps of seven centimetres where the textbook has five, as a simulator with 1.4 times the speed has them.
#[test]
fn what_effects_explain_that_the_simulator_has_already_is_known() {
    let faster = Candidate::all(effects::CATALOGUE).into_iter().find(|c| c.effect == "drive_scale").expect("an effect");
    let explained = |applied: Vec<AppliedEffect>| {
        let baseline = Baseline { applied, ..baseline() };
        let off = |at| [2.0 + 0.9 * alternating(at), 0.0, 0.0];
        let rows = observations(8, 10, move |_, at| Made { off: off(at), ..Made::default() });
        FitContext::new(&baseline, &rows, METHOD).explained_already
    };
    assert_eq!(explained(Vec::new()), [0.0; 5]);
    let [forward, others @ ..] = explained(vec![AppliedEffect::new(&faster, &[1.4])]);
    assert!(forward > 20.0 && others == [0.0; 4], "{forward} {others:?}");
}

/// Of a thousand nats that they explain eighty could be left over by forms that are not quite right.
#[test]
fn what_forms_of_effects_leave_that_the_simulator_has_already_is_no_effect() {
    let (baseline, rows) = (baseline_with_sonar(), rows([1.0; 2], 0.0));
    let mut context = FitContext::new(&baseline, &rows, METHOD);
    let found = |context: &FitContext| {
        let none = Fitted::none(context);
        let alone = none.with_each(None, context);
        Comparison::search(none, alone, context).chosen.ids()
    };
    assert_eq!(found(&context), ["longer"]);
    context.explained_already[Channel::Forward.index()] = 1000.0;
    assert_eq!(found(&context), [""; 0]);
}

#[test]
fn rivals_are_what_stands_in_the_place_of_an_effect() {
    with_context(|context| {
        let fit = |effects: &[&'static Effect], each: f64| made_up(effects, &[0.0; 2], &[each; 2], context);
        let rivals = vec![
            vec![fit(&[&FARTHER, &LONGER], 20.0), fit(&[&FARTHER, &LONGER_TO_THE_LEFT], 17.0)],
            vec![fit(&[&LONGER, &FARTHER], 20.0), fit(&[&LONGER, &LONGER_TO_THE_LEFT], 12.0)],
        ];
        let chosen = fit(&[&LONGER, &FARTHER], 20.0);
        let found = Comparison { chosen, rivals, ..comparison(&[], &[0.0; 2], context) };
        let in_place = |place| found.likelihoods_in_place_of(place, &CALIBRATION);
        assert_eq!(in_place(0), [("longer_to_the_left", libm::exp(-2.0))]);
        let z = 16.0 / 3.0;
        assert_eq!(in_place(1), [("longer_to_the_left", libm::exp(-0.5 * z * z))]);
        let runner_up = found.runner_up().expect("another fit");
        assert_eq!(runner_up.ids(), ["farther", "longer_to_the_left"]);
    });
}

/// Beside others an effect is as probable as what it gains against what it has to gain: the five of the gate, and what the
/// others could feign.
#[test]
fn an_effect_beside_others_is_as_probable_as_what_it_gains_of_its_own() {
    with_context(|context| {
        let beside = |nats: f64, feigned_nats: f64| {
            let found = comparison(&[&LONGER, &FARTHER], &[50.0; 2], context);
            let first = OwnGain { nats: 90.0, feigned_nats: 0.0 };
            Comparison { own: vec![first, OwnGain { nats, feigned_nats }], ..found }
                .probability_beside_others(1, &CALIBRATION)
        };
        assert_eq!((beside(13.0, 8.0), beside(39.0, 8.0)), (0.5, 0.75));
        assert_eq!((beside(5.0, 0.0), beside(-3.0, 0.0)), (0.5, 0.0));
        let own = vec![OwnGain { nats: 9.0, feigned_nats: 0.0 }];
        let alone = Comparison { own, ..comparison(&[&LONGER], &[5.0; 2], context) };
        assert_eq!(alone.probability_beside_others(0, &CALIBRATION), 1.0);
    });
}
