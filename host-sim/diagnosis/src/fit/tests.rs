use rand::RngExt;

use super::*;
use crate::noise_model::{SCALE_OF_NORMAL, log_density};
use crate::test_support::*;
use mindgap_foundations::random::generator;
use mindgap_foundations::statistics::student;
use mindgap_learning::evaluation::observations::Observations;

/// Blocks of rows whose forward residuals are drawn from the noise model about a mean per block.
fn scattered(means: &'static [f64], rows: usize, noise: f64) -> Observations {
    let mut rng = generator(7, &[]);
    let drawn: Vec<f64> =
        (0..means.len() * rows).map(|_| SCALE_OF_NORMAL * noise * student::draw(|| rng.random())).collect();
    observations(means.len(), rows, move |block, at| Made {
        off: [means[block] + drawn[block * rows + at], 0.0, 0.0],
        commands: [if at % 2 == 0 { [40.0, 60.0] } else { [60.0, 40.0] }; 2],
        ..Made::default()
    })
}

/// Calls `check` with the context of these rows, without a sensor.
fn in_context(observations: Observations, check: impl Fn(&FitContext)) {
    let baseline = baseline();
    let rows = identification(&baseline, observations);
    check(&FitContext::new(&rows, METHOD));
}

fn fitted(effect: &'static Effect, context: &FitContext) -> Fitted {
    Fitted::null(context).with(candidate(effect), context)
}

/// Residuals of variance one about 0.2 in 400 rows, and a prior about zero with standard deviation 0.05, weigh 400 each: the
/// maximum a posteriori is half of the mean. With a flat prior it is the mean.
#[test]
fn fit_is_the_weighted_mean_of_rows_and_prior() {
    in_context(scattered(&[0.2; 8], 50, 1.0), |context| {
        let [with_prior, flat] = [&SLIGHTLY_LONGER, &LONGER].map(|effect| fitted(effect, context).values[0]);
        // Two standard errors of 400 rows, and the tolerance of a fit that ends within a tenth of a nat.
        assert!((flat - 0.2).abs() < 0.12, "{flat}");
        assert!((with_prior - 0.5 * flat).abs() < 0.02, "{with_prior} {flat}");
    });
}

/// Of 4000 rows every third is in the sketch.
#[test]
fn fit_converges_on_all_of_many_rows() {
    in_context(scattered(&[0.2; 8], 500, 1.0), |context| {
        assert!(context.rows.sketch().is_some_and(|sketch| sketch.sample.rows.len() < 1500));
        let fit = fitted(&LONGER, context);
        let likelihood = |value: f64| fit.hypothesis.scores(context.rows, &[value]).total();
        let found = likelihood(fit.values[0]);
        // A grid of a tenth of the standard error about the truth contains nothing more likely.
        for step in -20..=20 {
            let on_grid = likelihood(0.2 + 0.0016 * f64::from(step));
            assert!(on_grid < found + TOLERANCE_NATS, "{on_grid} at {step}, {found} at {}", fit.values[0]);
        }
    });
}

/// Means of the blocks about 1 have a standard deviation of 0.6.
#[test]
fn block_is_scored_by_the_fit_to_the_others() {
    const MEANS: &[f64] = &[1.6, 0.4, 1.6, 0.4, 1.6, 0.4, 1.6, 0.4];
    in_context(scattered(MEANS, 20, 0.8), |context| {
        let fit = fitted(&LONGER, context);
        let by_block = |value: f64| fit.hypothesis.scores_within(fit.noise, context.rows, &[value]).by_block();
        let cross_validated = fit.cross_validated.by_block();
        for (block, score) in cross_validated.iter().enumerate() {
            let others = |value: f64| by_block(value).iter().sum::<f64>() - by_block(value)[block];
            let grid = (0..200).map(|i| 0.01 * f64::from(i));
            let best = grid.max_by(|a, b| others(*a).total_cmp(&others(*b))).expect("a grid");
            let exact = by_block(best)[block];
            assert!((score - exact).abs() < 0.3, "{score} {exact}");
            assert!(*score < by_block(fit.values[0])[block] - 0.3, "the block itself is left out");
        }
    });
}

