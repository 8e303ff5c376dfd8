use super::*;
use crate::residual_law::SCALE_OF_NORMAL;
use crate::residual_law::log_density;
use crate::test_support::*;
use mindgap_foundations::chance::generator;
use mindgap_foundations::statistics::student;
use rand::RngExt;

/// Blocks of rows whose forward residuals are drawn from the law of residuals about their mean, with so much scatter.
fn scattered(means: &'static [f64], rows: usize, scatter: f64) -> Observations {
    let mut rng = generator(7, &[]);
    let drawn: Vec<f64> =
        (0..means.len() * rows).map(|_| SCALE_OF_NORMAL * scatter * student::draw(|| rng.random())).collect();
    observations(means.len(), rows, move |block, at| Made {
        off: [means[block] + drawn[block * rows + at], 0.0, 0.0],
        commands: [if at % 2 == 0 { [40.0, 60.0] } else { [60.0, 40.0] }; 2],
        ..Made::default()
    })
}

/// Residuals of variance one about 0.2 in 400 rows and a prior of deviation 0.05 about zero weigh 400 each: the maximum a
/// posteriori is half of the mean. Without a prior it is the mean.
#[test]
fn a_fit_is_the_weighted_mean_of_rows_and_prior() {
    let (baseline, rows) = (baseline(), scattered(&[0.2; 8], 50, 1.0));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let fitted = |effect| Fitted::none(&context).with(candidate(effect), &context).values[0];
    let (with_prior, without) = (fitted(&SLIGHTLY_LONGER), fitted(&LONGER));
    // Two standard errors of 400 rows, and what a fit may be off that ends within a tenth of a nat of its maximum.
    assert!((without - 0.2).abs() < 0.12, "{without}");
    assert!((with_prior - 0.5 * without).abs() < 0.02, "{with_prior} {without}");
}

/// Every third of 4000 rows is sketched on: what is fitted then is fitted to all, the mean of all residuals.
#[test]
fn a_fit_to_many_rows_is_a_fit_to_all_of_them() {
    let (baseline, rows) = (baseline(), scattered(&[0.2; 8], 500, 1.0));
    let context = FitContext::new(&baseline, &rows, METHOD);
    assert!(context.few.as_ref().is_some_and(|few| few.rows.rows.len() < 1500));
    let fit = Fitted::none(&context).with(candidate(&LONGER), &context);
    let likelihood = |value: f64| fit.hypothesis.log_likelihood(&baseline, &rows, &[value], None).total().iter().sum();
    let found: f64 = likelihood(fit.values[0]);
    // A grid of a tenth of the standard error about the truth holds nothing that is more likely.
    for off in -20..=20 {
        let on_grid: f64 = likelihood(0.2 + 0.0016 * f64::from(off));
        assert!(on_grid < found + TOLERANCE_NATS, "{on_grid} at {off}, {found} at {}", fit.values[0]);
    }
}

