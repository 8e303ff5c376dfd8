//! Faults that occur in real logs, to be put into good logs.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_logs::inspection::{Finding, Handling, Inspection};
use mindgap_logs::{Logs, Row, Rows};

/// A fault and the finding that the inspection has to make.
pub struct Fault {
    /// Description.
    pub what: &'static str,
    /// Name of the finding.
    pub id: &'static str,
    /// How the inspection handles it.
    pub handling: Handling,
    /// Puts the fault into logs.
    pub put: fn(&mut Logs),
}

const fn fault(what: &'static str, id: &'static str, handling: Handling, put: fn(&mut Logs)) -> Fault {
    Fault { what, id, handling, put }
}

/// Run into which faults of single rows are put.
pub const RUN: usize = 4;

/// Faults of motion: in commands, poses and clocks.
pub const MOTION: [Fault; 22] = [
    fault("commands in -1..1", "command_fraction", Handling::Corrected, |logs| {
        each(logs, |row| (row.left, row.right) = (row.left / 100.0, row.right / 100.0));
    }),
    fault("radians", "heading_radians", Handling::Corrected, |logs| poses(logs, |p| p.heading_rad *= PI / 180.0)),
    fault("metres", "length_metres", Handling::Corrected, |logs| poses(logs, |p| p.position_cm *= 0.01)),
    fault("millimetres", "length_millimetres", Handling::Corrected, |logs| poses(logs, |p| p.position_cm *= 10.0)),
    fault("y counted downwards", "y_downwards", Handling::Reported, |logs| {
        let high_cm = room(logs).y;
        poses(logs, |p| p.position_cm.y = high_cm - p.position_cm.y);
    }),
    fault("left and right exchanged", "left_right_exchanged", Handling::Reported, |logs| {
        each(logs, |row| (row.left, row.right) = (row.right, row.left));
    }),
    fault("x and y exchanged", "xy_exchanged", Handling::Reported, |logs| {
        poses(logs, |p| p.position_cm = DVec2::new(p.position_cm.y, p.position_cm.x));
    }),
    fault("headings clockwise", "heading_clockwise", Handling::Reported, |logs| {
        poses(logs, |p| p.heading_rad = wrap_rad(-p.heading_rad));
    }),
    fault("headings of a compass", "heading_clockwise", Handling::Reported, |logs| {
        poses(logs, |p| p.heading_rad = wrap_rad(FRAC_PI_2 - p.heading_rad));
    }),
    fault("headings a quarter of a turn on", "frame_turned", Handling::Reported, |logs| {
        poses(logs, |p| p.heading_rad = wrap_rad(p.heading_rad + FRAC_PI_2));
    }),
    fault("front taken for back", "frame_turned", Handling::Reported, |logs| {
        poses(logs, |p| p.heading_rad = wrap_rad(p.heading_rad + PI));
    }),
    fault("both motors reversed", "commands_reversed", Handling::Reported, |logs| {
        each(logs, |row| (row.left, row.right) = (-row.left, -row.right));
    }),
    fault("every tenth heading flipped", "heading_flipped", Handling::Corrected, |logs| {
        let mut count = 0..;
        each(logs, |row| {
            if count.next().is_some_and(|k| k % 10 == 5) {
                row.pose.iter_mut().for_each(flip);
            }
        });
    }),
    fault("a stretch of headings flipped", "heading_flipped", Handling::Corrected, |logs| {
        (12..26).for_each(|k| logs.runs[RUN].rows.edit_pose(k, flip));
    }),
    fault("five headings off by 88°", "heading_jump", Handling::Excluded, |logs| {
        let turn = |p: &mut Pose| p.heading_rad = wrap_rad(p.heading_rad + 88f64.to_radians());
        (6..).step_by(9).take(5).for_each(|k| logs.runs[RUN].rows.edit_pose(k, turn));
    }),
    fault("five positions off by 31 cm", "tracker_jump", Handling::Excluded, |logs| {
        let jump = |p: &mut Pose| p.position_cm += DVec2::new(18.6, -24.8);
        (6..).step_by(9).take(5).for_each(|k| logs.runs[RUN].rows.edit_pose(k, jump));
    }),
    fault("a frozen tracker", "tracker_frozen", Handling::Excluded, |logs| {
        let rows = &mut logs.runs[RUN].rows;
        let stands = rows.at(20).pose;
        (21..25).for_each(|k| rows.edit(k, |row| row.pose = stands));
    }),
    fault("a run in seconds", "clock_seconds", Handling::Corrected, |logs| {
        logs.runs[RUN].rows.edit_each(|row| row.t_ms /= 1000.0);
    }),
    fault("a run's commands 1.6 s late", "clock_shifted", Handling::Excluded, |logs| {
        shift(&mut logs.runs[RUN].rows, 4)
    }),
    fault("a run copied", "run_copied", Handling::Excluded, |logs| {
        let mut copy = logs.runs[RUN].clone();
        copy.name = "run-999".into();
        logs.runs.push(copy);
    }),
    fault("commands negated in some runs", "commands_reversed", Handling::Excluded, |logs| {
        some_runs(logs, |row| (row.left, row.right) = (-row.left, -row.right));
    }),
    fault("left and right exchanged in some runs", "left_right_exchanged", Handling::Excluded, |logs| {
        some_runs(logs, |row| (row.left, row.right) = (row.right, row.left));
    }),
];

