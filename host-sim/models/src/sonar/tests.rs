use rand::RngExt;

use super::fan::{RAYS, fan_at};
use super::outcomes::{Distribution, Outcomes, Source};
use super::partition::{PERTURBED, Partition, SENSORS, assert_follow, probability_between, scenes, sensors};
use super::{MixingWeights, Perturbation, SonarModel};
use mindgap_foundations::random::generator;

/// Returns the outcomes of every sensor at every pose, unperturbed and perturbed, with a label.
fn grid() -> Vec<(String, Outcomes)> {
    let mut grid = Vec::new();
    for (s, scene) in scenes().iter().enumerate() {
        for (p, pose) in sensors().iter().enumerate() {
            for (m, model) in SENSORS.iter().enumerate() {
                let fan = fan_at(&scene.sides(), pose, model.fan_width);
                for (name, perturbation) in [("as it is", Perturbation::NONE), ("perturbed", PERTURBED)] {
                    let outcomes = model.outcomes(&fan, &perturbation);
                    grid.push((format!("sensor {m} at {p} of scene {s}, {name}"), outcomes));
                }
            }
        }
    }
    grid
}

#[test]
fn files_keep_their_names() {
    let file = serde_json::to_value(&SENSORS[0]).expect("numbers have a form in files");
    let names = "bias constant constant_for_none fan_width log_scatter lost mirror_loss range_cm short strength";
    assert_eq!(file.as_object().expect("a table").keys().map(String::as_str).collect::<Vec<_>>().join(" "), names);
    assert_eq!(serde_json::from_value::<SonarModel>(file).expect("it was just written"), SENSORS[0]);
}

#[test]
fn probabilities_add_up_to_one() {
    for (what, outcomes) in grid() {
        let probabilities: Vec<f64> = outcomes.components.iter().map(|c| c.probability).collect();
        assert!(probabilities.iter().chain([&outcomes.none]).all(|p| (0.0..=1.0).contains(p)), "{what}");
        assert!((probabilities.iter().sum::<f64>() + outcomes.none - 1.0).abs() < 1e-12, "{what}");
    }
    for model in &SENSORS {
        for arrives in [true, false] {
            let w = MixingWeights::new(model, &PERTURBED, arrives);
            let sum = w.hit + w.ghost + w.constant + w.short + w.long + w.stray + w.none;
            assert!((sum - 1.0).abs() < 1e-12, "{w:?}");
            assert_eq!(w.hit > 0.0, arrives);
        }
    }
}

/// In front of a wall at the near end of the range, half of the readings with large scatter are too near to be reported, but
/// almost none of those whose scatter is below the rounding.
#[test]
fn readings_scattered_beyond_the_range_are_not_reported() {
    let model = &SENSORS[0];
    let mut fan = fan_at(&scenes()[0].sides(), &sensors()[0], model.fan_width);
    fan.iter_mut().for_each(|ray| ray.distance_cm = model.range_cm[0]);
    let outcomes = |scatter_cm| model.outcomes(&fan, &Perturbation { scatter_cm, ..Perturbation::NONE });
    let [as_it_is, hardly, scattered] = [outcomes(0.0), outcomes(0.1), outcomes(5.0)];
    let hits: f64 =
        as_it_is.components.iter().filter(|c| c.source == Source::Hit).map(|component| component.probability).sum();
    let lost = |outcomes: &Outcomes| (outcomes.none - as_it_is.none) / hits;
    assert!((lost(&scattered) - 0.5).abs() < 0.05, "{}", lost(&scattered));
    assert!(lost(&hardly) < 0.01, "{}", lost(&hardly));
}

/// All hits come from one distance and scatter little. A wall that reads the end of the range, or half a centimetre beyond
/// it, is the last one reported; readings that the perturbation does not lead beyond an end are reported as that end.
#[test]
fn readings_led_beyond_the_range_are_not_reported() {
    let model = SonarModel { bias: [0.0; 3], ..SENSORS[0].clone() };
    let [low_cm, high_cm] = model.range_cm;
    let lost = |distance_cm: f64, change: &Perturbation| {
        let mut fan = fan_at(&scenes()[0].sides(), &sensors()[0], model.fan_width);
        fan.iter_mut().for_each(|ray| ray.distance_cm = distance_cm);
        let [as_it_is, changed] = [&Perturbation::NONE, change].map(|change| model.outcomes(&fan, change));
        let hits = as_it_is.components.iter().filter(|c| c.source == Source::Hit).map(|c| c.probability).sum::<f64>();
        (changed.none - as_it_is.none) / hits
    };
    let by = |offset_cm: f64| Perturbation { offset_cm, ..Perturbation::NONE };
    let nearer = |distance_cm| lost(distance_cm, &by(-3.0));
    assert!(nearer(low_cm) > 0.99 && nearer(low_cm + 1.5) > 0.99);
    assert!((nearer(low_cm + 2.5) - 0.5).abs() < 0.01 && nearer(low_cm + 3.5) < 0.01);
    let kept = [lost(low_cm, &by(-0.4)), lost(low_cm, &by(3.0)), lost(high_cm, &by(-3.0))];
    assert!(kept.iter().all(|lost| *lost < 1e-9), "{kept:?}");
    let longer = |distance_cm| lost(distance_cm, &Perturbation { gain: 1.2, ..Perturbation::NONE });
    assert!(longer(high_cm) > 0.99 && longer(high_cm / 1.2 + 2.0) > 0.99);
    assert!(longer(high_cm / 1.2 - 2.0) < 0.01 && longer(low_cm) < 0.01);
}

