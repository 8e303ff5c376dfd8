use super::*;
use crate::gain::Gain;
use crate::sample::Identification;
use crate::slot::FurtherGain;
use crate::test_support::*;
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_models::effects::Effect;
use mindgap_models::simulator::baseline::Baseline;

/// Blocks of rows that go `off_cm` too far.
fn longer_by(off_cm: f64, blocks: usize) -> Observations {
    let off = move |at| [off_cm + 0.9 * alternating(at), 0.0, 0.0];
    observations(blocks, 10, move |_, at| Made { off: off(at), ..Made::default() })
}

/// Confirms `longer`, found on rows that go one centimetre too far, on held-out rows that go `held_out_cm` too far.
fn confirmed_on(held_out_cm: f64, check: impl Fn(Confirmed)) {
    let baseline = baseline();
    let rows = identification(&baseline, longer_by(1.0, 8));
    let hold_out = HoldOut::new(&baseline, longer_by(held_out_cm, 2));
    let context = FitContext::new(&rows, METHOD);
    let search = Fits::of(&context).search(&context);
    assert_eq!(search.chosen.ids(), ["longer"]);
    check(search.confirm(&context, Some(&hold_out)));
}

#[test]
fn effect_that_held_out_runs_show_is_confirmed() {
    confirmed_on(1.0, |found| assert_eq!((found.chosen.ids(), found.slots.len()), (vec!["longer"], 1)));
}

/// Twenty expected rows lose ten nats by one centimetre more, and rows that go half of it too far gain nothing.
#[test]
fn effect_that_gains_nothing_on_held_out_runs_is_dropped() {
    for held_out_cm in [0.0, 0.5] {
        confirmed_on(held_out_cm, |found| {
            assert!(found.chosen.ids().is_empty() && found.slots.is_empty());
            assert_eq!(found.chosen.cross_validated, found.fits.null.cross_validated);
            // What it explained is unexplained now, and held-out runs do not show that either.
            assert!(!found.beyond_chosen.is_empty() && !found.beyond_chosen.iter().any(Remainder::counts));
            // All rows together still speak for it.
            let [Unconfirmed { id, found_nats, confirmed_nats, .. }] = found.unconfirmed[..] else {
                panic!("one effect")
            };
            assert_eq!(id, "longer");
            assert!(found_nats > 20.0 && confirmed_nats < 3.0, "{found_nats} {confirmed_nats}");
        });
    }
}

/// Held-out rows so much against an effect that all rows together do not speak for it leave nothing to report.
#[test]
fn effect_that_held_out_runs_refute_is_forgotten() {
    confirmed_on(-3.0, |found| assert!(found.chosen.ids().is_empty() && found.unconfirmed.is_empty()));
}

/// The effect shows in left turns, and no held-out step turns left.
#[test]
fn effect_that_held_out_runs_do_not_excite_stays() {
    let steps = |blocks, commands: [[f64; 2]; 2]| {
        observations(blocks, 10, move |_, at| {
            let now = commands[at % 2];
            let off_cm = if now == SPIN { 2.0 } else { 0.0 };
            Made { commands: [now; 2], off: [off_cm + 0.9 * alternating(at / 2), 0.0, 0.0], ..Made::default() }
        })
    };
    let baseline = baseline();
    let rows = identification(&baseline, steps(8, [STRAIGHT, SPIN]));
    let hold_out = HoldOut::new(&baseline, steps(2, [STRAIGHT; 2]));
    let context = FitContext::new(&rows, METHOD);
    let found = Fits::of(&context).search(&context).confirm(&context, Some(&hold_out));
    assert_eq!((found.chosen.ids(), found.unconfirmed), (vec!["longer_to_the_left"], Vec::new()));
}

