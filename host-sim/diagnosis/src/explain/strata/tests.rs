use super::*;
use crate::fit::Fitted;
use crate::sample::Identification;
use crate::test_support::*;
use mindgap_learning::evaluation::observations::Observations;

/// Eight blocks of twelve rows that alternate between left, right and no turns; half of them come after 12 s.
fn rows() -> Observations {
    observations(8, 12, |_, at| {
        let command = [[40.0, 80.0], [80.0, 40.0], [60.0, 60.0]][at % 3];
        let elapsed_min = if at < 6 { 0.05 } else { 0.3 };
        Made { commands: [command; 2], elapsed_min, ..Made::default() }
    })
}

/// Confirms an effect that makes the forward channel of each row more likely by `nats`.
fn gaining(nats: impl Fn(&Observation) -> f64, context: &FitContext) -> Confirmed {
    let mut found = confirmed(&[&LONGER], &[10.0; 8], context);
    let column: Vec<f64> = context.rows.rows.iter().map(nats).collect();
    found.chosen.scores = context.rows.scores_of(Channel::Forward, &column);
    found
}

fn in_context(check: impl Fn(&FitContext)) {
    let baseline = baseline();
    let rows: Identification = identification(&baseline, rows());
    check(&FitContext::new(&rows, METHOD));
}

fn known(nats: impl Fn(&Observation) -> f64, context: &FitContext) -> Vec<Stratum> {
    strata(&gaining(nats, context), Verdict::Known, context)
}

#[test]
fn gap_is_found_in_its_stratum() {
    in_context(|context| {
        let facts = |nats: fn(&Observation) -> f64| {
            let found = known(nats, context);
            found.iter().map(|s| (s.channel, s.context, s.gap, s.ci95, s.share)).collect::<Vec<_>>()
        };
        let whole = |name, nats| vec![(Channel::Forward, name, nats, [nats; 2], 1.0)];
        assert_eq!(facts(|r| if turning(r) > 0.0 { 2.0 } else { 0.0 }), whole("turning left", 2.0));
        assert_eq!(facts(|r| if turning(r) < 0.0 { 1.0 } else { 0.0 }), whole("turning right", 1.0));
        assert_eq!(facts(|r| if seconds(r) > 12.0 { 0.5 } else { 0.0 }), whole("elapsed time over 12 s", 0.5));
    });
}

#[test]
fn uniform_gap_is_in_a_stratum_of_all_rows() {
    in_context(|context| {
        let found = known(|_| 0.25, context);
        let [all] = found.as_slice() else { panic!("{found:?}") };
        // Every step has a held command, and a stratum of nearly all rows needs no lift.
        assert!((all.gap - 0.25).abs() < 1e-12 && (all.share - 1.0).abs() < 1e-12, "{all:?}");
        let is_all = |holds: &fn(&Observation) -> bool| context.rows.rows.iter().all(holds);
        assert!(MOTION.iter().any(|(name, holds)| *name == all.context && is_all(holds)));
    });
}

/// The other rows have a quarter nat each, so that the stratum carries eight tenths.
#[test]
fn share_is_that_of_the_channel_s_gap() {
    in_context(|context| {
        let found = known(|r| if turning(r) > 0.0 { 2.0 } else { 0.25 }, context);
        assert_eq!(found[0].context, "turning left");
        assert!((found[0].share - 0.8).abs() < 1e-12 && found[0].gap == 2.0, "{found:?}");
    });
}

#[test]
fn no_stratum_is_reported_without_strong_evidence_of_a_gap() {
    in_context(|context| {
        assert!(strata(&gaining(|_| 1.0, context), Verdict::NoGap, context).is_empty());
        // 96 rows of 0.03 nats: 2.88 in all.
        assert!(known(|_| 0.03, context).is_empty());
        assert_eq!(known(|_| 0.04, context).len(), 1);
    });
}

/// What no effect explains is what the omnibus regression gains, here in left turns that are two centimetres too long.
#[test]
fn unknown_gap_is_that_of_the_omnibus_regression() {
    let baseline = baseline();
    let mut observations = rows();
    let per_block = observations.rows.len() / observations.blocks;
    for row in &mut observations.rows {
        let at = row.at % per_block;
        let motion = row.motion.as_mut().expect("a step");
        motion.forward += if at.is_multiple_of(3) { 2.0 } else { 0.0 } + 0.9 * alternating(at / 3);
    }
    let rows = identification(&baseline, observations);
    let context = FitContext::new(&rows, METHOD);
    let null = Fitted::null(&context);
    let beyond_null = crate::remainder::remainders(&null, &context);
    let found = Confirmed { beyond_null, ..Confirmed::unexamined(null.clone(), null) };
    let strata = strata(&found, Verdict::Unknown, &context);
    assert_eq!((strata[0].channel, strata[0].context), (Channel::Forward, "turning left"), "{strata:?}");
}

#[test]
fn names_contain_the_borders() {
    let has = |contexts: &[Context], name: String| assert!(contexts.iter().any(|(n, _)| *n == name), "{name}");
    has(MOTION, format!("elapsed time under {EARLY_S} s"));
    has(MOTION, format!("elapsed time over {LATE_S} s"));
    has(MOTION, format!("slow commands, mean magnitude under {SLOW_COMMAND}"));
    has(MOTION, format!("fast commands, mean magnitude over {FAST_COMMAND}"));
    has(MOTION, format!("a change of command over {LARGE_CHANGE}"));
    has(MOTION, format!("over {MIDDLE_CM} cm from the scene's middle"));
    has(SONAR, format!("distance {NEAR_CM} to {MEDIUM_CM} cm"));
    has(SONAR, format!("distance over {FAR_CM} cm"));
    has(SONAR, format!("incidence {STEEP_DEG} to {SHALLOW_DEG} degrees"));
}

#[test]
fn names_describe_headings_and_distances() {
    let rows = observations(1, 4, |_, at| Made {
        pose: mindgap_foundations::geometry::Pose::new(150.0, 100.0, at as f64 * std::f64::consts::FRAC_PI_2),
        ..Made::default()
    });
    // From the middle of the room the walls are 150, 100, 150 and 100 cm away.
    let holding = |contexts: &[Context], prefix: &str, at: usize| -> Vec<&str> {
        let held = contexts.iter().filter(|(name, holds)| name.starts_with(prefix) && holds(&rows.rows[at]));
        held.map(|(name, _)| *name).collect()
    };
    for (at, name) in ["0 (along x)", "90 (along y)", "180 (against x)", "-90 (against y)"].into_iter().enumerate() {
        assert_eq!(holding(MOTION, "heading", at), [format!("heading within 45 degrees of {name}")]);
    }
    assert_eq!(holding(SONAR, "distance", 1), ["distance 80 to 150 cm"]);
    assert_eq!(holding(SONAR, "distance", 0), ["distance over 150 cm"]);
    assert_eq!(holding(SONAR, "incidence", 0), ["incidence under 20 degrees"]);
}