#[test]
fn no_component_is_missing_from_the_grid() {
    let grid = grid();
    for i in 0..grid[0].1.components.len() {
        let largest = grid.iter().map(|(_, o)| o.components[i].probability).fold(0.0, f64::max);
        let least = if i < RAYS { 0.01 } else { 0.002 };
        assert!(largest > least, "{:?} {i}: {largest}", grid[0].1.components[i].source);
    }
    let nothing = grid.iter().filter(|(_, o)| o.components[..RAYS].iter().all(|c| c.probability == 0.0));
    assert!(nothing.count() > 0, "no fan of the grid meets nothing");
}

/// The density integrates to the probability for each component alone, and for all together in cells.
#[test]
fn likelihood_integrates_to_the_probabilities() {
    const STEPS: usize = 500;
    let integral = |outcomes: &Outcomes, [from, to]: [f64; 2]| {
        let width = (to - from) / STEPS as f64;
        let at = |i: usize| libm::exp(outcomes.log_likelihood(Some(from + (i as f64 + 0.5) * width)));
        (0..STEPS).map(|i| width * at(i)).sum::<f64>()
    };
    for (what, outcomes) in grid() {
        let alone = (0..outcomes.components.len()).map(|kept| {
            let mut alone = outcomes.clone();
            alone.components.iter_mut().enumerate().filter(|(i, _)| *i != kept).for_each(|(_, c)| c.probability = 0.0);
            alone
        });
        let [low, high] = outcomes.range_cm;
        for part in alone.chain([outcomes.clone()]) {
            for [from, to] in Partition::new(&outcomes).cells() {
                let [from, to] = [from.max(low), to.min(high)];
                let (found, expected) = (integral(&part, [from, to]), probability_between(&part, from, to));
                assert!((found - expected).abs() < 1e-3, "{what}, {from} to {to}: {found} {expected}");
            }
        }
        assert!((libm::exp(outcomes.log_likelihood(None)) - outcomes.none).abs() < 1e-12, "{what}");
        assert!((libm::exp(outcomes.log_detection(Some(50.0))) + outcomes.none - 1.0).abs() < 1e-12, "{what}");
    }
}

#[test]
fn draws_select_components_by_their_probabilities() {
    const DRAWS: usize = 20_000;
    for (at, (what, outcomes)) in grid().into_iter().enumerate() {
        let mut rng = generator(3, &[at as u64]);
        let mut counts = vec![0.0; outcomes.components.len() + 1];
        for _ in 0..DRAWS {
            let picked = outcomes.pick(rng.random());
            let place = picked.and_then(|picked| outcomes.components.iter().position(|c| std::ptr::eq(c, picked)));
            counts[place.map_or(0, |place| place + 1)] += 1.0;
        }
        let components = outcomes.components.iter().map(|c| c.probability);
        let probabilities: Vec<f64> = [outcomes.none].into_iter().chain(components).collect();
        assert_follow(&counts, &probabilities, &what);
    }
}

#[test]
fn frequencies_of_drawn_readings_follow_the_likelihood() {
    const DRAWS: usize = 20_000;
    for (at, (what, outcomes)) in grid().into_iter().enumerate() {
        let mut rng = generator(4, &[at as u64]);
        let cells = Partition::new(&outcomes);
        let counts = cells.count((0..DRAWS).map(|_| outcomes.draw(true, || rng.random())));
        assert_follow(&counts, &cells.probabilities(&outcomes), &what);
    }
}

#[test]
fn hit_without_scatter_is_its_centre() {
    let model = SonarModel { constant: [0.0, 20.0], p_short: 0.0, p_dropout: 0.0, ..SENSORS[2].clone() };
    let fan = fan_at(&scenes()[0].sides(), &sensors()[0], 0.0);
    let outcomes = model.outcomes(&fan, &Perturbation::NONE);
    let mean_cm = outcomes.mean_hit_cm().expect("there is a wall");
    let mut rng = generator(6, &[]);
    let draws = (0..1000).filter_map(|_| outcomes.draw(false, || rng.random()));
    let hits = draws.filter(|cm| (cm - mean_cm).abs() < 1e-9).count();
    let expected: f64 = outcomes.components.iter().filter(|c| c.source == Source::Hit).map(|c| c.probability).sum();
    assert!((hits as f64 / 1000.0 - expected).abs() < 0.02, "{hits} {expected}");
}

#[test]
fn of_what_is_beyond_the_floor_almost_nothing_is_heard() {
    let floor = Perturbation { floor_cm: 60.0, p_floor: 0.4, ..Perturbation::NONE };
    let mut floor_heard: f64 = 0.0;
    for pose in sensors() {
        let fan = fan_at(&scenes()[0].sides(), &pose, SENSORS[0].fan_width);
        let [level, pitched] = [Perturbation::NONE, floor].map(|change| SENSORS[0].outcomes(&fan, &change));
        let sum: f64 = pitched.none + pitched.components.iter().map(|c| c.probability).sum::<f64>();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
        for (before, after) in level.components.iter().zip(&pitched.components) {
            let Distribution::Student { middle_cm, .. } = before.distribution else { continue };
            let kept = after.probability / before.probability.max(f64::MIN_POSITIVE);
            let is_hit = before.source == Source::Hit && before.probability > 0.0;
            assert!(!is_hit || middle_cm < 80.0 || kept < 0.01, "{middle_cm}: {kept}");
            assert!(!is_hit || middle_cm > 40.0 || kept > 0.99, "{middle_cm}: {kept}");
        }
        floor_heard = floor_heard.max(pitched.components.last().expect("the floor").probability);
    }
    assert!((0.3..=0.4).contains(&floor_heard), "{floor_heard}");
}
