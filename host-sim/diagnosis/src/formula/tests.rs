use rand::RngExt;
use rand_distr::StandardNormal;

use super::*;
use crate::test_support::*;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;
use mindgap_learning::evaluation::observations::Observations;

/// Makes blocks of steps under random commands, half of them straight, with the usual noise and the forward error
/// `law(forward_cm, turn_rad)`.
fn random_steps(seed: u64, blocks: usize, law: fn(f64, f64) -> f64) -> Observations {
    let draws: Vec<(f64, f64, f64, [f64; 3])> = {
        let mut rng = generator(seed, &[]);
        (0..blocks * ROWS)
            .map(|_| {
                let straight = rng.random_bool(0.5);
                let (mean, half) = (rng.random_range(20.0..80.0), rng.random_range(-20.0..20.0));
                let heading = rng.random_range(-3.0..3.0);
                (
                    mean,
                    if straight { 0.0 } else { half },
                    heading,
                    NOISE.map(|sd| sd * rng.sample::<f64, _>(StandardNormal)),
                )
            })
            .collect()
    };
    let drive = baseline().motion.expect("a drive");
    observations(blocks, ROWS, move |block, at| {
        let (mean, half, heading, mut off) = draws[block * ROWS + at];
        let commands = [[mean - half, mean + half]; 2];
        let predicted = drive.step(commands[0], commands[1]);
        off[0] += law(predicted.forward, predicted.turn);
        Made { commands, pose: Pose::new(150.0, 100.0, heading), off, ..Made::default() }
    })
}

const ROWS: usize = 60;
const BLOCKS: usize = 16;

/// Searches a formula for the gap without any effect, confirmed on four other blocks.
fn searched(seed: u64, law: fn(f64, f64) -> f64, confirming: fn(f64, f64) -> f64) -> Option<Formula> {
    let baseline = baseline();
    let rows = identification(&baseline, random_steps(seed, BLOCKS, law));
    let hold_out = HoldOut::new(&baseline, random_steps(seed + 1000, 4, confirming));
    let context = FitContext::new(&rows, METHOD);
    search(&Confirmed::given(&[], &context), &context, Some(&hold_out))
}

const NOTHING: fn(f64, f64) -> f64 = |_, _| 0.0;
const LOSS_IN_TURNS: fn(f64, f64) -> f64 = |_, turn_rad| -6.0 * turn_rad.abs();

#[test]
fn formula_is_found_with_its_coefficient() {
    let formula = searched(1, LOSS_IN_TURNS, LOSS_IN_TURNS).expect("a formula");
    assert_eq!(formula.channel, Channel::Forward);
    assert!(formula.text.starts_with('-') && formula.text.ends_with(" * abs(turn_rad)"), "{}", formula.text);
    assert_eq!(formula.definition.change.forward_cm.as_deref(), Some("forward_cm + k1 * abs(turn_rad)"));
    assert_eq!(formula.definition.parameters[0].unit, "cm/rad");
    // A thousand rows with noise of 1 cm and a mean square turn of about 0.1 rad² give a standard error of about 0.15 cm/rad.
    let [loss] = formula.fitted.values.as_slice() else { panic!("one parameter") };
    assert!((loss + 6.0).abs() < 0.5, "{loss}");
    let held_out: f64 = formula.gains_held_out.as_ref().expect("runs held out").iter().sum();
    assert!(held_out > 20.0, "{held_out}");
}

#[test]
fn product_is_found() {
    let formula = searched(2, |f, w| -0.6 * f * w.abs(), |f, w| -0.6 * f * w.abs()).expect("a formula");
    let product = ["forward_cm * abs(turn_rad)", "abs(forward_cm) * abs(turn_rad)"];
    assert!(product.iter().any(|product| formula.text.ends_with(product)), "{}", formula.text);
}

