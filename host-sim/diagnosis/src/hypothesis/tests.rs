use super::*;
use crate::test_support::*;
use mindgap_foundations::channel::Channel;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_models::effects::applied::AppliedEffect;

/// An effect that explains everything leaves the simulator's own noise.
#[test]
fn noise_of_a_hypothesis_is_that_of_its_residuals() {
    let baseline = baseline();
    let rows = identification(
        &baseline,
        observations(4, 2, |_, at| Made { off: [1.5 + 2.0 * alternating(at), 0.0, 0.3], ..Made::default() }),
    );
    let null = Hypothesis::null(&baseline);
    let [forward, lateral, turn] = null.noise(&rows, &[]);
    let of = |axis, residuals: &[f64]| {
        let unweighted: Vec<[f64; 2]> = residuals.iter().map(|r| [*r, 1.0]).collect();
        fitted_noise(axis, &unweighted, NOISE[axis])
    };
    assert_eq!((forward, lateral, turn), (of(0, &[-0.5, 3.5].repeat(4)), NOISE[1], of(2, &[0.3; 8])));
    assert_eq!(null.with(candidate(&LONGER)).noise(&rows, &[1.5])[0], of(0, &[-2.0, 2.0].repeat(4)));
}

/// Returns the log-density of a row with zero residuals.
fn expected() -> [f64; 3] {
    [0, 1, 2].map(|axis| log_density(axis, 0.0, NOISE[axis]))
}

#[test]
fn prior_is_normal_about_the_nominal_value_or_flat() {
    let baseline = baseline();
    let hypothesis = Hypothesis::null(&baseline).of(vec![candidate(&SLIGHTLY_LONGER), candidate(&LONGER)]);
    assert_eq!(hypothesis.log_prior(&[0.0, 5.0]), 0.0);
    assert!((hypothesis.log_prior(&[0.1, 5.0]) + 2.0).abs() < 1e-12, "two standard deviations");
    assert_eq!(hypothesis.bounds().len(), 2);
}

#[test]
fn untouched_channels_are_copied() {
    let baseline = baseline_with_sonar();
    let rows = identification(&baseline, observations(2, 2, |_, _| Made { echo_off_cm: Some(0.0), ..Made::default() }));
    let untouched = Scores::zero(rows.row_blocks()).with_motion(&[[7.0; 3]; 4]).with_sonar(&[[9.0; 2]; 4]);
    let with = |effect| {
        let hypothesis = Hypothesis::null(&baseline).with(candidate(effect));
        hypothesis.scores_over(&untouched, &rows, &[0.0])
    };
    let (longer, farther) = (with(&LONGER), with(&FARTHER));
    for channel in Channel::ALL {
        let copied = if channel.motion_axis().is_some() { &farther } else { &longer };
        assert_eq!(copied.of(channel), untouched.of(channel));
    }
    let exact = expected();
    assert!(longer.rows().iter().all(|row| row[..3] == exact));
    assert!(farther.rows().iter().all(|row| row[3..].iter().all(|term| *term < 1.0)));
}

#[test]
fn equal_values_for_all_blocks_score_as_one_fit() {
    let baseline = baseline_with_sonar();
    let rows = identification(
        &baseline,
        observations(3, 4, |block, at| Made {
            off: [block as f64 + 2.0 * alternating(at), 0.3, 0.0],
            echo_off_cm: (at > 0).then_some(at as f64),
            ..Made::default()
        }),
    );
    let null = Hypothesis::null(&baseline);
    let untouched = null.scores(&rows, &[]);
    for (effect, value) in [(&LONGER, 1.0), (&FARTHER, 2.0)] {
        let hypothesis = null.with(candidate(effect));
        let noise = hypothesis.noise(&rows, &[value]);
        let together = hypothesis.scores(&rows, &[value]).by_row();
        let (witnesses, _) = hypothesis.witnesses(&rows, &[value]);
        let values = vec![vec![value]; 3];
        let apart = hypothesis.scores_by_block(&values, noise, &witnesses, &untouched, &rows).by_row();
        assert!(together.iter().zip(apart).all(|(a, b)| (a - b).abs() < 1e-9), "{}", effect.id);
    }
}