/// Calls `check` with the context of rows that go 0.5 cm too far, with readings that are 2 cm too long.
fn in_both_stages(check: impl Fn(&FitContext)) {
    let baseline = baseline_with_sonar();
    let rows = observations(8, 10, |_, at| Made {
        off: [0.5 + alternating(at), 0.0, 0.0],
        echo_off_cm: Some(2.0 + alternating(at / 2)),
        ..Made::default()
    });
    let rows = identification(&baseline, rows);
    check(&FitContext::new(&rows, METHOD));
}

#[test]
fn parts_join_to_their_joint_fit() {
    in_both_stages(|context| {
        let (longer, farther) = (fitted(&LONGER, context), fitted(&FARTHER, context));
        let (problem, sketch) = longer.sketched_with(candidate(&FARTHER), None, context);
        let joint = problem.converge(sketch);
        for (combined, ids) in [
            (longer.with(candidate(&FARTHER), context), ["longer", "farther"]),
            (farther.with(candidate(&LONGER), context), ["farther", "longer"]),
        ] {
            assert_eq!(combined.ids(), ids);
            let near = |a: f64, b: f64, most: f64| assert!((a - b).abs() < most, "{a} {b}");
            let values_of = |id: &str| combined.values_of(combined.ids().iter().position(|i| *i == id).expect(id))[0];
            // Either fit ends within a tenth of a nat of its maximum.
            near(values_of("longer"), joint.values[0], 0.06);
            near(values_of("farther"), joint.values[1], 0.06);
            near(combined.scores.total(), joint.scores.total(), 0.2);
            near(combined.cross_validated.total(), joint.cross_validated.total(), 0.2);
            assert!(combined.gain_over(&longer).nats > 5.0 && combined.gain_over(&farther).nats > 2.0);
        }
    });
}

#[test]
fn each_variant_that_gains_anything_is_added_once() {
    in_both_stages(|context| {
        let names = |fits: &[Fitted]| -> Vec<Vec<String>> {
            let name = |c: &Candidate| format!("{} {}", c.effect, c.variant.id);
            fits.iter().map(|f| f.hypothesis.candidates.iter().map(name).collect()).collect()
        };
        let singles = Fitted::null(context).with_each_alone(|_| true, context);
        let each = [["longer every_step"], ["longer_to_the_left left_turns"], ["farther length"], ["farther half"]];
        assert_eq!(names(&singles), each);
        let with = |new| vec!["longer every_step", new];
        assert!(singles[0].with_each(Part::Motion, context).is_empty(), "nothing is left of the motion to explain");
        let motion = [["farther length", "longer every_step"]];
        assert_eq!(names(&singles[2].with_each(Part::Motion, context)), motion);
        let further = [with("farther length"), with("farther half")];
        assert_eq!(names(&singles[0].with_each(Part::Sensor, context)), further);
        let best = best_of_each(singles);
        assert_eq!(best.iter().map(|f| f.ids()[0]).collect::<Vec<_>>(), ["farther", "longer", "longer_to_the_left"]);
    });
}

#[test]
fn removing_an_effect_leaves_the_fit_of_the_others() {
    in_both_stages(|context| {
        let both = fitted(&FARTHER, context).with(candidate(&LONGER), context);
        assert_eq!((both.values_of(0).len(), both.values_of(1)), (1, &both.values[1..]));
        let farther = both.without(1, context);
        assert_eq!(farther.ids(), ["farther"]);
        assert!((farther.values[0] - both.values[0]).abs() < 0.06);
        let none = farther.without(0, context);
        assert!(none.ids().is_empty());
        assert_eq!(none.cross_validated, Fitted::null(context).cross_validated);
    });
}