/// Means of the blocks about 1 deviate by 0.6: a block is judged by the parameter that the other seven have.
#[test]
fn a_block_is_judged_by_the_fit_to_the_others() {
    const MEANS: &[f64] = &[1.6, 0.4, 1.6, 0.4, 1.6, 0.4, 1.6, 0.4];
    let (baseline, rows) = (baseline(), scattered(MEANS, 20, 0.8));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let fit = Fitted::none(&context).with(candidate(&LONGER), &context);
    let scatter = fit.hypothesis.scatter(&baseline, &rows, &fit.values);
    for block in 0..MEANS.len() {
        let judged_by = |value: f64| -> f64 {
            let all = fit.hypothesis.log_likelihood_with(scatter, &baseline, &rows, &[value]);
            rows.by_block(&all.total())[block]
        };
        let best = (0..200).map(|i| 0.01 * f64::from(i)).max_by(|a, b| {
            let others = |value: f64| {
                (0..8)
                    .filter(|b| *b != block)
                    .map(|b| {
                        let all = fit.hypothesis.log_likelihood_with(scatter, &baseline, &rows, &[value]);
                        rows.by_block(&all.total())[b]
                    })
                    .sum::<f64>()
            };
            others(*a).total_cmp(&others(*b))
        });
        let exact = judged_by(best.expect("a grid"));
        assert!((fit.held_out[block] - exact).abs() < 0.3, "{} {exact}", fit.held_out[block]);
        assert!(fit.held_out[block] < judged_by(fit.values[0]) - 0.3, "the block itself is left out");
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
        assert!(combined.gain_over(&longer).nats > 5.0 && combined.gain_over(&farther).nats > 2.0);
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
    let best = best_of_each(alone);
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

/// The evidence of one and of two parameters against sums over a fine grid of all that the priors allow. Rows are
/// independent, so that it does not matter that blocks are its unit.
#[test]
fn the_evidence_is_the_likelihood_under_all_values() {
    let (baseline, rows) = (baseline(), scattered(&[0.3; 48], 10, 1.0));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let none = Fitted::none(&context);
    let value = |fit: &Fitted, at: &[f64]| {
        let rows = fit.hypothesis.log_likelihood(context.baseline, context.observations, at, None).total();
        rows.iter().sum::<f64>() + fit.hypothesis.log_prior(at) + fit.hypothesis.log_prior_peak()
    };
    let log_sum = |values: &[f64], cell: f64| {
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        most + libm::log(values.iter().map(|v| libm::exp(v - most)).sum::<f64>() * cell)
    };
    let grid =
        |fit: &Fitted, i: usize| -> Vec<f64> { (-40..=40).map(|k| fit.values[i] + 0.02 * f64::from(k)).collect() };

    let one = none.with(candidate(&LONGER), &context);
    let exact = log_sum(&grid(&one, 0).iter().map(|x| value(&one, &[*x])).collect::<Vec<f64>>(), 0.02);
    assert!((one.log_evidence() - exact).abs() < 0.6, "{} {exact}", one.log_evidence());

    let both = one.with(candidate(&LONGER_TO_THE_LEFT), &context);
    let points = grid(&both, 0).into_iter().flat_map(|x| grid(&both, 1).into_iter().map(move |y| [x, y]));
    let exact = log_sum(&points.map(|at| value(&both, &at)).collect::<Vec<f64>>(), 0.02 * 0.02);
    assert!((both.log_evidence() - exact).abs() < 0.9, "{} {exact}", both.log_evidence());
}

/// Freedom that explains nothing costs: the prior allows values over ten centimetres of which the rows leave a few
/// millimetres.
#[test]
fn freedom_that_explains_nothing_costs() {
    let (baseline, rows) = (baseline(), scattered(&[0.0; 8], 50, 1.0));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let none = Fitted::none(&context);
    let gain = |effect| none.with(candidate(effect), &context).gain_over(&none).nats;
    assert!(
        gain(&LONGER) < -3.0 && gain(&LONGER) < gain(&SLIGHTLY_LONGER),
        "{} {}",
        gain(&LONGER),
        gain(&SLIGHTLY_LONGER)
    );
}

/// A row tells 1.02 squared inverse deviations of its law's middle: 480 rows leave a standard error of 0.045.
#[test]
fn an_interval_is_two_standard_errors_to_either_side() {
    let (baseline, rows) = (baseline(), scattered(&[0.3; 48], 10, 1.0));
    let context = FitContext::new(&baseline, &rows, METHOD);
    let fit = Fitted::none(&context).with(candidate(&LONGER), &context);
    assert!((fit.errors[0] / 0.045 - 1.0).abs() < 0.3, "{}", fit.errors[0]);
    let [low, high] = fit.interval(0);
    assert!((0.5 * (low + high) - fit.values[0]).abs() < 1e-9 && ((high - low) / fit.errors[0] - 3.92).abs() < 1e-9);
}

/// What is known already needs no catalogue of the test: effects are found by their ids in the built-in one.
#[test]
fn given_effects_are_taken_as_they_are() {
    let (baseline, rows) = (baseline(), observations(8, 4, |_, _| Made { off: [0.5, 0.0, 0.0], ..Made::default() }));
    let context = FitContext::new(&baseline, &rows, METHOD);
    // Steps of 5 cm that come out 0.5 cm longer.
    let scale = Candidate::named("drive_scale", "distance").expect("in the catalogue");
    let given = Fitted::given(&[AppliedEffect::new(&scale, &[1.1])], &context);
    assert_eq!((given.ids(), given.values.as_slice()), (vec!["drive_scale"], &[1.1][..]));
    let expected = 32.0 * (log_density(0, 0.0, 1.0) - log_density(0, 0.5, 1.0));
    assert!((given.gain_over(&Fitted::none(&context)).nats - expected).abs() < 1e-9);
    assert_eq!(given.applied(), [AppliedEffect::new(&scale, &[1.1])]);
}
