use super::*;
use crate::gap::hypothesis::log_density;
use crate::gap::test_support::*;

fn gain(by_block: &[f64]) -> [f64; 2] {
    let Gain { nats, error } = Gain::of(by_block);
    [nats, error]
}

/// Blocks of rows whose forward residuals are their mean plus and minus `spread`.
fn scattered(means: &'static [f64], rows: usize, spread: f64) -> Observations {
    observations(means.len(), rows, move |block, at| Made {
        off: [means[block] + spread * alternating(at), 0.0, 0.0],
        ..Made::default()
    })
}

/// The sample variance of 1, 3 and 5 is 4; three blocks of that add up to 12.
#[test]
fn a_gain_is_the_sum_and_its_error_that_of_independent_blocks() {
    assert_eq!(gain(&[1.0, 3.0, 5.0]), [9.0, 12f64.sqrt()]);
    assert_eq!(gain(&[2.0; 8]), [16.0, 0.0]);
    assert_eq!(gain(&[7.0]), [7.0, 0.0]);
}

#[test]
fn a_gate_asks_for_both_nats_and_standard_errors() {
    let gate = Gate { nats: 9.0, z: 2.5 };
    assert!(Gain { nats: 9.0, error: 3.6 }.passes(&gate));
    assert!(!Gain { nats: 8.9, error: 0.1 }.passes(&gate));
    assert!(!Gain { nats: 9.0, error: 3.7 }.passes(&gate));
}

/// Residuals of variance one about 0.2 in 400 rows and a prior of deviation 0.05 about zero weigh 400 each: the maximum a
/// posteriori is half of the mean. Without a prior it is the mean.
#[test]
fn a_fit_is_the_weighted_mean_of_rows_and_prior() {
    let (baseline, rows) = (baseline(), scattered(&[0.2; 8], 50, 1.0));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let fitted = |effect| Fitted::none(&context).with(candidate(effect), &context).values[0];
    // A fit ends within a tenth of a nat of its maximum: √(0.2 / 800) cm.
    assert!((fitted(&SLIGHTLY_LONGER) - 0.1).abs() < 0.016, "{}", fitted(&SLIGHTLY_LONGER));
    assert!((fitted(&LONGER) - 0.2).abs() < 0.022, "{}", fitted(&LONGER));
}

/// Means of the blocks about 1 deviate by 0.6, rows within them by 0.8: the variance is one.
#[test]
fn a_block_is_judged_by_the_mean_of_the_others() {
    const MEANS: &[f64] = &[1.6, 0.4, 1.6, 0.4, 1.6, 0.4, 1.6, 0.4];
    let (baseline, rows) = (baseline(), scattered(MEANS, 20, 0.8));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let fit = Fitted::none(&context).with(candidate(&LONGER), &context);
    for (block, mean) in MEANS.iter().enumerate() {
        let judged_by = |value: f64| -> f64 {
            let residuals = (0..20).map(|at| mean + 0.8 * alternating(at) - value);
            let other_axes = 20.0 * (log_density(0.0, SCATTER[1]) + log_density(0.0, SCATTER[2]));
            residuals.map(|r| log_density(r, 1.0)).sum::<f64>() + other_axes
        };
        let others = (8.0 - mean) / 7.0;
        let (held_out, by_itself) = (fit.held_out[block], judged_by(1.0));
        assert!((held_out - judged_by(others)).abs() < 0.2, "{held_out} {}", judged_by(others));
        assert!(held_out < by_itself - 0.8, "{held_out} {by_itself}: the block itself is left out");
    }
}

/// Rows that go 0.5 cm too far, with readings that are 2 cm too long.
fn both_stages() -> Observations {
    observations(8, 10, |_, at| Made {
        off: [0.5 + alternating(at), 0.0, 0.0],
        echo_off_cm: Some(2.0 + alternating(at / 2)),
        ..Made::default()
    })
}

#[test]
fn fits_of_separate_stages_combine_to_their_joint_fit() {
    let (baseline, rows) = (baseline_with_sonar(), both_stages());
    let context = FitContext::new(&baseline, &rows, METHOD);
    let alone = |effect| Fitted::none(&context).with(candidate(effect), &context);
    let (longer, farther) = (alone(&LONGER), alone(&FARTHER));
    assert!(longer.is_apart_from(&farther) && !longer.is_apart_from(&alone(&LONGER_TO_THE_LEFT)));
    let joint = longer.with(candidate(&FARTHER), &context);
    for combined in [longer.combined_with(&farther, &context), farther.combined_with(&longer, &context)] {
        let near = |a: f64, b: f64, most: f64| assert!((a - b).abs() < most, "{a} {b}");
        let values_of = |id: &str| combined.values_of(combined.ids().iter().position(|i| *i == id).expect(id))[0];
        // Either fit ends within a tenth of a nat of its maximum.
        near(values_of("longer"), joint.values[0], 0.06);
        near(values_of("farther"), joint.values[1], 0.06);
        let total = |f: &Fitted| f.log_likelihood.total().iter().sum::<f64>();
        near(total(&combined), total(&joint), 0.2);
        near(combined.held_out.iter().sum(), joint.held_out.iter().sum(), 0.2);
        assert!(combined.gain_over(&longer).nats > 10.0 && combined.gain_over(&farther).nats > 5.0);
    }
}

