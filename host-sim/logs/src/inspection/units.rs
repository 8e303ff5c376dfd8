//! Units: commands in -1..1, headings in radians, positions in metres or millimetres, a top speed in other units.

use std::f64::consts::PI;

use super::finding::{Finding, Handling, Part, Place};
use super::frames::{directions, most_share};
use super::ways::{Gains, Way, ways};
use crate::Logs;
use mindgap_foundations::geometry::wrap_rad;

/// A gain is a unit's when it lies within this factor of it. Wheels, tracks and fresh batteries are off by less: whoever
/// measured them had a ruler. The units themselves lie a factor of ten and more apart.
const WITHIN: f64 = 2.0;

/// Degrees in a radian, turned round: what a turn shrinks by when radians are read as degrees.
const RADIANS: f64 = PI / 180.0;

/// Commands in -1..1 are put right where the robot drives a hundred times as far as they ask for.
pub fn commands(logs: &mut Logs) -> Vec<Finding> {
    let most =
        logs.runs.iter().flat_map(|run| &run.rows).flat_map(|row| row.command()).map(f64::abs).fold(0.0, f64::max);
    if most == 0.0 || most > 1.0 {
        return Vec::new();
    }
    let gains = Gains::of(&ways(logs), &logs.robot);
    let (handling, withholds): (_, &[Part]) = match gains.turn.or(gains.length).map(f64::abs) {
        Some(gain) if is_near(gain, 100.0) => (Handling::PutRight, &[]),
        Some(gain) if gain < 100.0 / WITHIN => return Vec::new(),
        _ => (Handling::Told, &[Part::Motion]),
    };
    let found = Finding {
        id: "command_fraction",
        places: Place::all(logs),
        handling,
        withholds,
        sentence: format!("No command exceeds {most}: they seem to be fractions; write -100..100 as left and right."),
    };
    if handling == Handling::PutRight {
        logs.runs.iter_mut().for_each(|run| {
            run.rows.edit_each(|row| (row.left, row.right) = (row.left * 100.0, row.right * 100.0));
        });
    }
    vec![found]
}

/// Headings in radians are put right where turns are as much smaller than asked for as radians than degrees, and the
/// robot then goes where it heads.
pub fn headings(logs: &mut Logs) -> Vec<Finding> {
    let ways = ways(logs);
    let Some(_) = Gains::of(&ways, &logs.robot).turn.filter(|gain| is_near(gain.abs(), RADIANS)) else {
        return Vec::new();
    };
    let mut right = logs.clone();
    for run in &mut right.runs {
        run.rows.edit_poses(|pose| pose.heading_rad = wrap_rad(pose.heading_rad / RADIANS));
    }
    if !goes_somewhere(&super::ways::ways(&right), &right) {
        return Vec::new();
    }
    *logs = right;
    vec![Finding {
        id: "heading_radians",
        places: posed(logs),
        handling: Handling::PutRight,
        withholds: &[],
        sentence: "Headings are in radians: write degrees as heading_deg.".into(),
    }]
}

/// Positions in metres or millimetres are put right; a top speed in other units is told.
pub fn lengths(logs: &mut Logs) -> Vec<Finding> {
    let ways = ways(logs);
    let gains = Gains::of(&ways, &logs.robot);
    let Some(length) = gains.length else { return Vec::new() };
    let turns_as_asked = gains.turn.is_none_or(|turn| is_near(turn.abs(), 1.0));
    let metres = [(0.01, 100.0, "length_metres", "metres"), (10.0, 0.1, "length_millimetres", "millimetres")];
    for (gain, factor, id, unit) in metres {
        if is_near(length, gain) && turns_as_asked && goes_somewhere(&ways, logs) {
            logs.runs.iter_mut().for_each(|run| run.rows.edit_poses(|pose| pose.position_cm *= factor));
            return vec![Finding {
                id,
                places: posed(logs),
                handling: Handling::PutRight,
                withholds: &[],
                sentence: format!("Positions are in {unit}: write centimetres as x_cm and y_cm."),
            }];
        }
    }
    let other_speed = [(100.0, "m/s"), (0.1, "mm/s")]
        .into_iter()
        .find(|(gain, _)| is_near(length, *gain) && gains.turn.is_none_or(|turn| is_near(turn.abs(), *gain)));
    let Some((_, unit)) = other_speed else { return Vec::new() };
    vec![Finding {
        id: "full_speed_unit",
        places: Place::all(logs),
        handling: Handling::Told,
        withholds: &[Part::Motion],
        sentence: format!(
            "The robot drives {length:.3} times as fast as robot.toml says: full_speed_cm_s seems to be in {unit}; write cm/s."
        ),
    }]
}

/// Whether straight ways have one direction against the heading, which noise has not; too few ways do not say otherwise.
fn goes_somewhere(ways: &[Way], logs: &Logs) -> bool {
    directions(ways, &logs.robot).is_none_or(|shares| most_share(&shares).1 >= super::frames::DECISIVE)
}

fn posed(logs: &Logs) -> Vec<Place> {
    let rows = logs.runs.iter().enumerate().flat_map(|(run, r)| {
        r.rows.iter().enumerate().filter(|(_, row)| row.pose.is_some()).map(move |(row, _)| (run, row))
    });
    Place::of(logs, &rows.collect::<Vec<_>>())
}

fn is_near(gain: f64, unit: f64) -> bool {
    (unit / WITHIN..unit * WITHIN).contains(&gain)
}
