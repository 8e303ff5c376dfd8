//! Changes that change nothing physical: the diagnosis has to find the same causes.

use std::collections::BTreeSet;

use glam::DVec2;
use mindgap_built_in_robot::default_robot;
use mindgap_diagnosis::diagnose;
use mindgap_diagnosis::verdict::NamedEffect;
use mindgap_foundations::geometry::{Pose, Wall, direction, wrap_rad};
use mindgap_foundations::motion::Motion;
use mindgap_foundations::random::generator;
use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_learning::evaluation::predictions;
use mindgap_logs::{Logs, Row, Run, Scene};
use mindgap_models::effects::Candidate;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::context::{RunHistory, Surroundings};
use mindgap_models::simulator::baseline::{Baseline, MotionModel};
use mindgap_models::simulator::kinematic;
use rand::RngExt;
use rand_distr::StandardNormal;

use crate::{SIMULATOR, logs};

fn named(baseline: Baseline, logs: &Logs) -> BTreeSet<&'static str> {
    diagnose(baseline, logs).expect("poses").effects.iter().map(|effect| effect.id).collect()
}

fn learned(logs: &Logs) -> BTreeSet<&'static str> {
    named(Baseline::at_posterior_mean(&SIMULATOR).expect("a reference"), logs)
}

fn textbook(logs: &Logs) -> BTreeSet<&'static str> {
    named(kinematic::baseline(logs), logs)
}

/// Runs of a textbook robot whose commands act 150 ms late and which loses 0.6 of its track in a radian of turn.
fn late_and_losing() -> Logs {
    let effects = [("latency", "delay", vec![0.375]), ("turn_loss", "at_any_speed", vec![0.6])];
    let (variants, values): (Vec<_>, Vec<Vec<f64>>) = effects
        .map(|(effect, variant, values)| (Candidate::named(effect, variant).expect(effect).variant, values))
        .into_iter()
        .unzip();
    let chain = EffectChain::default().with(&variants, &values.concat());
    let robot = default_robot();
    let drive = MotionModel::Kinematic { robot, scatter: Motion::splat(0.1) };
    let scene = Scene { arena_cm: Some(DVec2::splat(2000.0)), ..Scene::default() };
    let surroundings = Surroundings::new(&robot, &scene);
    let run = |number: u64| {
        let mut rng = generator(17, &[number]);
        let (mut history, mut pose, mut command) = (RunHistory::default(), Pose::new(1000.0, 1000.0, 0.3), [0.0; 2]);
        let row = |step: usize| {
            if rng.random::<f64>() < 0.4 || step == 0 {
                command = [0, 1].map(|_| rng.random_range(10.0..60.0f64).round());
            }
            let noise: [f64; 3] = [0.2, 0.1, 0.01].map(|s: f64| s * rng.sample::<f64, _>(StandardNormal));
            let seen =
                Pose::new(pose.position_cm.x + noise[0], pose.position_cm.y + noise[1], pose.heading_rad + noise[2]);
            history.command(command);
            let t_ms = step as f64 * robot.step_ms;
            let context = surroundings.context(&history, t_ms, pose);
            history.leave(Some(&context), None);
            pose = predictions::step(&chain, &drive, &context).end(&pose);
            Row { t_ms, left: command[0], right: command[1], pose: Some(seen), ..Row::default() }
        };
        Run { name: format!("run-{number:03}"), rows: (0..60).map(row).collect() }
    };
    Logs { robot, scene: scene.clone(), runs: (0..12).map(run).collect() }
}

/// The same logs with room and poses turned about the origin, then shifted.
fn moved(logs: &Logs, turn_rad: f64, shift_cm: DVec2) -> Logs {
    let moved = |at_cm: DVec2| direction(turn_rad).rotate(at_cm) + shift_cm;
    let side = |side: &Wall| Wall { from_cm: moved(side.from_cm), to_cm: moved(side.to_cm) };
    let scene = Scene { walls: logs.scene.sides().iter().map(side).collect(), ..Scene::default() };
    let pose =
        |pose: Pose| Pose { position_cm: moved(pose.position_cm), heading_rad: wrap_rad(pose.heading_rad + turn_rad) };
    with_rows(Logs { scene, ..logs.clone() }, |row| row.pose = row.pose.map(pose))
}

fn with_rows(mut logs: Logs, change: impl Fn(&mut Row)) -> Logs {
    logs.runs.iter_mut().for_each(|run| run.rows.edit_each(&change));
    logs
}