/// All steps go one centimetre too far, and left turns two more; on held-out runs likewise or not.
#[test]
fn effect_that_gains_nothing_next_to_the_others_on_held_out_runs_is_dropped() {
    let longer_by = |off_cm: [f64; 2], blocks| {
        observations(blocks, 10, move |_, at| Made {
            commands: [if at < 5 { STRAIGHT } else { SPIN }; 2],
            off: [off_cm[at / 5] + 0.9 * alternating(at), 0.0, 0.0],
            ..Made::default()
        })
    };
    let baseline = baseline();
    let rows = identification(&baseline, longer_by([1.0, 3.0], 8));
    let context = FitContext::new(&rows, METHOD);
    let fits = Fits::of(&context);
    let found = |held_out_cm| {
        let search = fits.clone().search(&context);
        assert_eq!(search.chosen.ids().len(), 2);
        search.confirm(&context, Some(&HoldOut::new(&baseline, longer_by(held_out_cm, 4))))
    };
    assert_eq!(found([1.0, 3.0]).chosen.ids().len(), 2);
    let fewer = found([2.0, 2.0]);
    assert_eq!((fewer.chosen.ids(), fewer.slots.len()), (vec!["longer"], 1));
    assert_eq!(found([0.0, 0.0]).chosen.ids(), [""; 0]);
}

/// Eight of ten steps turn left and go three centimetres too far, the others one. Of the held-out steps hardly any is straight,
/// and left turns go 2.5 cm too far. Neither effect gains anything next to the other there, and 2.6 cm more for every step does
/// better than 3 cm more to the left.
#[test]
fn of_two_exchangeable_effects_the_one_that_all_runs_show_stays() {
    let steps = |blocks, rows, straight: usize, off_cm: [f64; 2]| {
        observations(blocks, rows, move |_, at| {
            let (commands, off_cm) = if at < straight { (STRAIGHT, off_cm[0]) } else { (SPIN, off_cm[1]) };
            Made { commands: [commands; 2], off: [off_cm + 0.5 * alternating(at), 0.0, 0.0], ..Made::default() }
        })
    };
    let baseline = baseline();
    let rows = identification(&baseline, steps(8, 10, 2, [1.0, 3.0]));
    let hold_out = HoldOut::new(&baseline, steps(1, 62, 2, [0.2, 2.5]));
    let context = FitContext::new(&rows, METHOD);
    let null = Fitted::null(&context);
    let nats = |fit: &Fitted| fit.predict(&hold_out).total();
    let alone = |effect| null.with(candidate(effect), &context);
    let both = alone(&LONGER).with(candidate(&LONGER_TO_THE_LEFT), &context);
    assert!(nats(&alone(&LONGER)) > nats(&alone(&LONGER_TO_THE_LEFT)));
    assert!(nats(&alone(&LONGER_TO_THE_LEFT)) > nats(&both));
    assert_eq!(weigh(&both, &null, &context, &hold_out).chosen.ids(), ["longer_to_the_left"]);
}

#[test]
fn without_held_out_runs_every_effect_stays() {
    let baseline = baseline();
    let rows = identification(&baseline, longer_by(1.0, 8));
    let context = FitContext::new(&rows, METHOD);
    assert_eq!(Fits::of(&context).search(&context).confirm(&context, None).chosen.ids(), ["longer"]);
}