/// Faults that only readings of walls show.
pub const SONAR: [Fault; 15] = [
    fault("readings in millimetres", "echo_unit", Handling::Corrected, |logs| readings(logs, |cm| cm * 10.0)),
    fault("readings in metres", "echo_unit", Handling::Corrected, |logs| readings(logs, |cm| cm / 100.0)),
    fault("readings in inches", "echo_unit", Handling::Corrected, |logs| readings(logs, |cm| cm / 2.54)),
    fault("readings in microseconds", "echo_unit", Handling::Corrected, |logs| readings(logs, |cm| cm * 58.3)),
    fault("the largest reading for none", "echo_none_number", Handling::Corrected, |logs| {
        let max_cm = logs.robot.ultrasonic.map_or(0.0, |sensor| sensor.max_cm);
        none(logs, max_cm);
    }),
    fault("one reading in every row", "echo_stuck", Handling::Reported, |logs| {
        each(logs, |row| row.echo_cm = Some(100.0))
    }),
    fault("readings frozen in the second half of runs", "echo_stuck", Handling::Reported, |logs| {
        for run in &mut logs.runs {
            let half = run.rows.len() / 2;
            let last = (0..half).rev().find_map(|k| run.rows.at(k).echo_cm).or(Some(80.0));
            (half..run.rows.len()).for_each(|k| run.rows.edit(k, |row| row.echo_cm = last));
        }
    }),
    fault("readings that end at 100", "echo_saturated", Handling::Reported, |logs| readings(logs, |cm| cm.min(100.0))),
    fault("arena of half the width", "path_outside_arena", Handling::Reported, |logs| {
        logs.scene.arena_cm.iter_mut().for_each(|size_cm| size_cm.x /= 2.0);
    }),
    fault("a wall 20 cm nearer than on the map", "wall_moved", Handling::Reported, |logs| {
        logs.scene.arena_cm.iter_mut().for_each(|size_cm| size_cm.x += 20.0);
    }),
    fault("255 for none", "echo_none_number", Handling::Corrected, |logs| none(logs, 255.0)),
    fault("0 for none", "echo_none_number", Handling::Corrected, |logs| none(logs, 0.0)),
    fault("inf for none", "echo_none_number", Handling::Corrected, |logs| none(logs, 1e7)),
    fault("poses turned in the room", "frame_turned", Handling::Reported, |logs| {
        let size_cm = room(logs);
        poses(logs, |p| *p = Pose::new(size_cm.x - p.position_cm.x, size_cm.y - p.position_cm.y, p.heading_rad + PI));
    }),
    fault("poses mirrored in the room", "frame_mirrored", Handling::Reported, |logs| {
        let size_cm = room(logs);
        poses(logs, |p| *p = Pose::new(p.position_cm.x, size_cm.y - p.position_cm.y, -p.heading_rad));
    }),
];