#[test]
fn a_room_that_is_turned_and_shifted_is_the_same_room() {
    for effect in ["battery_sag", "sonar_offset"] {
        let logs = logs(16, &[effect], 71);
        let causes = learned(&logs);
        assert_eq!(causes, BTreeSet::from([effect]));
        assert_eq!(learned(&moved(&logs, 0.8, DVec2::new(-300.0, 500.0))), causes);
    }
}

#[test]
fn the_order_of_runs_does_not_matter() {
    let logs = logs(16, &["motor_asymmetry"], 72);
    let mut reversed = logs.clone();
    reversed.runs.reverse();
    reversed.runs.iter_mut().enumerate().for_each(|(i, run)| run.name = format!("run-{:03}", 500 + i));
    assert_eq!(learned(&reversed), learned(&logs));
}

#[test]
fn what_acts_on_the_textbook_is_found_whatever_the_units_and_the_hand() {
    let logs = late_and_losing();
    let causes = textbook(&logs);
    assert_eq!(causes, BTreeSet::from(["latency", "turn_loss"]));

    let mut half_the_commands =
        with_rows(logs.clone(), |row| (row.left, row.right) = (0.5 * row.left, 0.5 * row.right));
    half_the_commands.robot.full_speed_cm_s *= 2.0;
    assert_eq!(textbook(&half_the_commands), causes, "other units of command");

    let mirrored = with_rows(logs.clone(), |row| {
        (row.left, row.right) = (row.right, row.left);
        row.pose = row.pose.map(|p| Pose::new(p.position_cm.x, 2000.0 - p.position_cm.y, -p.heading_rad));
    });
    assert_eq!(textbook(&mirrored), causes, "mirrored");

    let mut seldom_seen = logs.clone();
    for run in &mut seldom_seen.runs {
        (1..run.rows.len()).step_by(2).for_each(|k| run.rows.edit(k, |row| row.pose = None));
    }
    assert_eq!(textbook(&seldom_seen), causes, "poses at twice the step");

    assert_eq!(textbook(&moved(&logs, -2.0, DVec2::new(70.0, -40.0))), causes, "turned");

    // The second halves begin while the robot moves.
    let halves = logs.runs.iter().flat_map(|run| {
        let begin_ms = run.rows.at(30).t_ms;
        let second = run.rows.between(30..run.rows.len());
        let second = second.map(|row| Row { t_ms: row.t_ms - begin_ms, ..row }).collect();
        [
            Run { name: format!("{}0", run.name), rows: run.rows.between(0..30).collect() },
            Run { name: format!("{}1", run.name), rows: second },
        ]
    });
    assert_eq!(textbook(&Logs { runs: halves.collect(), ..logs.clone() }), causes, "runs cut in two");
}

#[test]
fn a_robot_ten_times_as_large_has_the_same_causes() {
    let logs = late_and_losing();
    let diagnosed = |logs: &Logs| diagnose(kinematic::baseline(logs), logs).expect("poses").effects;
    let of = diagnosed(&logs);
    for scale in [0.1, 10.0] {
        let scaled = diagnosed(&scaled(&logs, scale));
        let ids = |effects: &[NamedEffect]| effects.iter().map(|effect| effect.id).collect::<BTreeSet<_>>();
        assert_eq!(ids(&scaled), ids(&of), "{scale}");
        for (effect, name, factor) in [("latency", "ms", 1.0), ("turn_loss", "cm_per_rad", scale)] {
            let [size, expected] = [&scaled, &of].map(|effects| {
                let found = effects.iter().find(|found| found.id == effect).expect(effect);
                // As people read it.
                three_digits(found.parameters[name].as_f64().expect("a number"))
            });
            assert!((size / (factor * expected) - 1.0).abs() < 0.015, "{scale}: {effect} {size} for {expected}");
        }
    }
}

/// The same logs with all lengths scaled.
fn scaled(logs: &Logs, scale: f64) -> Logs {
    let mut logs = with_rows(logs.clone(), |row| {
        row.pose = row.pose.map(|pose| Pose { position_cm: scale * pose.position_cm, ..pose });
    });
    let robot = &mut logs.robot;
    for length in
        [&mut robot.wheel_diameter_cm, &mut robot.track_cm, &mut robot.body_radius_cm, &mut robot.full_speed_cm_s]
    {
        *length *= scale;
    }
    logs.scene = Scene { arena_cm: logs.scene.arena_cm.map(|cm| scale * cm), ..Scene::default() };
    logs
}
