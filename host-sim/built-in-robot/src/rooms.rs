//! The default robot and the default rooms.

use glam::DVec2;

use mindgap_foundations::geometry::{Pose, Rectangle};
use mindgap_logs::{Robot, Scene, Ultrasonic};

/// The default `robot.toml`: a LEGO NXT differential drive as its builder measured it.
pub fn default_robot() -> Robot {
    Robot {
        wheel_diameter_cm: 5.6,
        track_cm: 11.5,
        body_radius_cm: 10.0,
        step_ms: 400.0,
        full_speed_cm_s: 41.0,
        ultrasonic: Ultrasonic { x_cm: 7.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 4.0, max_cm: 240.0 },
    }
}

/// A room with four obstacles for random driving.
pub fn training_room() -> Scene {
    Scene {
        arena_cm: Some(DVec2::new(300.0, 220.0)),
        obstacles: vec![
            rectangle(60.0, 140.0, 30.0, 35.0),
            rectangle(110.0, 50.0, 50.0, 20.0),
            rectangle(190.0, 125.0, 25.0, 55.0),
            rectangle(225.0, 40.0, 35.0, 30.0),
        ],
        ..Scene::default()
    }
}

/// A room with four obstacles, a target and four starts, after figure 4 of the paper, which gives no dimensions.
pub fn four_obstacles() -> Scene {
    Scene {
        arena_cm: Some(DVec2::new(300.0, 220.0)),
        obstacles: vec![
            rectangle(65.0, 55.0, 35.0, 30.0),
            rectangle(175.0, 35.0, 30.0, 55.0),
            rectangle(115.0, 145.0, 55.0, 25.0),
            rectangle(225.0, 155.0, 30.0, 35.0),
        ],
        walls: Vec::new(),
        target_cm: Some(DVec2::new(260.0, 120.0)),
        starts: [(30.0, 25.0), (30.0, 185.0), (45.0, 115.0), (140.0, 25.0)].map(|(x, y)| Pose::new(x, y, 0.0)).into(),
    }
}

fn rectangle(x_cm: f64, y_cm: f64, width_cm: f64, height_cm: f64) -> Rectangle {
    let low_cm = DVec2::new(x_cm, y_cm);
    Rectangle { low_cm, high_cm: low_cm + DVec2::new(width_cm, height_cm) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_robot_has_room_at_every_start_and_at_the_target() {
        let (robot, scene) = (default_robot(), four_obstacles());
        let mut places = scene.starts.iter().map(|start| start.position_cm).chain(scene.target_cm);
        assert!(places.all(|at| scene.has_room_for(at, robot.body_radius_cm)));
        assert_eq!(scene.starts.len(), 4);
    }
}
