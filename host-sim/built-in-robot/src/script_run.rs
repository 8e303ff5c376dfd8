//! Drives a script of commands on the built-in robot.

use super::controller_run::{Trajectory, TrajectoryPoint};
use super::recording::{free_pose, room_too_small};
use super::{ActiveEffect, BuiltInRobot};
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::{Generator, generator};
use mindgap_logs::{Robot, Run, Scene, Termination};

/// Stream key of the generators.
const SCRIPT: u64 = u64::from_be_bytes(*b"script  ");
/// Number of places that are tried before a script counts as too long for the room.
const PLACES: u64 = 60;

/// Drives the commands of a script, each held for a step, from the pose `start`; without one, from a place where the robot hits
/// nothing, as an attendant would choose it. Where no place has room for the whole script, the run with the most steps counts.
///
/// # Errors
/// When the scene has no room for the robot.
pub fn run_script(
    spec: &Robot,
    scene: &Scene,
    effects: &[ActiveEffect],
    script: &Run,
    start: Option<Pose>,
    seed: u64,
) -> Result<Trajectory> {
    let robot = BuiltInRobot::new(spec, scene, effects);
    let mut longest: Option<Trajectory> = None;
    for place in 0..PLACES {
        let rng = &mut generator(seed, &[SCRIPT, place]);
        let Some(from) = start.or_else(|| free_pose(spec, scene, rng)) else { break };
        let driven = drive(&robot, script, spec.step_ms, from, rng);
        if driven.termination != Termination::Crashed || start.is_some() {
            return Ok(driven);
        }
        if longest.as_ref().is_none_or(|longest| longest.points.len() < driven.points.len()) {
            longest = Some(driven);
        }
    }
    longest.ok_or_else(|| room_too_small(spec))
}

fn drive(robot: &BuiltInRobot, script: &Run, step_ms: f64, start: Pose, rng: &mut Generator) -> Trajectory {
    let mut body = robot.start(start, rng);
    let first_ms = script.rows.first().map_or(0.0, |row| row.t_ms);
    let last_ms = script.rows.last().map_or(0.0, |row| row.t_ms) - first_ms;
    // A script may begin or end a rounding error off its steps.
    let steps = (last_ms / step_ms).round() as usize;
    let command = |step: usize| {
        let t_ms = first_ms + step as f64 * step_ms + 0.5 * step_ms;
        script.rows.get(script.rows.first_later_than(t_ms).saturating_sub(1)).map_or([0.0; 2], |row| row.command())
    };
    let mut points = Vec::with_capacity(steps + 1);
    for step in 0..steps {
        if body.crashed() {
            break;
        }
        let echo_cm = body.read_sonar(rng);
        let row = body.row(command(step), echo_cm, rng);
        points.push(TrajectoryPoint { true_pose: body.true_pose(), row });
        body.drive(command(step), robot.step_length_ms(step_ms, rng), rng);
    }
    let echo_cm = body.read_sonar(rng);
    points.push(TrajectoryPoint { true_pose: body.true_pose(), row: body.row([0.0, 0.0], echo_cm, rng) });
    let termination = if body.crashed() { Termination::Crashed } else { Termination::Finished };
    Trajectory { points, termination }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{default_robot, training_room};
    use mindgap_logs::Row;

    fn script(commands: &[[f64; 2]]) -> Run {
        let row = |(k, [left, right]): (usize, &[f64; 2])| Row {
            t_ms: 400.0 * k as f64,
            left: *left,
            right: *right,
            ..Row::default()
        };
        Run { name: "script-000".into(), rows: commands.iter().enumerate().map(row).collect() }
    }

    #[test]
    fn the_commands_of_a_script_are_driven_in_their_steps() {
        let commands = [[40.0, -40.0], [40.0, -40.0], [-25.0, -25.0], [0.0, 0.0]];
        let run = |seed| run_script(&default_robot(), &training_room(), &[], &script(&commands), None, seed);
        let driven = run(3).expect("room");
        let logged: Vec<[f64; 2]> = driven.points.iter().map(|point| point.row.command()).collect();
        assert_eq!((logged.as_slice(), driven.termination), (commands.as_slice(), Termination::Finished));
        let turned = driven.points[0].true_pose.relative(&driven.points[2].true_pose);
        assert!(turned.heading_rad < -0.5, "{turned:?}");
        assert_eq!(run(3).expect("room"), driven);
        assert_ne!(run(4).expect("room"), driven);
    }

    #[test]
    fn a_script_too_long_for_the_room_ends_at_a_wall() {
        let script = script(&[[90.0, 90.0]; 90]);
        let driven = run_script(&default_robot(), &training_room(), &[], &script, None, 1).expect("room");
        assert!(driven.termination == Termination::Crashed && driven.points.len() < 60, "{}", driven.points.len());
        assert_eq!(driven.points.last().map(|point| point.row.command()), Some([0.0, 0.0]));
    }
}
