use super::*;
use crate::test_support::*;
use mindgap_foundations::channel::Channel;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::{self, Candidate, Effect};
use mindgap_models::simulator::baseline::Baseline;

/// Eight blocks of twelve rows that turn left and right alternately: left turns go `left_cm` too far, right turns `right_cm`,
/// and readings are `echo_cm` too long.
fn rows([left_cm, right_cm]: [f64; 2], echo_cm: f64) -> Observations {
    observations(8, 12, move |_, at| {
        let (command, off_cm) = if at % 2 == 0 { ([40.0, 60.0], left_cm) } else { ([60.0, 40.0], right_cm) };
        let off = [off_cm + 0.9 * alternating(at / 2), 0.0, 0.0];
        let echo_off_cm = Some(echo_cm + alternating(at / 2));
        Made { commands: [command; 2], off, echo_off_cm, ..Made::default() }
    })
}

/// Returns the effects that a search finds, sorted by id.
fn found(observations: Observations) -> Vec<&'static str> {
    let baseline = baseline_with_sonar();
    let rows = identification(&baseline, observations);
    let context = FitContext::new(&rows, METHOD);
    let mut ids = Fits::of(&context).search(&context).chosen.ids();
    ids.sort_unstable();
    ids
}

#[test]
fn no_effect_is_found_without_a_gap() {
    assert!(found(rows([0.0, 0.0], 0.0)).is_empty());
}

#[test]
fn true_effect_is_found() {
    assert_eq!(found(rows([1.0, 1.0], 0.0)), ["longer"]);
    assert_eq!(found(rows([1.5, 0.0], 0.0)), ["longer_to_the_left"]);
}

#[test]
fn second_effect_is_added_in_other_channels_and_in_the_same() {
    assert_eq!(found(rows([1.0, 1.0], 3.0)), ["farther", "longer"]);
    assert_eq!(found(rows([3.0, 1.2], 0.0)), ["longer", "longer_to_the_left"]);
}

#[test]
fn worse_effect_is_swapped_for_a_better_one() {
    let baseline = baseline_with_sonar();
    let rows = identification(&baseline, rows([1.0, 1.0], 0.0));
    let context = FitContext::new(&rows, METHOD);
    let fits = Fits::of(&context);
    let neighbours = Neighbours::default();
    let selection = Selection::new(&fits, &neighbours, &context);
    let worse = fits.singles.iter().find(|f| f.ids() == ["longer_to_the_left"]).expect("a fit").clone();
    let (swapped, slots) = selection.swap_best(worse);
    assert_eq!(swapped.ids(), ["longer"]);
    assert_eq!(slots.len(), 1);
    assert_eq!(slots[0].rivals.iter().map(|f| f.ids()[0]).collect::<Vec<_>>(), ["longer", "longer_to_the_left"]);
    assert_eq!(selection.swap_best(swapped).0.ids(), ["longer"], "the best one stays");
}

/// With more than three others in reach an effect has to gain twice as much.
#[test]
fn ambiguous_effect_counts_half() {
    with_two_rows(|context| {
        let fit = |effect: &'static Effect, each: f64| made_up(&[effect], &[0.0], &[each; 2], context);
        let gain = |singles: Vec<Fitted>| {
            let null = made_up(&[], &[], &[0.0; 2], context);
            Fits { null, singles }.best_single(context).nats
        };
        assert_eq!(gain(Vec::new()), 0.0);
        let with_others = |count: usize, each: f64| {
            let other = |id: &&'static str| {
                let mut other = fit(&FARTHER, each);
                other.hypothesis.candidates[0].effect = id;
                other
            };
            let first = [fit(&LONGER, 10.0)].into_iter();
            first.chain(["a", "b", "c", "d"][..count].iter().map(other)).collect::<Vec<Fitted>>()
        };
        assert_eq!(gain(with_others(3, 9.0)), 20.0);
        assert_eq!(gain(with_others(4, 9.0)), 10.0);
        assert_eq!(gain(with_others(4, 1.0)), 20.0);
    });
}

/// A fit of two rows with these log-likelihoods per row of forward motion and of readings.
fn by_channel(effects: &[&'static Effect], [forward, reading]: [f64; 2], context: &FitContext) -> Fitted {
    let fit = made_up(effects, &vec![0.0; effects.len()], &[forward + reading; 2], context);
    let scores = fit.scores.clone().with(Channel::Forward, &[forward; 2]).with(Channel::EchoValue, &[reading; 2]);
    Fitted { scores, ..fit }
}

/// In a channel with a hundred explained nats a further effect has to gain eight more than the gate of five, and in a channel
/// without any just the gate. Both blocks gain the same.
#[test]
fn further_effect_has_to_exceed_model_form_error() {
    with_two_rows(|context| {
        let fits = Fits { null: by_channel(&[], [0.0; 2], context), singles: Vec::new() };
        let neighbours = Neighbours::default();
        let selection = Selection::new(&fits, &neighbours, context);
        let so_far = by_channel(&[&LONGER], [50.0, 0.0], context);
        let is_worth = |more: [f64; 2]| {
            let fit = by_channel(&[&LONGER, &FARTHER], [50.0 + more[0], more[1]], context);
            selection.is_worth_adding(&fit, &so_far)
        };
        assert!(is_worth([0.0, 2.6]) && !is_worth([0.0, 2.4]));
        assert!(is_worth([6.6, 0.0]) && !is_worth([6.4, 0.0]));
        assert!(is_worth([1.0, 2.6]) && !is_worth([1.0, 2.4]), "possible form error does not count");
    });
}

/// Steps are seven centimetres where the textbook expects five, as a simulator with 1.4 times the speed does.
#[test]
fn nats_explained_by_the_simulator_s_own_effects_are_known() {
    let faster = Candidate::all(effects::CATALOGUE).into_iter().find(|c| c.effect == "drive_scale").expect("an effect");
    let explained = |applied: Vec<AppliedEffect>| {
        let baseline = Baseline { applied, ..baseline() };
        let off = |at| [2.0 + 0.9 * alternating(at), 0.0, 0.0];
        let rows =
            identification(&baseline, observations(8, 10, move |_, at| Made { off: off(at), ..Made::default() }));
        FitContext::new(&rows, METHOD).already_explained
    };
    assert_eq!(explained(Vec::new()), [0.0; Channel::COUNT]);
    let [forward, others @ ..] = explained(vec![AppliedEffect::new(&faster, &[1.4], &robot())]);
    assert!(forward > 20.0 && others == [0.0; Channel::COUNT - 1], "{forward} {others:?}");
}

/// Of a thousand nats that the simulator's own effects explain, eighty could be their model-form error.
#[test]
fn form_error_of_the_simulator_s_own_effects_is_no_effect() {
    let baseline = baseline_with_sonar();
    let rows = identification(&baseline, rows([1.0; 2], 0.0));
    let mut context = FitContext::new(&rows, METHOD);
    let found = |context: &FitContext| Fits::of(context).search(context).chosen.ids();
    assert_eq!(found(&context), ["longer"]);
    context.already_explained[Channel::Forward.index()] = 1000.0;
    assert_eq!(found(&context), [""; 0]);
}
