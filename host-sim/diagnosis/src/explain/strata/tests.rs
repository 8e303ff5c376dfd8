use super::*;
use crate::fit::Fitted;
use crate::test_support::*;
use mindgap_learning::evaluation::observations::Observations;

/// Eight blocks of twelve rows that turn left, right and not at all in turn; every other four come after 12 s.
fn rows() -> Observations {
    observations(8, 12, |_, at| {
        let command = [[40.0, 80.0], [80.0, 40.0], [60.0, 60.0]][at % 3];
        let elapsed_min = if at < 6 { 0.05 } else { 0.3 };
        Made { commands: [command; 2], elapsed_min, ..Made::default() }
    })
}

/// A comparison whose effect makes the forward channel of each row likelier by `nats`.
fn gaining(nats: impl Fn(&Observation) -> f64, context: &FitContext) -> Comparison {
    let mut found = comparison(&[&LONGER], &[10.0; 8], context);
    let rows = context.observations.rows.iter();
    found.chosen.log_likelihood.motion = rows.map(|row| [nats(row), 0.0, 0.0]).collect();
    found
}

fn known() -> Judged {
    Judged::Known { effects: Vec::new() }
}

/// What of a stratum is known exactly.
fn told(strata: &[Stratum]) -> Vec<(Channel, &'static str, f64, [f64; 2], f64)> {
    strata.iter().map(|s| (s.channel, s.context, s.gap, s.ci95, s.share)).collect()
}

#[test]
fn a_gap_is_found_in_the_stratum_where_it_lies() {
    let (baseline, rows) = (baseline(), rows());
    let context = FitContext::new(&baseline, &rows, METHOD);
    let told_of = |nats: fn(&Observation) -> f64| told(&strata(&gaining(nats, &context), &known(), &context));
    let whole = |name, nats| vec![(Channel::Forward, name, nats, [nats; 2], 1.0)];
    assert_eq!(told_of(|r| if turning(r) > 0.0 { 2.0 } else { 0.0 }), whole("turning left", 2.0));
    assert_eq!(told_of(|r| if turning(r) < 0.0 { 1.0 } else { 0.0 }), whole("turning right", 1.0));
    assert_eq!(told_of(|r| if seconds(r) > 12.0 { 0.5 } else { 0.0 }), whole("elapsed time over 12 s", 0.5));
}

#[test]
fn a_gap_that_is_everywhere_is_told_as_such() {
    let (baseline, rows) = (baseline(), rows());
    let context = FitContext::new(&baseline, &rows, METHOD);
    let told = strata(&gaining(|_| 0.25, &context), &known(), &context);
    let [all] = told.as_slice() else { panic!("{told:?}") };
    // Every step has held commands, too: what is nearly all needs no lift.
    assert!((all.gap - 0.25).abs() < 1e-12 && (all.share - 1.0).abs() < 1e-12, "{all:?}");
    assert!(rows.rows.iter().all(|row| MOTION.iter().any(|(name, holds)| *name == all.context && holds(row))));
}

/// A quarter of the rest elsewhere: the stratum carries eight parts of ten.
#[test]
fn a_share_is_that_of_the_channels_gap() {
    let (baseline, rows) = (baseline(), rows());
    let context = FitContext::new(&baseline, &rows, METHOD);
    let told = strata(&gaining(|r| if turning(r) > 0.0 { 2.0 } else { 0.25 }, &context), &known(), &context);
    assert_eq!(told[0].context, "turning left");
    assert!((told[0].share - 0.8).abs() < 1e-12 && told[0].gap == 2.0, "{told:?}");
}

#[test]
fn without_a_gap_or_with_less_than_strong_evidence_nothing_is_told() {
    let (baseline, rows) = (baseline(), rows());
    let context = FitContext::new(&baseline, &rows, METHOD);
    assert!(strata(&gaining(|_| 1.0, &context), &Judged::NoGap, &context).is_empty());
    // 96 rows of 0.03 nats: 2.88 in all.
    assert!(strata(&gaining(|_| 0.03, &context), &known(), &context).is_empty());
    assert_eq!(strata(&gaining(|_| 0.04, &context), &known(), &context).len(), 1);
}

/// What no effect explains is what the residual model gains, here in left turns that are a centimetre too long.
#[test]
fn an_unknown_gap_is_that_of_the_residual_model() {
    let baseline = baseline();
    let made = |at: usize| if at.is_multiple_of(3) { 2.0 } else { 0.0 } + 0.9 * alternating(at / 3);
    let mut rows = rows();
    let per_block = rows.rows.len() / rows.blocks;
    for row in &mut rows.rows {
        let motion = row.motion.as_mut().expect("a step");
        motion.forward_cm += made(row.at % per_block);
    }
    let context = FitContext::new(&baseline, &rows, METHOD);
    let none = Fitted::none(&context);
    let beyond_none = crate::remainder::remainders(&none, &context);
    let found = Comparison { chosen: none.clone(), none, beyond_none, ..comparison(&[], &[0.0; 8], &context) };
    let told = strata(&found, &Judged::Unknown, &context);
    assert_eq!((told[0].channel, told[0].context), (Channel::Forward, "turning left"), "{told:?}");
}

#[test]
fn headings_and_distances_are_those_of_their_names() {
    let rows = observations(1, 4, |_, at| Made {
        // From the middle of the room the walls are 150, 100, 150 and 100 cm away.
        pose: mindgap_foundations::geometry::Pose::new(150.0, 100.0, at as f64 * std::f64::consts::FRAC_PI_2),
        ..Made::default()
    });
    let holding = |contexts: &[Context], prefix: &str, at: usize| -> Vec<&str> {
        let those = contexts.iter().filter(|(name, holds)| name.starts_with(prefix) && holds(&rows.rows[at]));
        those.map(|(name, _)| *name).collect()
    };
    for (at, name) in ["0 (along x)", "90 (along y)", "180 (against x)", "-90 (against y)"].into_iter().enumerate() {
        assert_eq!(holding(MOTION, "heading", at), [format!("heading within 45 degrees of {name}")]);
    }
    assert_eq!(holding(SONAR, "distance", 1), ["distance 80 to 150 cm"]);
    assert_eq!(holding(SONAR, "distance", 0), ["distance over 150 cm"]);
    assert_eq!(holding(SONAR, "incidence", 0), ["incidence under 20 degrees"]);
}