#[test]
fn effects_of_the_simulator_act_under_every_hypothesis() {
    let scale = Candidate::named("drive_scale", "distance").expect("in the catalogue");
    let with_scale = Baseline { applied: vec![AppliedEffect::new(&scale, &[1.1], &robot())], ..baseline() };
    let rows = identification(&with_scale, observations(1, 4, |_, _| Made { off: [0.5, 0.0, 0.0], ..Made::default() }));
    let null = Hypothesis::null(&with_scale);
    assert!(null.candidates.is_empty() && !null.moves());
    let exact = expected();
    let terms = null.motion(&rows, &[]);
    assert!(terms.iter().flatten().zip(exact.iter().cycle()).all(|(a, b)| (a - b).abs() < 1e-9), "{terms:?}");
}

/// Rows whose wheels turn by this share of what is commanded, as does the robot.
fn counted(turned: f64) -> Observations {
    let mut rows = observations(4, 8, |_, at| Made {
        commands: [[20.0 + at as f64, 60.0 - 3.0 * at as f64]; 2],
        off: [0.1 * alternating(at), 0.0, 0.0],
        ..Made::default()
    });
    let drive = baseline().motion.expect("a drive");
    for row in &mut rows.rows {
        let [now, before] = row.commands();
        let wheels_cm = drive.wheels_cm(now, before).expect("of a textbook");
        row.wheels_cm = Some([0, 1].map(|wheel| turned * wheels_cm[wheel] + 0.001 * alternating(row.at)));
    }
    rows
}

#[test]
fn counters_show_what_happens_before_the_rims_and_nothing_behind() {
    let baseline = baseline();
    let null = Hypothesis::null(&baseline);
    let nats = |turned: f64, effect: &str, variant: &str, value: f64| {
        let rows = identification(&baseline, counted(turned));
        let hypothesis = null.with(Candidate::named(effect, variant).expect("in the catalogue"));
        hypothesis.scores(&rows, &[value]).total_of(Channel::RotRight)
    };
    for (effect, variant, value) in
        [("motor_asymmetry", "command", -0.2), ("motor_asymmetry", "distance", -0.2), ("saturation", "hard", 0.2)]
    {
        assert!(nats(1.0, effect, variant, value) < nats(1.0, "track_width", "turn", 0.8) - 20.0, "{effect} {variant}");
    }
    for turned in [1.0, 0.8] {
        // Tyres or voltage: counters decide which. Shorter steps have a lower least noise, 7 nats on these rows.
        let scaled = nats(turned, "drive_scale", "distance", 0.8);
        assert!((scaled - nats(1.0, "track_width", "turn", 0.8)).abs() < 10.0, "{turned}: {scaled}");
    }
}

#[test]
fn witnesses_decide_only_where_they_were_logged() {
    let baseline = baseline();
    let hypothesis = Hypothesis::null(&baseline).with(Candidate::named("track_width", "turn").expect("one"));
    for is_logged in [true, false] {
        let mut counted = counted(1.0);
        counted.rows.iter_mut().for_each(|row| row.wheels_cm = row.wheels_cm.filter(|_| is_logged));
        let rows = identification(&baseline, counted);
        let (witnesses, scores) = hypothesis.witnesses(&rows, &[0.8]);
        let decided = hypothesis.decided_by(0, &witnesses, &rows, &[0.8], 3.0);
        assert_eq!(decided, if is_logged { vec![Channel::RotLeft, Channel::RotRight] } else { Vec::new() });
        assert_eq!(scores.iter().any(|row| *row != [0.0; 3]), is_logged);
    }
}
