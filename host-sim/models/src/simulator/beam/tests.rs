use pulp::Scalar as One;

use super::*;
use crate::simulator::draws::Seeds;
use crate::sonar::fan_at;
use crate::sonar::partition::{PERTURBED, Partition, SENSORS, assert_follow, scenes, sensors};

/// No reading and each kind of reading come as often as the outcomes say.
#[test]
fn lanes_draw_the_outcomes_of_the_model() {
    let usual = SensorState::nominal(Pose::new(0.0, 0.0, 0.0));
    for (m, model) in SENSORS.iter().enumerate() {
        assert_draws(&Beam::new(model), model, &usual, 0.0, &format!("sensor {m}"));
    }
}

/// The same of a sensor that effects change.
#[test]
fn lanes_draw_the_outcomes_of_what_effects_leave() {
    let nominal = SensorState::nominal(Pose::new(0.0, 0.0, 0.0));
    let after_echo = SensorState { yaw_rad: 0.2, perturbation: Perturbation { width: 1.3, ..PERTURBED }, ..nominal };
    let mut after_none = after_echo;
    after_none.perturbation.p_dropout = 0.6;
    for (m, model) in SENSORS.iter().enumerate() {
        let beam = Beam::changed(model, &[after_echo, after_none]).expect("rays alike");
        assert_draws(&beam, model, &after_echo, 50.0, &format!("sensor {m} after an echo"));
        assert_draws(&beam, model, &after_none, f64::NAN, &format!("sensor {m} after none"));
        for otherwise in [Perturbation { width: 1.4, ..PERTURBED }, Perturbation { mirroring: 1.0, ..PERTURBED }] {
            assert!(
                Beam::changed(model, &[after_echo, SensorState { perturbation: otherwise, ..after_none }]).is_none()
            );
        }
    }
}

/// After a reading of `before_cm`.
fn assert_draws(beam: &Beam, model: &SonarModel, state: &SensorState, before_cm: f64, what: &str) {
    const DRAWS: usize = 20_000;
    let simd = One::new();
    let lane = |value: f64| Lanes::splat(simd, value as f32);
    let mut seeds = Seeds::default();
    seeds.set(0, 9);
    let mut draws = Draws::load(simd, &seeds);
    for (s, scene) in scenes().iter().enumerate() {
        let room = Room::new(scene);
        for (p, pose) in sensors().iter().enumerate() {
            let origin = Point { x: lane(pose.position_cm.x), y: lane(pose.position_cm.y) };
            let axis = Point { x: lane(pose.direction().x), y: lane(pose.direction().y) };
            let axis_deg = lane(pose.heading_rad.to_degrees());
            let mut reading = || {
                let heard = beam.hear(&room, origin, axis, axis_deg, &mut draws);
                let level = (number(draws.uniform()) * LEVELS as f32) as usize;
                let fate = Fate {
                    outcome: draws.uniform(),
                    place: draws.uniform(),
                    student: beam.scatter(simd, &[level; WIDEST]),
                    before_cm: lane(before_cm),
                };
                let echo_cm = f64::from(number(beam.report(&heard, &fate)));
                (!echo_cm.is_nan()).then_some(echo_cm)
            };
            let mut turned = *pose;
            turned.heading_rad += state.yaw_rad;
            let fan = fan_at(&scene.sides(), &turned, model.fan_width * state.perturbation.width);
            let outcomes = model.outcomes(&fan, &state.perturbation);
            let cells = Partition::new(&outcomes);
            let counts = cells.count((0..DRAWS).map(|_| reading()));
            assert_follow(&counts, &cells.probabilities(&outcomes), &format!("{what} at {p} of scene {s}"));
        }
    }
}

fn number(lane: Lanes<One>) -> f32 {
    let mut number = [0.0];
    lane.store(&mut number);
    number[0]
}
