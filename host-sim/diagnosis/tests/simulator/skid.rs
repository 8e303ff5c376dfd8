//! Robots that turn less or more than their wheels say, against the textbook.

use glam::DVec2;
use mindgap_built_in_robot::default_robot;
use mindgap_diagnosis::diagnose;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;
use mindgap_logs::{Logs, Row, Run, Scene};
use mindgap_models::simulator::kinematic;
use rand::RngExt;
use rand_distr::StandardNormal;

/// Time step of the physics, s.
const DT_S: f64 = 0.01;

/// Logs of wheels on a track `stretch` times as wide as robot.toml says, integrated in small steps.
fn logs(stretch: f64) -> Logs {
    let robot = default_robot();
    let scene = Scene { arena_cm: Some(DVec2::splat(2000.0)), ..Scene::default() };
    let run = |number: u64| {
        let mut rng = generator(23, &[number]);
        let (mut pose, mut command) = (Pose::new(1000.0, 1000.0, 0.3), [0.0; 2]);
        let row = |step: usize| {
            if step.is_multiple_of(5) {
                command = [0, 1].map(|_| rng.random_range(-80.0..80.0f64).round());
            }
            let noise: [f64; 3] = [0.1, 0.1, 0.005].map(|s: f64| s * rng.sample::<f64, _>(StandardNormal));
            let at =
                Pose::new(pose.position_cm.x + noise[0], pose.position_cm.y + noise[1], pose.heading_rad + noise[2]);
            let speeds_cm_s = command.map(|c| c / 100.0 * robot.full_speed_cm_s);
            for _ in 0..(robot.step_ms / 1000.0 / DT_S).round() as usize {
                let way_cm = 0.5 * (speeds_cm_s[0] + speeds_cm_s[1]) * DT_S;
                let turn_rad = (speeds_cm_s[1] - speeds_cm_s[0]) / (stretch * robot.track_cm) * DT_S;
                pose.position_cm += way_cm * DVec2::from_angle(pose.heading_rad + 0.5 * turn_rad);
                pose.heading_rad += turn_rad;
            }
            Row {
                t_ms: step as f64 * robot.step_ms,
                left: command[0],
                right: command[1],
                pose: Some(at),
                ..Row::default()
            }
        };
        Run { name: format!("run-{number:03}"), rows: (0..60).map(row).collect() }
    };
    Logs { robot, scene: scene.clone(), runs: (0..16).map(run).collect() }
}

#[test]
fn another_track_is_a_factor_on_turns_alone() {
    for stretch in [0.78, 1.22, 2.4] {
        let logs = logs(stretch);
        let diagnosis = diagnose(kinematic::baseline(&logs), &logs).expect("comparable logs");
        let [found] = diagnosis.effects.as_slice() else { panic!("{stretch}: {:?}", diagnosis.effects) };
        let factor = found.parameters["factor"].as_f64().expect("a number");
        assert!(found.id == "track_width" && found.probability > 0.9, "{stretch}: {found:?}");
        assert!((factor * stretch - 1.0).abs() < 0.01, "{stretch}: {found:?}");
    }
}
