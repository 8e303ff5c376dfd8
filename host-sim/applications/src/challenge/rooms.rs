//! Random robots and rooms.

use glam::DVec2;
use rand::RngExt;

use mindgap_built_in_robot::default_robot;
use mindgap_foundations::geometry::Rectangle;
use mindgap_foundations::random::Generator;
use mindgap_logs::{Robot, Scene, Ultrasonic};

/// Smallest passage between two obstacles, or an obstacle and a wall, cm, so that a robot can pass.
const PASSAGE_CM: f64 = 38.0;
/// Number of attempts to place obstacles.
const TRIED: usize = 60;

/// Draws a random variation of the default robot.
pub fn robot(rng: &mut Generator) -> Robot {
    let usual = default_robot();
    let mut about = |value: f64, share: f64| {
        let varied = value * rng.random_range(1.0 - share..=1.0 + share);
        (10.0 * varied).round() / 10.0
    };
    Robot {
        wheel_diameter_cm: about(usual.wheel_diameter_cm, 0.2),
        track_cm: about(usual.track_cm, 0.2),
        body_radius_cm: usual.body_radius_cm,
        full_speed_cm_s: about(usual.full_speed_cm_s, 0.2),
        ultrasonic: usual.ultrasonic.map(|sensor| Ultrasonic { x_cm: about(sensor.x_cm, 0.3), ..sensor }),
        ..usual
    }
}

/// Draws a random room with a few obstacles between which a robot can pass.
pub fn room(rng: &mut Generator) -> Scene {
    let mut whole = |from: f64, to: f64| rng.random_range(from..=to).round();
    let arena_cm = DVec2::new(whole(240.0, 360.0), whole(190.0, 280.0));
    let wanted = whole(2.0, 5.0) as usize;
    let mut obstacles: Vec<Rectangle> = Vec::new();
    for _ in 0..TRIED {
        let size = DVec2::new(whole(15.0, 60.0), whole(15.0, 60.0));
        let low_cm = DVec2::new(whole(0.0, arena_cm.x), whole(0.0, arena_cm.y));
        let fresh = Rectangle { low_cm, high_cm: low_cm + size };
        let inside = low_cm.cmpge(DVec2::splat(PASSAGE_CM)).all()
            && fresh.high_cm.cmple(arena_cm - DVec2::splat(PASSAGE_CM)).all();
        if obstacles.len() < wanted && inside && obstacles.iter().all(|o| passage_cm(o, &fresh) >= PASSAGE_CM) {
            obstacles.push(fresh);
        }
    }
    Scene { arena_cm: Some(arena_cm), obstacles, ..Scene::default() }
}

fn passage_cm(a: &Rectangle, b: &Rectangle) -> f64 {
    (a.low_cm - b.high_cm).max(b.low_cm - a.high_cm).max(DVec2::ZERO).length()
}
