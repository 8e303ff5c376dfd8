use glam::DVec2;
use proptest::prelude::*;
use rand::RngExt;

use super::{FirstEchoLaw, Surfaces, Target, TargetKind, reach_cm, targets_at};
use crate::sonar::Perturbation;
use crate::sonar::outcomes::{Outcomes, Source};
use crate::sonar::partition::{PERTURBED, Partition, assert_follow, scenes, sensors};
use mindgap_foundations::geometry::{Pose, Rectangle, Wall};
use mindgap_foundations::random::generator;
use mindgap_foundations::statistics::summary::logistic;

/// A sensor with all parts of the law, whose readings scatter little, so that cells separate them.
const LAW: FirstEchoLaw = FirstEchoLaw {
    gain: 2.7,
    spreading: 3.6,
    beam_deg: 9.0,
    beam_power: 1.4,
    specular_deg: 15.0,
    oblique_loss: 8.0,
    corner: -0.9,
    edge: -3.0,
    offset_cm: -1.4,
    scale: 1.01,
    off_axis_cm: 0.2,
    scatter_cm: 0.1,
    scatter_per_m: 0.2,
    scatter_off_axis: 0.1,
    p_dropout: 0.05,
    p_other: 0.3,
    p_long_given_other: 0.7,
    p_ghost: 0.08,
    ghost_cm: 21.0,
    p_stray: 0.02,
    range_cm: [4.0, 250.0],
};

fn wall(from: [f64; 2], to: [f64; 2]) -> Wall {
    Wall { from_cm: from.into(), to_cm: to.into() }
}

/// Returns a wall across the x axis, `distance_cm` from the origin.
fn wall_ahead(distance_cm: f64) -> Surfaces {
    Surfaces::new(vec![wall([distance_cm, -500.0], [distance_cm, 500.0])])
}

fn at(x_cm: f64, y_cm: f64, deg: f64) -> Pose {
    Pose::new(x_cm, y_cm, deg.to_radians())
}

fn hits(outcomes: &Outcomes) -> f64 {
    outcomes.components.iter().filter(|c| c.source == Source::Hit).map(|c| c.probability).sum()
}

/// Returns the probability of a hit if the strongest echo has this strength and is farther than the ghost.
fn heard(loudest: f64) -> f64 {
    (1.0 - LAW.p_stray) * (1.0 - LAW.p_ghost) * (1.0 - LAW.p_dropout) * logistic(loudest)
}

#[test]
fn wall_ahead_is_heard_only_at_its_foot() {
    for distance_cm in [30.0, 80.0, 200.0] {
        let outcomes = LAW.outcomes_at(&wall_ahead(distance_cm), &at(0.0, 0.0, 0.0));
        let expected = heard(2.7 - 3.6 * libm::log(distance_cm / 100.0));
        assert!((hits(&outcomes) - expected).abs() < 1e-12, "{distance_cm}: {} {expected}", hits(&outcomes));
        let mean_cm = outcomes.mean_hit_cm().expect("a wall");
        assert!((mean_cm - (1.01 * distance_cm - 1.4)).abs() < 1e-9, "{mean_cm}");
    }
}

#[test]
fn oblique_wall_is_as_strong_as_its_strongest_part() {
    // The wall's foot is 30 degrees off the axis at 60 cm, and a ray turned towards it hits the wall at an incidence of 30
    // degrees minus the angle of the ray.
    let outcomes = LAW.outcomes_at(&wall_ahead(60.0), &at(0.0, 0.0, 30.0));
    let strength = |off_deg: f64| {
        let incidence_deg = 30.0 - off_deg;
        let loss = 8.0 * (1.0 - libm::exp(-libm::pow(incidence_deg / 15.0, 2.0) / 8.0));
        let distance_m = 0.6 / libm::cos(incidence_deg.to_radians());
        2.7 - 3.6 * libm::log(distance_m) - libm::pow(off_deg / 9.0, 1.4) - loss
    };
    let loudest = (0..=10).map(|ray| strength(3.0 * f64::from(ray))).fold(f64::NEG_INFINITY, f64::max);
    assert!((hits(&outcomes) - heard(loudest)).abs() < 1e-9, "{} {}", hits(&outcomes), heard(loudest));
    assert!(strength(30.0) < loudest && strength(0.0) < loudest, "neither foot nor axis");
}

