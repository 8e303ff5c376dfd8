//! Poses of a robot that nobody tracked, by what it measures of its own motion.

use std::iter;

use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Motion;
use mindgap_logs::samples::wheels_cm;
use mindgap_logs::{Robot, Run};

/// Returns a pose for every row of a run that begins at the origin. The turn is that of the gyro, or else of the rotation
/// counters; without counters the robot covers what is commanded.
pub fn poses(robot: &Robot, run: &Run) -> Vec<Pose> {
    let mut pose = Pose::new(0.0, 0.0, 0.0);
    let following = (1..run.rows.len()).map(|to| {
        pose = step(robot, run, to - 1).end(&pose);
        pose
    });
    iter::once(Pose::new(0.0, 0.0, 0.0)).chain(following).collect()
}

fn step(robot: &Robot, run: &Run, row: usize) -> Motion<f64> {
    let (begin, end) = (run.rows.at(row), run.rows.at(row + 1));
    let seconds = (end.t_ms - begin.t_ms) / 1000.0;
    let counted_cm = wheels_cm(robot, run, row).map(|cm| cm.map(|cm| cm * 1000.0 * seconds / robot.step_ms));
    let commanded_cm = || begin.command().map(|command| command / 100.0 * robot.full_speed_cm_s * seconds);
    let mut arc = Motion::ZERO.arc().with_wheels(counted_cm.unwrap_or_else(commanded_cm), robot.track_cm);
    if let Some((from, to)) = begin.gyro_deg_s.zip(end.gyro_deg_s) {
        arc.turn_rad = (0.5 * (from + to) * seconds).to_radians();
    }
    arc.motion()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::default_robot;
    use mindgap_logs::Row;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Both wheels turn by half a turn a step; the gyro shows a quarter turn a step.
    #[test]
    fn gyro_turns_and_counters_drive() {
        let robot = Robot { step_ms: 1000.0, wheel_diameter_cm: 2.0, ..default_robot() };
        let rows = |gyro_deg_s: Option<f64>| {
            let row = |at: f64| Row {
                t_ms: 1000.0 * at,
                rot_left_deg: Some(180.0 * at),
                rot_right_deg: Some(180.0 * at),
                gyro_deg_s,
                ..Row::default()
            };
            Run { name: "run-000".into(), rows: [0.0, 1.0, 2.0].map(row).into_iter().collect() }
        };
        let straight = poses(&robot, &rows(None));
        assert!((straight[2].position_cm.x - 2.0 * PI).abs() < 1e-9 && straight[2].heading_rad == 0.0, "{straight:?}");
        let turned = poses(&robot, &rows(Some(90.0)));
        // A quarter circle with an arc of π has a radius of 2 cm, and two of them end opposite.
        assert!((turned[1].heading_rad - FRAC_PI_2).abs() < 1e-9, "{turned:?}");
        assert!(turned[2].position_cm.x.abs() < 1e-9 && (turned[2].position_cm.y - 4.0).abs() < 1e-9, "{turned:?}");
    }
}
