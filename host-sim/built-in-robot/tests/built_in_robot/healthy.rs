//! The healthy built-in robot: what its logs look like, and that they are the same again and again.

use std::sync::LazyLock;

use glam::DVec2;
use mindgap_built_in_robot::{
    ActiveEffect, BuiltInRobot, Effect, Termination, default_robot, four_obstacles, record, run_controller,
    training_room,
};
use mindgap_core::controller::{Controller, Tuple, When};
use mindgap_foundations::chance::generator;
use mindgap_foundations::geometry::{Pose, Rectangle};
use mindgap_logs::samples::{motion, sonar};
use mindgap_logs::{Logs, Scene};

/// 40 runs of the healthy robot.
static HEALTHY: LazyLock<Logs> =
    LazyLock::new(|| record(&default_robot(), &training_room(), 40, 60, &[], 11).expect("the room is large enough"));

fn short(effects: &[ActiveEffect], seed: u64) -> Logs {
    record(&default_robot(), &four_obstacles(), 3, 20, effects, seed).expect("the room is large enough")
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn three_readings_of_four_give_a_value() {
    let rows = HEALTHY.runs.iter().flat_map(|run| &run.rows);
    let (all, with_echo) = rows.fold((0, 0), |(n, e), row| (n + 1, e + usize::from(row.echo_cm.is_some())));
    let rate = f64::from(with_echo as u32) / f64::from(all);
    assert!((0.70..=0.85).contains(&rate), "{rate}");
}

#[test]
fn readings_are_whole_centimetres_near_the_wall_ahead() {
    let near =
        sonar(&HEALTHY).into_iter().filter(|s| s.distance_cm > 30.0 && s.distance_cm < 80.0 && s.alpha_deg() < 12.0);
    let errors: Vec<f64> = near.filter_map(|s| Some(s.echo_cm? - s.distance_cm)).collect();
    let close = errors.iter().filter(|e| e.abs() < 4.0).count();
    assert!(errors.len() > 100 && close as f64 > 0.85 * errors.len() as f64, "{close} of {}", errors.len());
    let echoes = HEALTHY.runs.iter().flat_map(|run| &run.rows).filter_map(|row| row.echo_cm);
    let sensor = default_robot().ultrasonic;
    for echo_cm in echoes {
        assert!(echo_cm == echo_cm.round() && (sensor.min_cm..=sensor.max_cm).contains(&echo_cm), "{echo_cm}");
    }
}

#[test]
fn the_ringing_transducer_gives_a_constant_reading_now_and_then() {
    let far = sonar(&HEALTHY).into_iter().filter(|s| s.distance_cm > 60.0);
    let readings: Vec<f64> = far.filter_map(|s| s.echo_cm).collect();
    let around = |cm: f64| readings.iter().filter(|r| (**r - cm).abs() < 2.5).count() as f64 / readings.len() as f64;
    assert!((0.01..0.08).contains(&around(20.0)) && around(20.0) > 3.0 * around(13.0), "{}", around(20.0));
}

#[test]
fn steps_scatter_a_little_and_remember_the_last_command() {
    let steady = motion(&HEALTHY).into_iter().filter(|s| {
        let [left, right, last_left, last_right] = s.speeds;
        (left - right).abs() < 4.0 && left == last_left && right == last_right && left.abs() > 20.0
    });
    let (ways, turns): (Vec<f64>, Vec<f64>) =
        steady.map(|s| (s.forward_cm - 0.2 * 0.41 * (s.speeds[0] + s.speeds[1]), s.turn_rad.to_degrees())).unzip();
    assert!(ways.len() > 50 && (0.2..0.7).contains(&deviation(&ways)), "{}", deviation(&ways));
    assert!((0.6..2.0).contains(&deviation(&turns)), "{}", deviation(&turns));
    let share = |first: bool| {
        let chosen = motion(&HEALTHY).into_iter().filter(|s| s.speeds[0] + s.speeds[1] > 60.0 && (s.row == 0) == first);
        let (way, commanded) = chosen.fold((0.0, 0.0), |(w, c), s| (w + s.forward_cm, c + s.speeds[0] + s.speeds[1]));
        way / commanded
    };
    assert!(share(true) < 0.95 * share(false), "{} {}", share(true), share(false));
}

#[test]
fn rows_are_a_step_apart_give_or_take_milliseconds() {
    let steps: Vec<f64> = HEALTHY.runs.iter().flat_map(|run| run.rows.pairs().map(|w| w[1].t_ms - w[0].t_ms)).collect();
    assert!(steps.iter().all(|ms| *ms == ms.round() && (ms - 400.0).abs() < 30.0));
    assert!((1.0..8.0).contains(&deviation(&steps)), "{}", deviation(&steps));
}

#[test]
fn nothing_is_hit() {
    let radius_cm = default_robot().body_radius_cm;
    for row in HEALTHY.runs.iter().flat_map(|run| &run.rows) {
        let Some(pose) = row.pose else { continue };
        assert!(HEALTHY.scene.has_room_for(pose.position_cm, radius_cm), "{pose:?}");
    }
    let stuck = HEALTHY.runs.iter().flat_map(|run| &run.rows).filter(|row| row.command() == [0.0, 0.0]).count();
    assert!(stuck < 20, "stopped {stuck} times");
}

#[test]
fn one_seed_gives_one_folder_on_any_number_of_threads() {
    let effects = [ActiveEffect::new(Effect::SonarDropout), ActiveEffect::new(Effect::Slope)];
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| short(&effects, 5));
    assert_eq!(alone, short(&effects, 5));
    assert_ne!(alone, short(&effects, 6));
}