#[test]
fn corner_returns_an_echo_where_walls_do_not() {
    let room = Rectangle { low_cm: DVec2::ZERO, high_cm: DVec2::splat(200.0) };
    let surfaces = Surfaces::new(room.edges().to_vec());
    let sensor = at(100.0, 100.0, 45.0);
    let corner = targets_at(&surfaces, &sensor).into_iter().find(|target| target.kind == TargetKind::Corner);
    let corner = corner.expect("it is ahead");
    assert!((corner.distance_cm - 100.0 * 2f64.sqrt()).abs() < 1e-9 && corner.off_axis_deg < 1e-9, "{corner:?}");
    assert!((LAW.strength(&corner) - (2.7 - 3.6 * libm::log(2f64.sqrt()) - 0.9)).abs() < 1e-9);
    let deaf = FirstEchoLaw { corner: -30.0, ..LAW };
    let [with, without] = [&LAW, &deaf].map(|law| hits(&law.outcomes_at(&surfaces, &sensor)));
    assert!(with > 2.0 * without, "{with} {without}");
}

#[test]
fn corners_and_edges_depend_on_the_viewpoint() {
    let obstacle = Rectangle { low_cm: DVec2::splat(90.0), high_cm: DVec2::splat(110.0) };
    let points = |walls: &[Wall], x_cm: f64, y_cm: f64, deg: f64| {
        let targets = targets_at(&Surfaces::new(walls.to_vec()), &at(x_cm, y_cm, deg));
        [TargetKind::Corner, TargetKind::Edge].map(|kind| targets.iter().filter(|t| t.kind == kind).count())
    };
    assert_eq!(points(&obstacle.edges(), 50.0, 50.0, 45.0), [0, 1], "the others are masked");
    // A wall that ends at the middle of another makes two corners in one, from its side.
    let junction = [wall([0.0, 100.0], [200.0, 100.0]), wall([100.0, 100.0], [100.0, 150.0])];
    assert_eq!(points(&junction, 60.0, 130.0, -20.0), [1, 1], "and its free end");
    assert_eq!(points(&junction, 100.0, 50.0, 90.0)[0], 0, "from behind it is flat");
    // Collinear walls make no corner.
    assert_eq!(points(&[wall([0.0, 90.0], [50.0, 90.0]), wall([50.0, 90.0], [100.0, 90.0])], 50.0, 60.0, 90.0)[0], 0);
}

#[test]
fn foot_outside_its_wall_is_not_a_target() {
    let feet = |y_cm: f64| {
        let surfaces = Surfaces::new(vec![wall([50.0, 0.0], [50.0, 40.0])]);
        let targets = targets_at(&surfaces, &at(0.0, y_cm, 20.5));
        targets.iter().filter(|target| target.kind == TargetKind::Foot).count()
    };
    assert_eq!([feet(20.0), feet(-5.0), feet(45.0)], [1, 0, 0]);
}

#[test]
fn hidden_surfaces_are_not_targets() {
    let walls = [wall([50.0, -200.0], [50.0, 200.0]), wall([80.0, -200.0], [80.0, 200.0])];
    let targets = targets_at(&Surfaces::new(walls.to_vec()), &at(0.0, 0.0, 0.0));
    assert!(targets.iter().all(|target| target.distance_cm < 79.0 || target.off_axis_deg > 30.0), "{targets:?}");
}

#[test]
fn weaker_echo_behind_a_stronger_one_is_never_first() {
    let target = |distance_cm, kind| Target::new(distance_cm, 0.0, kind);
    let near = target(50.0, TargetKind::Foot);
    let [weak, strong] = [TargetKind::Edge, TargetKind::Foot].map(|kind| target(60.0, kind));
    let hits_of = |targets: &[Target]| hits(&LAW.outcomes(targets, 50.0, &Perturbation::NONE));
    assert_eq!(hits_of(&[near, weak]), hits_of(&[near]));
    assert!((hits_of(&[weak, strong]) - heard(LAW.strength(&strong))).abs() < 1e-12);
}