/// Readings are 4 cm too long towards +x and 4 cm too short towards -x.
#[test]
fn formula_of_readings_is_found() {
    let rows = |seed: u64, blocks: usize| {
        let mut rng = generator(seed, &[]);
        let draws: Vec<(f64, f64)> =
            (0..blocks * ROWS).map(|_| (rng.random_range(-3.1..3.1), rng.sample(StandardNormal))).collect();
        observations(blocks, ROWS, move |block, at| {
            let (heading, noise) = draws[block * ROWS + at];
            let echo_off_cm = Some(4.0 * libm::cos(heading) + noise);
            Made { pose: Pose::new(150.0, 100.0, heading), echo_off_cm, ..Made::default() }
        })
    };
    let baseline = baseline_with_sonar();
    let found_on = identification(&baseline, rows(5, BLOCKS));
    let context = FitContext::new(&found_on, METHOD);
    let hold_out = HoldOut::new(&baseline, rows(6, 4));
    let formula = search(&Confirmed::given(&[], &context), &context, Some(&hold_out)).expect("a formula");
    assert_eq!(formula.channel, Channel::EchoValue);
    // The nearest ray to an oblique wall adds a small term.
    let first = formula.text.split(" + ").next().expect("a term");
    assert!(first.ends_with(" * cos(heading_rad)"), "{}", formula.text);
    // A thousand readings with noise of 1 cm give a standard error of 0.05 cm.
    assert!((formula.fitted.values[0] - 4.0).abs() < 0.2, "{:?}", formula.fitted.values);
}

#[test]
fn noise_has_no_formula() {
    for seed in 10..30 {
        assert!(searched(seed, NOTHING, NOTHING).is_none(), "{seed}");
    }
}

#[test]
fn formula_that_held_out_runs_refute_is_dropped() {
    assert!(searched(1, LOSS_IN_TURNS, NOTHING).is_none());
}

/// The file of a formula is read as a file of custom effects.
#[test]
fn formula_is_a_custom_effect() {
    let formula = searched(1, LOSS_IN_TURNS, LOSS_IN_TURNS).expect("a formula");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("formula.toml");
    mindgap_files::write(&path, own::to_text(&formula.definition)).expect("a file");
    let read = own::read(&path).expect("a file of effects");
    assert!(std::ptr::eq(&read[0].variants[0], formula.fitted.hypothesis.candidates[0].variant));
    let applied = formula.fitted.applied(&robot());
    assert_eq!(applied[0].definition.as_ref(), Some(&formula.definition));
}

#[test]
fn share_is_that_of_the_reducible_gap() {
    let formula = searched(1, LOSS_IN_TURNS, LOSS_IN_TURNS).expect("a formula");
    let gains = formula.gains_held_out.clone().expect("runs held out");
    let twice: Vec<f64> = gains.iter().map(|gain| 2.0 * gain).collect();
    let Statement { share, ci95, .. } = formula.stated(&twice, 1);
    assert!((share - 0.5).abs() < 1e-9 && (ci95[0] - 0.5).abs() < 1e-9 && (ci95[1] - 0.5).abs() < 1e-9);
    // It cannot explain more than the whole gap.
    assert_eq!(formula.stated(&vec![0.0; gains.len()], 1).share, 1.0);
}

#[test]
fn sums_and_units_are_written_for_people() {
    let term = |text: &str, units: &[&'static str]| Term {
        text: text.into(),
        units: units.to_vec(),
        factors: 1,
        values: Vec::new(),
    };
    let terms = [term("abs(turn_rad)", &["rad"]), term("elapsed_min", &["min"])];
    assert_eq!(text(&terms, &[0, 1], &[-2.8004, 0.1]), "-2.8 * abs(turn_rad) + 0.1 * elapsed_min");
    assert_eq!(text(&terms, &[1, 0], &[1234.0, -2.0]), "1230 * elapsed_min - 2 * abs(turn_rad)");
    assert_eq!([per("cm", &[]), per("cm", &["cm"]), per("cm", &["rad"])], ["cm", "", "cm/rad"]);
    assert_eq!([per("cm", &["cm", "rad"]), per("cm", &["cm", "cm"])], ["1/rad", "1/cm"]);
    assert_eq!([per("rad", &["cm", "min"]), per("cm", &["rad/s"])], ["rad/(cm min)", "cm/(rad/s)"]);
}