#[test]
fn each_variant_of_what_is_not_there_yet_is_added_once() {
    let (baseline, rows) = (baseline_with_sonar(), both_stages());
    let context = FitContext::new(&baseline, &rows, METHOD);
    let names = |fits: &[Fitted]| -> Vec<Vec<String>> {
        let name = |c: &Candidate| format!("{} {}", c.effect, c.variant.id);
        fits.iter().map(|f| f.hypothesis.candidates.iter().map(name).collect()).collect()
    };
    let none = Fitted::none(&context);
    let alone = none.with_each(None, &context);
    let each = [["longer every_step"], ["longer_to_the_left left_turns"], ["farther length"], ["farther half"]];
    assert_eq!(names(&alone), each);
    let beside = |new| vec!["longer every_step", new];
    let further = [beside("longer_to_the_left left_turns"), beside("farther length"), beside("farther half")];
    assert_eq!(names(&alone[0].with_each(Some(&alone), &context)), further);
    let best = best_of_each(alone, &context.calibration);
    assert_eq!(best.iter().map(|f| f.ids()[0]).collect::<Vec<_>>(), ["farther", "longer", "longer_to_the_left"]);
}

#[test]
fn what_is_left_out_of_a_fit_gives_back_the_others() {
    let (baseline, rows) = (baseline_with_sonar(), both_stages());
    let context = FitContext::new(&baseline, &rows, METHOD);
    let none = Fitted::none(&context);
    let both = none.with(candidate(&FARTHER), &context).with(candidate(&LONGER), &context);
    assert_eq!((both.values_of(0).len(), both.values_of(1)), (1, &both.values[1..]));
    let farther = both.without(1, &context);
    assert_eq!(farther.ids(), ["farther"]);
    assert!((farther.values[0] - both.values[0]).abs() < 0.06);
    assert!(farther.without(0, &context).ids().is_empty());
    assert_eq!(farther.without(0, &context).held_out, none.held_out);
}

/// Of two fits that are as likely, the one with fewer parameters scores more, by the price of a parameter.
#[test]
fn a_parameter_has_its_price() {
    let (baseline, rows) = (baseline(), observations(2, 1, |_, _| Made::default()));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let score = |effects: &[&'static Effect]| {
        made_up(effects, &vec![0.0; effects.len()], &[3.0, 4.0], &context).score(&CALIBRATION)
    };
    assert_eq!((score(&[]), score(&[&LONGER]), score(&[&LONGER, &FARTHER])), (7.0, 6.0, 5.0));
}

#[test]
fn a_stage_is_shared_where_both_move_or_both_sense() {
    let (baseline, rows) = (baseline(), observations(2, 1, |_, _| Made::default()));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let shares =
        |effects: &[&'static Effect]| made_up(effects, &vec![0.0; effects.len()], &[0.0; 2], &context).shares_a_stage();
    assert!(shares(&[&LONGER, &LONGER_TO_THE_LEFT]) && shares(&[&FARTHER, &LONGER, &FARTHER]));
    assert!(!shares(&[]) && !shares(&[&LONGER]) && !shares(&[&LONGER, &FARTHER]));
}

/// What is known already needs no catalogue of the test: effects are found by their ids in the built-in one.
#[test]
fn given_effects_are_taken_as_they_are() {
    let (baseline, rows) = (baseline(), scattered(&[0.5; 8], 4, 0.0));
    let context = FitContext::new(&baseline, &rows, METHOD);
    // Steps of 5 cm that come out 0.5 cm longer.
    let scale = Candidate::named("drive_scale", "distance").expect("in the catalogue");
    let given = Fitted::given(&[AppliedEffect::new(&scale, &[1.1])], &context);
    assert_eq!((given.ids(), given.values.as_slice()), (vec!["drive_scale"], &[1.1][..]));
    let expected = 32.0 * (log_density(0.0, 1.0) - log_density(0.5, 1.0));
    assert!((given.gain_over(&Fitted::none(&context)).nats - expected).abs() < 1e-9);
    assert_eq!(given.applied(), [AppliedEffect::new(&scale, &[1.1])]);
}