/// A perturbation equals a change of the sensor's parameters.
#[test]
fn perturbed_sensor_equals_a_sensor_with_other_parameters() {
    let louder = FirstEchoLaw { gain: LAW.gain + 0.7, ..LAW };
    let wider = FirstEchoLaw { beam_deg: 1.5 * LAW.beam_deg, off_axis_cm: LAW.off_axis_cm / 2.25, ..LAW };
    let wider = FirstEchoLaw { scatter_off_axis: LAW.scatter_off_axis / 1.5, ..wider };
    // The same electronics measure the ghost.
    let longer = FirstEchoLaw { offset_cm: LAW.offset_cm + 4.0, ghost_cm: LAW.ghost_cm + 4.0, ..LAW };
    let others = [
        (louder, Perturbation { attenuation: -0.7, ..Perturbation::NONE }),
        (wider, Perturbation { width: 1.5, ..Perturbation::NONE }),
        (longer, Perturbation { offset_cm: 4.0, ..Perturbation::NONE }),
    ];
    let surfaces = Surfaces::new(scenes()[0].sides());
    for sensor in sensors() {
        let targets = targets_at(&surfaces, &sensor);
        for (other, change) in &others {
            let reach_cm = reach_cm(&surfaces, &sensor);
            let [perturbed, other] = [(&LAW, change), (other, &Perturbation::NONE)]
                .map(|(law, change)| law.outcomes(&targets, reach_cm, change));
            for echo_cm in [None, Some(21.0), Some(60.0), Some(90.0), Some(170.0)] {
                let [a, b] = [&perturbed, &other].map(|outcomes| outcomes.log_likelihood(echo_cm));
                assert!((a - b).abs() < 1e-9, "{change:?}: {a} {b}");
            }
        }
    }
}

/// With the width of a beam and the usual losses, the ideal ray behaves as a usual sensor.
#[test]
fn perturbed_ideal_ray_equals_a_usual_sensor() {
    let ray = FirstEchoLaw::ideal_ray(0.5, 0.0, LAW.range_cm);
    let usual = FirstEchoLaw {
        gain: 2.7,
        spreading: 3.65,
        beam_deg: 8.7,
        specular_deg: 15.0,
        oblique_loss: 10.7,
        ..FirstEchoLaw::ideal_ray(0.5, 0.0, LAW.range_cm)
    };
    let change = Perturbation { width: 20.0, attenuation: 3.3, spreading: 3.65, mirroring: 1.0, ..Perturbation::NONE };
    let surfaces = Surfaces::new(scenes()[0].sides());
    for sensor in sensors() {
        let targets = targets_at(&surfaces, &sensor);
        let [a, b] = [(&ray, &change), (&usual, &Perturbation::NONE)]
            .map(|(law, change)| law.outcomes(&targets, reach_cm(&surfaces, &sensor), change));
        assert!((a.none - b.none).abs() < 1e-6, "{} {}", a.none, b.none);
        let axis_cm = reach_cm(&surfaces, &sensor);
        let heard = ray.outcomes(&targets, axis_cm, &Perturbation::NONE);
        let mean_cm = heard.mean_hit_cm().expect("the ray meets something");
        assert!(heard.none < 0.01 && (mean_cm - axis_cm).abs() < 0.5, "{mean_cm} for {axis_cm}");
    }
}

/// Returns the outcomes at every pose in every scene, of the unperturbed and the perturbed sensor.
fn grid() -> Vec<(String, Outcomes)> {
    let mut grid = Vec::new();
    for (s, scene) in scenes().iter().enumerate() {
        let surfaces = Surfaces::new(scene.sides());
        for (p, sensor) in sensors().iter().enumerate() {
            for (name, change) in [("as it is", Perturbation::NONE), ("perturbed", PERTURBED)] {
                let outcomes = LAW.outcomes(&targets_at(&surfaces, sensor), reach_cm(&surfaces, sensor), &change);
                grid.push((format!("{p} of scene {s}, {name}"), outcomes));
            }
        }
    }
    grid
}