#[test]
fn a_folder_of_logs_comes_back_as_it_went() {
    let folder = tempfile::tempdir().unwrap();
    let logs = short(&[], 5);
    logs.write(&folder.path().join("logs")).unwrap();
    let back = Logs::read(&folder.path().join("logs"), |warning| panic!("{warning}")).unwrap();
    assert_eq!(back, logs);
}

#[test]
fn every_effect_at_both_ends_of_its_range_gives_logs_that_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    for effect in Effect::all() {
        let range = effect.strength_range();
        for strength in [range.lowest, range.highest] {
            let active = ActiveEffect { strength, ..ActiveEffect::new(effect) };
            let logs = record(&default_robot(), &training_room(), 2, 12, &[active], 3).unwrap();
            logs.write(&folder.path().join("logs")).unwrap();
            let back = Logs::read(&folder.path().join("logs"), |warning| panic!("{warning}")).unwrap();
            assert_eq!(back, logs, "{active}");
            let poses = logs.runs.iter().flat_map(|run| &run.rows).filter_map(|row| row.pose);
            let room = Rectangle { low_cm: DVec2::splat(-60.0), high_cm: DVec2::new(360.0, 280.0) };
            assert!(poses.map(|pose| pose.position_cm).all(|at_cm| room.contains(at_cm)), "{active}");
        }
    }
}

#[test]
fn an_effect_of_neutral_strength_is_none() {
    let healthy = short(&[], 5);
    for effect in Effect::all() {
        let neutral = ActiveEffect { strength: effect.strength_range().neutral, ..ActiveEffect::new(effect) };
        assert_eq!(short(&[neutral], 5), healthy, "{neutral}");
    }
}

#[test]
fn two_effects_at_once_leave_both_marks() {
    let both: Vec<ActiveEffect> = ["sonar_offset=8", "battery_sag=0.8"].map(|text| text.parse().unwrap()).into();
    let logs = record(&default_robot(), &training_room(), 20, 60, &both, 4).unwrap();
    let near = sonar(&logs).into_iter().filter(|s| s.distance_cm < 60.0 && s.alpha_deg() < 12.0);
    let errors: Vec<f64> = near.filter_map(|s| Some(s.echo_cm? - s.distance_cm)).collect();
    assert!(errors.iter().filter(|e| **e > 4.0).count() as f64 > 0.7 * errors.len() as f64);
    let share = |late: bool| {
        let chosen = motion(&logs).into_iter().filter(|s| s.speeds[0] + s.speeds[1] > 60.0 && (s.row > 40) == late);
        let (way, commanded) = chosen.fold((0.0, 0.0), |(w, c), s| (w + s.forward_cm, c + s.speeds[0] + s.speeds[1]));
        way / commanded
    };
    assert!(share(true) < 0.88 * share(false));
}