/// Compares the evidence of one and two parameters with sums over a fine grid of all that the priors allow. Rows are independent,
/// so that blocks as units make no difference.
#[test]
fn evidence_is_the_likelihood_averaged_over_the_prior() {
    in_context(scattered(&[0.3; 48], 10, 1.0), |context| {
        let value = |fit: &Fitted, at: &[f64]| {
            let scores = fit.hypothesis.scores(context.rows, at);
            scores.total() + fit.hypothesis.log_prior(at) + fit.hypothesis.log_prior_peak()
        };
        let log_sum = |values: &[f64], cell: f64| {
            let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            most + libm::log(values.iter().map(|v| libm::exp(v - most)).sum::<f64>() * cell)
        };
        let grid =
            |fit: &Fitted, i: usize| -> Vec<f64> { (-40..=40).map(|k| fit.values[i] + 0.02 * f64::from(k)).collect() };

        let one = fitted(&LONGER, context);
        let exact = log_sum(&grid(&one, 0).iter().map(|x| value(&one, &[*x])).collect::<Vec<f64>>(), 0.02);
        assert!((one.log_evidence() - exact).abs() < 0.6, "{} {exact}", one.log_evidence());

        let both = one.with(candidate(&LONGER_TO_THE_LEFT), context);
        let points = grid(&both, 0).into_iter().flat_map(|x| grid(&both, 1).into_iter().map(move |y| [x, y]));
        let exact = log_sum(&points.map(|at| value(&both, &at)).collect::<Vec<f64>>(), 0.02 * 0.02);
        assert!((both.log_evidence() - exact).abs() < 0.9, "{} {exact}", both.log_evidence());
    });
}

/// The prior allows values over ten centimetres, of which the rows leave a few millimetres.
#[test]
fn useless_parameter_has_a_complexity_penalty() {
    in_context(scattered(&[0.0; 8], 50, 1.0), |context| {
        let null = Fitted::null(context);
        let [flat, with_prior] =
            [&LONGER, &SLIGHTLY_LONGER].map(|effect| fitted(effect, context).gain_over(&null).nats);
        assert!(flat < -3.0 && flat < with_prior, "{flat} {with_prior}");
    });
}

/// The information of a row is 1.02 per squared standard deviation: 480 rows leave a standard error of 0.045.
#[test]
fn interval_reaches_by_students_law_for_the_blocks() {
    in_context(scattered(&[0.3; 48], 10, 1.0), |context| {
        let fit = fitted(&LONGER, context);
        assert!((fit.errors[0] / 0.045 - 1.0).abs() < 0.3, "{}", fit.errors[0]);
        let [low, high] = fit.interval(0);
        assert!((0.5 * (low + high) - fit.values[0]).abs() < 1e-9);
        // Of 48 blocks, by published tables.
        assert!((0.5 * (high - low) / fit.errors[0] - 2.012).abs() < 1e-3);
    });
}

/// Given effects are found by their ids in the built-in catalogue, whatever the catalogue of the context.
#[test]
fn given_effects_are_not_fitted() {
    in_context(observations(8, 4, |_, _| Made { off: [0.5, 0.0, 0.0], ..Made::default() }), |context| {
        // Steps of 5 cm that are 0.5 cm longer.
        let scale = Candidate::named("drive_scale", "distance").expect("in the catalogue");
        let given = Fitted::given(&[AppliedEffect::new(&scale, &[1.1], &robot())], context);
        assert_eq!((given.ids(), given.values.as_slice()), (vec!["drive_scale"], &[1.1][..]));
        let expected = 32.0 * (log_density(0, 0.0, 1.0) - log_density(0, 0.5, 1.0));
        assert!((given.gain_over(&Fitted::null(context)).nats - expected).abs() < 1e-9);
        assert_eq!(given.applied(&robot()), [AppliedEffect::new(&scale, &[1.1], &robot())]);
    });
}