#[test]
fn frequencies_of_drawn_readings_follow_the_likelihood() {
    const DRAWS: usize = 20_000;
    for (place, (what, outcomes)) in grid().into_iter().enumerate() {
        let mut rng = generator(7, &[place as u64]);
        let cells = Partition::new(&outcomes);
        let counts = cells.count((0..DRAWS).map(|_| outcomes.draw(true, || rng.random())));
        assert_follow(&counts, &cells.probabilities(&outcomes), &what);
    }
}

#[test]
fn likelihood_integrates_to_one() {
    const STEPS: usize = 100_000;
    for (what, outcomes) in grid() {
        let [low, high] = LAW.range_cm;
        let width = (high - low) / STEPS as f64;
        let density = |i: usize| outcomes.density(low + (i as f64 + 0.5) * width);
        let sum = outcomes.none + (0..STEPS).map(|i| width * density(i)).sum::<f64>();
        assert!((sum - 1.0).abs() < 2e-3, "{what}: {sum}");
    }
}

#[test]
fn files_keep_their_names() {
    let file = serde_json::to_value(&LAW).expect("numbers have a form in files");
    let names = "beam_deg beam_power corner edge gain ghost_cm oblique_loss off_axis_cm offset_cm p_dropout p_ghost \
                 p_long_given_other p_other p_stray range_cm scale scatter_cm scatter_off_axis scatter_per_m \
                 specular_deg spreading";
    assert_eq!(file.as_object().expect("a table").keys().map(String::as_str).collect::<Vec<_>>().join(" "), names);
    assert_eq!(serde_json::from_value::<FirstEchoLaw>(file).expect("it was just written"), LAW);
    assert!(LAW.is_sound());
    assert!(!FirstEchoLaw { beam_deg: 0.0, ..LAW.clone() }.is_sound());
    assert!(!FirstEchoLaw { p_ghost: f64::NAN, ..LAW }.is_sound());
}

proptest! {
    #[test]
    fn probabilities_add_up_to_one(x in 5.0..295.0, y in 5.0..215.0, deg in -180.0..180.0, ghost_cm in 5.0..200.0) {
        let law = FirstEchoLaw { ghost_cm, ..LAW };
        for scene in scenes() {
            let outcomes = law.outcomes_at(&Surfaces::new(scene.sides()), &at(x, y, deg));
            let probabilities = outcomes.components.iter().map(|c| c.probability);
            prop_assert!(probabilities.clone().chain([outcomes.none]).all(|p| (0.0..=1.0).contains(&p)));
            prop_assert!((probabilities.sum::<f64>() + outcomes.none - 1.0).abs() < 1e-12);
        }
    }

    /// Rotating and shifting the room with the sensor changes no outcome.
    #[test]
    fn outcomes_are_invariant_under_rigid_motion(x in 20.0..80.0, deg in -180.0..180.0, turn in -3.0..3.0) {
        let scene = &scenes()[0];
        let origin = Pose::new(37.0, -12.0, turn);
        let moved = |point_cm: DVec2| origin.compose(&Pose { position_cm: point_cm, heading_rad: 0.0 }).position_cm;
        let turned = scene.sides().iter().map(|w| Wall { from_cm: moved(w.from_cm), to_cm: moved(w.to_cm) }).collect();
        let sensor = at(x, 70.0, deg);
        let [here, there] = [(scene.sides(), sensor), (turned, origin.compose(&sensor))]
            .map(|(sides, sensor)| LAW.outcomes_at(&Surfaces::new(sides), &sensor));
        for echo_cm in [None, Some(21.0), Some(45.0), Some(80.0), Some(200.0)] {
            prop_assert!((here.log_likelihood(echo_cm) - there.log_likelihood(echo_cm)).abs() < 1e-6);
        }
    }
}
