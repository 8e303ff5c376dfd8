use super::*;
use crate::test_support::*;
use mindgap_models::effects::applied::AppliedEffect;

/// An effect that explains all leaves the simulator's own scatter.
#[test]
fn the_scatter_of_a_hypothesis_is_that_of_what_it_leaves_over() {
    let (baseline, rows) = (
        baseline(),
        observations(4, 2, |_, at| Made { off: [1.5 + 2.0 * alternating(at), 0.0, 0.3], ..Made::default() }),
    );
    let none = Hypothesis::none(&baseline);
    let [forward, lateral, turn] = none.scatter(&baseline, &rows, &[]);
    let of = |axis, residuals: &[f64]| {
        let alike: Vec<[f64; 2]> = residuals.iter().map(|r| [*r, 1.0]).collect();
        fitted_scatter(axis, &alike, SCATTER[axis])
    };
    assert_eq!((forward, lateral, turn), (of(0, &[-0.5, 3.5].repeat(4)), SCATTER[1], of(2, &[0.3; 8])));
    assert_eq!(none.with(candidate(&LONGER)).scatter(&baseline, &rows, &[1.5])[0], of(0, &[-2.0, 2.0].repeat(4)));
}

/// The log-density of a row that is as expected.
fn expected() -> [f64; 3] {
    [0, 1, 2].map(|axis| log_density(axis, 0.0, SCATTER[axis]))
}

#[test]
fn the_prior_is_normal_about_the_nominal_values_of_those_that_have_one() {
    let baseline = baseline();
    let hypothesis = Hypothesis::none(&baseline).of(vec![candidate(&SLIGHTLY_LONGER), candidate(&LONGER)]);
    assert_eq!(hypothesis.log_prior(&[0.0, 5.0]), 0.0);
    assert!((hypothesis.log_prior(&[0.1, 5.0]) + 2.0).abs() < 1e-12, "two standard deviations");
    assert_eq!(hypothesis.bounds().len(), 2);
}

#[test]
fn what_a_hypothesis_does_not_touch_is_taken_over() {
    let (baseline, rows) =
        (baseline_with_sonar(), observations(2, 2, |_, _| Made { echo_off_cm: Some(0.0), ..Made::default() }));
    let untouched = LogLikelihood { motion: vec![[7.0; 3]; 4], sonar: vec![[9.0; 2]; 4] };
    let with = |effect| {
        let hypothesis = Hypothesis::none(&baseline).with(candidate(effect));
        hypothesis.log_likelihood(&baseline, &rows, &[0.0], Some(&untouched))
    };
    let (longer, farther) = (with(&LONGER), with(&FARTHER));
    assert_eq!((longer.sonar, farther.motion), (untouched.sonar.clone(), untouched.motion.clone()));
    assert_eq!(longer.motion, vec![expected(); 4]);
    assert!(farther.sonar.iter().flatten().all(|term| *term < 1.0));
}

#[test]
fn blocks_add_up_to_all_rows() {
    let (baseline, rows) = (
        baseline_with_sonar(),
        observations(3, 4, |block, at| Made {
            off: [block as f64 + 2.0 * alternating(at), 0.3, 0.0],
            echo_off_cm: (at > 0).then_some(at as f64),
            ..Made::default()
        }),
    );
    let none = Hypothesis::none(&baseline);
    let untouched = none.log_likelihood(&baseline, &rows, &[], None);
    for (effect, value) in [(&LONGER, 1.0), (&FARTHER, 2.0)] {
        let hypothesis = none.with(candidate(effect));
        let scatter = hypothesis.scatter(&baseline, &rows, &[value]);
        let all = rows.by_block(&hypothesis.log_likelihood(&baseline, &rows, &[value], None).total());
        for (block, all) in all.iter().enumerate() {
            let one = hypothesis.of_block(&baseline, &rows, block, &[value], scatter, &untouched);
            assert!((one - all).abs() < 1e-9, "{}: {one} {all}", effect.id);
        }
    }
}

#[test]
fn channels_are_the_columns_and_their_sum_the_total() {
    let terms = LogLikelihood { motion: vec![[1.0, 2.0, 3.0]], sonar: vec![[4.0, 5.0]] };
    assert_eq!(Channel::ALL.map(|channel| terms.channel(channel)[0]), [1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(terms.total(), [15.0]);
}

#[test]
fn effects_that_the_simulator_has_already_act_beneath_every_hypothesis() {
    let scale = mindgap_models::effects::Candidate::named("drive_scale", "distance").expect("in the catalogue");
    let with_scale = Baseline { applied: vec![AppliedEffect::new(&scale, &[1.1])], ..baseline() };
    let rows = observations(1, 4, |_, _| Made { off: [0.5, 0.0, 0.0], ..Made::default() });
    let none = Hypothesis::none(&with_scale);
    assert!(none.candidates.is_empty() && !none.moves());
    let exact = expected();
    let terms = none.log_likelihood(&with_scale, &rows, &[], None).motion;
    assert!(terms.iter().flatten().zip(exact.iter().cycle()).all(|(a, b)| (a - b).abs() < 1e-9), "{terms:?}");
}
