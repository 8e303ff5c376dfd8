use pulp::Scalar as One;

use super::*;
use crate::simulator::draws::Seeds;
use crate::sonar::fan_at;
use crate::sonar::partition::{Partition, SENSORS, assert_follow, scenes, sensors};

/// No reading and each kind of reading come as often as the outcomes say.
#[test]
fn lanes_draw_the_outcomes_of_the_model() {
    const DRAWS: usize = 20_000;
    let simd = One::new();
    let lane = |value: f64| Lanes::splat(simd, value as f32);
    let mut seeds = Seeds::default();
    seeds.set(0, 9);
    let mut draws = Draws::load(simd, &seeds);
    for (s, scene) in scenes().iter().enumerate() {
        let room = Room::new(scene);
        for (p, pose) in sensors().iter().enumerate() {
            for (m, model) in SENSORS.iter().enumerate() {
                let beam = Beam::new(model);
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
                    };
                    let echo_cm = f64::from(number(beam.report(&heard, &fate)));
                    (!echo_cm.is_nan()).then_some(echo_cm)
                };
                let outcomes = model.outcomes(&fan_at(&scene.sides(), pose, model.fan_width), &Perturbation::NONE);
                let cells = Partition::new(&outcomes);
                let counts = cells.count((0..DRAWS).map(|_| reading()));
                assert_follow(&counts, &cells.probabilities(&outcomes), &format!("sensor {m} at {p} of scene {s}"));
            }
        }
    }
}

fn number(lane: Lanes<One>) -> f32 {
    let mut number = [0.0];
    lane.store(&mut number);
    number[0]
}