#[test]
fn full_speed_and_wheel_counters_are_the_spec_s() {
    let spec = default_robot();
    let open = Scene { arena_cm: Some(DVec2::new(1000.0, 200.0)), ..Scene::default() };
    let robot = BuiltInRobot::new(&spec, &open, &[]);
    let mut rng = generator(8, &[]);
    let mut body = robot.start(Pose::new(50.0, 100.0, 0.0), &mut rng);
    body.drive([100.0, 100.0], 2000.0, &mut rng);
    let (from_cm, from) = (body.true_pose().position_cm, body.row([0.0, 0.0], None, &mut rng));
    body.drive([100.0, 100.0], 10_000.0, &mut rng);
    let (to_cm, to) = (body.true_pose().position_cm, body.row([0.0, 0.0], None, &mut rng));
    let speed_cm_s = from_cm.distance(to_cm) / 10.0;
    assert!((speed_cm_s / spec.full_speed_cm_s - 1.0).abs() < 0.04, "{speed_cm_s}");
    let turned_deg = to.rot_left_deg.unwrap() - from.rot_left_deg.unwrap();
    let rolled_cm = turned_deg.to_radians() * spec.wheel_diameter_cm / 2.0;
    assert!((rolled_cm / from_cm.distance(to_cm) - 1.0).abs() < 0.03, "{rolled_cm}");
    assert!(to.battery_mv.unwrap() < 9000.0 && to.battery_mv.unwrap() > 5000.0);
}

#[test]
fn a_room_without_room_is_a_problem() {
    let narrow = Scene { arena_cm: Some(DVec2::new(300.0, 15.0)), ..Scene::default() };
    assert!(record(&default_robot(), &narrow, 1, 10, &[], 1).unwrap_err().to_string().contains("no room"));
    let open = Scene { arena_cm: None, ..training_room() };
    assert!(record(&default_robot(), &open, 1, 10, &[], 1).unwrap_err().to_string().contains("no room"));
    assert!(record(&default_robot(), &training_room(), 0, 10, &[], 1).is_err());
}

/// A room with one wall of an obstacle 50 cm ahead.
fn wall_ahead() -> Scene {
    let block = Rectangle { low_cm: DVec2::new(100.0, 0.0), high_cm: DVec2::new(130.0, 100.0) };
    Scene { arena_cm: Some(DVec2::new(300.0, 100.0)), obstacles: vec![block], ..Scene::default() }
}

#[test]
fn a_crash_is_where_the_body_touches() {
    let spec = default_robot();
    let robot = BuiltInRobot::new(&spec, &wall_ahead(), &[]);
    let mut rng = generator(2, &[]);
    let mut body = robot.start(Pose::new(50.0, 50.0, 0.0), &mut rng);
    body.drive([80.0, 80.0], 900.0, &mut rng);
    assert!(!body.crashed() && body.clearance_cm() > 0.0);
    body.drive([80.0, 80.0], 3000.0, &mut rng);
    let x_cm = body.true_pose().position_cm.x;
    // One tick of 2 ms at 41 cm/s is less than 0.1 cm.
    assert!(body.crashed() && (x_cm - 90.0).abs() < 0.1, "{x_cm}");
    body.drive([-80.0, -80.0], 1000.0, &mut rng);
    assert_eq!(body.true_pose().position_cm.x, x_cm, "a crashed robot stays");
}

#[test]
fn a_controller_stops_for_the_wall_or_crashes_into_it_or_runs_out_of_steps() {
    let robot = BuiltInRobot::new(&default_robot(), &wall_ahead(), &[]);
    let start = Pose::new(30.0, 50.0, 0.0);
    let run = |speed: i8, threshold_cm: i16, max_steps: u16| {
        let ahead = Tuple { left: speed, right: speed, when: When::Smaller, threshold_cm };
        let controller = Controller { step_ms: 400, max_steps, tuples: [ahead; 6] };
        run_controller(&robot, &controller, start, &mut generator(9, &[]))
    };
    let finished = run(25, 200, 100);
    assert_eq!(finished.termination, Termination::Finished);
    assert!(finished.points.len() >= 8 && finished.end().position_cm.x > 45.0);
    let log = finished.to_run("run-000");
    // The sensor, 7 cm ahead of the axle, faces the wall at 100 cm before the controller first looks.
    assert_eq!((log.rows.at(0).left, log.rows.at(0).echo_cm), (25.0, Some(63.0)));
    assert_eq!(log.rows.at(log.rows.len() - 1).left, 0.0);
    assert_eq!(run(60, 0, 100).termination, Termination::Crashed);
    let timed_out = run(10, 0, 4);
    assert_eq!((timed_out.termination, timed_out.points.len()), (Termination::TimedOut, 6));
}