/// Puts a fault into good logs and expects the inspection to find that fault and no other, in the right rows, and to restore
/// or leave out the faulty values.
///
/// # Panics
/// If the inspection does otherwise.
pub fn assert_found(good: &Logs, fault: &Fault) {
    let what = fault.what;
    let mut faulty = good.clone();
    (fault.put)(&mut faulty);
    let (before, after) = (Inspection::new(good.clone()), Inspection::new(faulty.clone()));
    let is_new = |found: &&Finding| !before.findings.iter().any(|known| known.id == found.id);
    let new: Vec<&Finding> = after.findings.iter().filter(is_new).collect();
    let [found] = new.as_slice() else { panic!("{what}: {new:?}") };
    assert_eq!((found.id, found.handling), (fault.id, fault.handling), "{what}");
    // What is only reported must not be compared.
    assert_eq!(found.handling == Handling::Reported, !found.withholds.is_empty(), "{what}");
    if !found.withholds.is_empty() || fault.id == "run_copied" {
        return;
    }
    let put_in = good.runs.iter().zip(&faulty.runs).flat_map(|(a, b)| {
        let rows = a.rows.iter().zip(&b.rows).enumerate().filter(|(_, (a, b))| a != b);
        rows.map(|(row, _)| (a.name.clone(), row)).collect::<Vec<_>>()
    });
    let put_in: Vec<(String, usize)> = put_in.collect();
    let places = found.rows_by_run.iter().flat_map(|place| place.rows.iter().map(|row| (place.run.clone(), *row)));
    let found_rows: Vec<(String, usize)> = places.collect();
    let missed: Vec<_> = put_in.iter().filter(|row| !found_rows.contains(row)).collect();
    assert!(missed.is_empty(), "{what}: {missed:?} not found");
    // A zero is the same in all units.
    let is_whole = ["command", "clock", "left_right"].iter().any(|kind| fault.id.starts_with(kind));
    assert!(is_whole || found_rows.len() == put_in.len(), "{what}: {put_in:?} but {found_rows:?}");
    for run in &after.logs.runs {
        let as_it_was = before.logs.runs.iter().find(|other| other.name == run.name).expect("a run of the good logs");
        for (k, (row, was)) in run.rows.iter().zip(&as_it_was.rows).enumerate() {
            let is_left_out = fault.handling == Handling::Excluded && found_rows.contains(&(run.name.clone(), k));
            assert!(is_left_out && row.pose.is_none() || are_equal(&row, &was), "{what}: {row:?} was {was:?}");
        }
    }
}

/// Returns whether two rows are equal within rounding.
fn are_equal(a: &Row, b: &Row) -> bool {
    const ROUNDING: f64 = 1e-9;
    let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING;
    let poses = match (a.pose, b.pose) {
        (Some(a), Some(b)) => {
            a.position_cm.distance(b.position_cm) <= ROUNDING && near(wrap_rad(a.heading_rad - b.heading_rad), 0.0)
        }
        (a, b) => a.is_none() && b.is_none(),
    };
    let echoes = match (a.echo_cm, b.echo_cm) {
        (Some(a), Some(b)) => near(a, b),
        (a, b) => a.is_none() && b.is_none(),
    };
    poses && echoes && near(a.t_ms, b.t_ms) && near(a.left, b.left) && near(a.right, b.right)
}

fn each(logs: &mut Logs, mut change: impl FnMut(&mut Row)) {
    logs.runs.iter_mut().for_each(|run| run.rows.edit_each(&mut change));
}

/// Changes every row of every fifth run.
fn some_runs(logs: &mut Logs, mut change: impl FnMut(&mut Row)) {
    logs.runs.iter_mut().step_by(5).for_each(|run| run.rows.edit_each(&mut change));
}

fn poses(logs: &mut Logs, change: impl Fn(&mut Pose)) {
    logs.runs.iter_mut().for_each(|run| run.rows.edit_poses(&change));
}

fn readings(logs: &mut Logs, change: impl Fn(f64) -> f64) {
    each(logs, |row| row.echo_cm = row.echo_cm.map(&change));
}

fn none(logs: &mut Logs, number: f64) {
    each(logs, |row| row.echo_cm = row.echo_cm.or(Some(number)));
}

fn flip(pose: &mut Pose) {
    pose.heading_rad = wrap_rad(pose.heading_rad + PI);
}

/// Shifts the commands as if they were logged `late` rows too late.
fn shift(rows: &mut Rows, late: usize) {
    let commands: Vec<[f64; 2]> = rows.iter().map(|row| row.command()).collect();
    for k in 0..rows.len() {
        let command = if k < late { [0.0; 2] } else { commands[k - late] };
        rows.edit(k, |row| [row.left, row.right] = command);
    }
}

fn room(logs: &Logs) -> DVec2 {
    logs.scene.bounding_box().expect("a room").high_cm
}