#[test]
fn rivals_take_the_slot_of_an_effect() {
    with_two_rows(|context| {
        let fit = |effects: &[&'static Effect], each: f64| made_up(effects, &[0.0; 2], &[each; 2], context);
        let slot = |rivals: Vec<Fitted>| Slot { rivals, ..slot_with_gain(20.0, 0.0, context) };
        let slots = vec![
            slot(vec![fit(&[&FARTHER, &LONGER], 20.0), fit(&[&FARTHER, &LONGER_TO_THE_LEFT], 17.0)]),
            slot(vec![fit(&[&LONGER, &FARTHER], 20.0), fit(&[&LONGER, &LONGER_TO_THE_LEFT], 12.0)]),
        ];
        let found = Confirmed { chosen: fit(&[&LONGER, &FARTHER], 20.0), slots, ..confirmed(&[], &[0.0; 2], context) };
        assert_eq!(found.rival_likelihoods(0, &CALIBRATION), [("longer_to_the_left", libm::exp(-2.0))]);
        let z = 16.0 / 3.0;
        assert_eq!(found.rival_likelihoods(1, &CALIBRATION), [("longer_to_the_left", libm::exp(-0.5 * z * z))]);
        assert_eq!(found.runner_up().expect("a rival").ids(), ["farther", "longer_to_the_left"]);
    });
}

fn slot_with_gain(nats: f64, form_error_nats: f64, context: &FitContext) -> Slot {
    let gain = FurtherGain { gain: Gain { nats, ..Gain::NONE }, form_error_nats };
    Slot { without: made_up(&[], &[], &[0.0; 2], context), rivals: Vec::new(), gain }
}

/// The odds are those of the gain to the five nats of the gate and the possible form error.
#[test]
fn probability_next_to_others_follows_the_further_gain() {
    with_two_rows(|context| {
        let probability = |nats: f64, form_error_nats: f64| {
            let slots = vec![slot_with_gain(90.0, 0.0, context), slot_with_gain(nats, form_error_nats, context)];
            Confirmed { slots, ..confirmed(&[&LONGER, &FARTHER], &[50.0; 2], context) }
                .probability_next_to_others(1, &CALIBRATION)
        };
        assert_eq!((probability(13.0, 8.0), probability(39.0, 8.0)), (0.5, 0.75));
        assert_eq!((probability(5.0, 0.0), probability(-3.0, 0.0)), (0.5, 0.0));
        let slots = vec![slot_with_gain(9.0, 0.0, context)];
        let alone = Confirmed { slots, ..confirmed(&[&LONGER], &[5.0; 2], context) };
        assert_eq!(alone.probability_next_to_others(0, &CALIBRATION), 1.0);
    });
}

/// Returns the open-loop paths of rows for an effect of one centimetre per step.
fn paths_of(rows: &Identification) -> Vec<Paths> {
    let context = FitContext::new(rows, METHOD);
    let mut found = confirmed(&[&LONGER], &vec![10.0; rows.blocks], &context);
    found.chosen.values = vec![1.0];
    found.chosen.noise = found.chosen.hypothesis.noise(rows, &[1.0]);
    paths(&found.fits.null, &found.chosen, &context, rows)
}

/// Returns paths of five steps if every step goes 5 cm and `off_cm` more. One pose of the first run is thrown by `thrown_cm`.
fn five_steps(off_cm: fn(usize) -> f64, thrown_cm: f64) -> Paths {
    let baseline: Baseline = baseline();
    let rows = observations(8, 20, move |block, at| {
        let gone_cm: f64 = (0..at).map(|step| 5.0 + off_cm(step)).sum();
        let thrown_cm = if (block, at) == (0, 9) { thrown_cm } else { 0.0 };
        let pose = Pose::new(20.0 + gone_cm, 100.0 + thrown_cm, 0.0);
        Made { pose, off: [off_cm(at), 0.0, 0.0], ..Made::default() }
    });
    let rows = identification(&baseline, rows);
    paths_of(&rows).into_iter().find(|paths| paths.error.steps == 5).expect("paths")
}

/// All steps go one centimetre too far; or four of five do, and the fifth goes four too short, so that five steps end where the
/// simulator says and one centimetre more takes them away from there.
#[test]
fn open_loop_paths_confirm_or_refute_effects() {
    let Paths { error, improvement_ci95 } = five_steps(|_| 1.0, 0.0);
    assert!((error.before_cm - 5.0).abs() < 1e-9 && error.after_cm < 1e-9, "{error:?}");
    assert!(improvement_ci95.is_some_and(|[low, _]| low > 0.9), "{improvement_ci95:?}");
    let Paths { error, improvement_ci95 } = five_steps(|at| if at % 5 == 4 { -4.0 } else { 1.0 }, 0.0);
    assert!(error.before_cm < 1e-9 && (error.after_cm - 5.0).abs() < 1e-9, "{error:?}");
    assert!(improvement_ci95.is_some_and(|[_, high]| high < 0.0), "{improvement_ci95:?}");
}

#[test]
fn wild_pose_hardly_changes_the_improvement_of_paths() {
    let improvement_ci95 = five_steps(|_| 1.0, 1e9).improvement_ci95;
    assert!(improvement_ci95.is_some_and(|[low, _]| low > 0.8), "{improvement_ci95:?}");
}

#[test]
fn paths_of_few_runs_have_no_interval() {
    let baseline = baseline();
    let paths = paths_of(&identification(&baseline, longer_by(1.0, 3)));
    assert!(!paths.is_empty() && paths.iter().all(|paths| paths.improvement_ci95.is_none()));
}
