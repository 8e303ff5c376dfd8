//! Checks units: commands in -1..1, headings in radians, positions in metres or millimetres, full speed in other units.

use std::f64::consts::PI;

use super::finding::{Finding, Handling, Part, RunRows};
use super::frames::{directions, largest_share, off_course_rad};
use super::segments::{Gains, Segment, segments};
use crate::Logs;
use mindgap_foundations::geometry::wrap_rad;

/// A gain indicates a unit if it is within this factor of it. Errors in wheel size, track width or battery are smaller, since
/// they were measured; the units themselves are at least a factor of ten apart.
const WITHIN: f64 = 2.0;

/// Gains of length and turn that differ by at most this fraction have one cause,
const SAME_SCALE: f64 = 0.1;
/// which is not a fault of the robot from this factor on.
const UNUSUAL_SCALE: f64 = 1.8;
/// Factor by which turns shrink if radians are read as degrees.
const RADIANS: f64 = PI / 180.0;

/// Scales commands in -1..1 if the robot drives a hundred times as far as commanded.
pub fn commands(logs: &mut Logs) -> Vec<Finding> {
    let largest =
        logs.runs.iter().flat_map(|run| &run.rows).flat_map(|row| row.command()).map(f64::abs).fold(0.0, f64::max);
    if largest == 0.0 || largest > 1.0 {
        return Vec::new();
    }
    let gains = Gains::of(&segments(logs), &logs.robot);
    let (handling, withholds): (_, &[Part]) = match gains.turn.or(gains.length).map(f64::abs) {
        Some(gain) if is_near(gain, 100.0) => (Handling::Corrected, &[]),
        Some(gain) if gain < 100.0 / WITHIN => return Vec::new(),
        _ => (Handling::Reported, &[Part::Motion]),
    };
    let found = Finding {
        id: "command_fraction",
        rows_by_run: RunRows::all(logs),
        handling,
        withholds,
        sentence: format!(
            "No command exceeds {largest}: they seem to be fractions; write left and right as -100..100."
        ),
    };
    if handling == Handling::Corrected {
        logs.runs.iter_mut().for_each(|run| run.rows.scale_commands(100.0));
    }
    vec![found]
}

/// Converts headings from radians if turns are smaller than commanded by the factor between radians and degrees, and the
/// robot then moves in a consistent direction to its heading, and closer to it than before: a controller that makes up for a
/// weak motor commands turns, and the robot hardly turns.
pub fn headings(logs: &mut Logs) -> Vec<Finding> {
    let segments = segments(logs);
    let Some(_) = Gains::of(&segments, &logs.robot).turn.filter(|gain| is_near(gain.abs(), RADIANS)) else {
        return Vec::new();
    };
    let mut converted = logs.clone();
    for run in &mut converted.runs {
        run.rows.edit_poses(|pose| pose.heading_rad = wrap_rad(pose.heading_rad / RADIANS));
    }
    let converted_segments = super::segments::segments(&converted);
    let [before, after] = [&segments, &converted_segments].map(|segments| off_course_rad(segments, &logs.robot));
    let is_closer = before.zip(after).is_none_or(|(before_rad, after_rad)| after_rad < before_rad);
    if !is_closer || !has_consistent_direction(&converted_segments, &converted) {
        return Vec::new();
    }
    *logs = converted;
    vec![Finding {
        id: "heading_radians",
        rows_by_run: rows_with_pose(logs),
        handling: Handling::Corrected,
        withholds: &[],
        sentence: "Headings are in radians: write heading_deg in degrees.".into(),
    }]
}

/// Converts positions from metres or millimetres; reports a full speed in other units.
pub fn lengths(logs: &mut Logs) -> Vec<Finding> {
    let segments = segments(logs);
    let gains = Gains::of(&segments, &logs.robot);
    let Some(length) = gains.length else { return Vec::new() };
    let turns_as_commanded = gains.turn.is_none_or(|turn| is_near(turn.abs(), 1.0));
    let units = [(0.01, 100.0, "length_metres", "metres"), (10.0, 0.1, "length_millimetres", "millimetres")];
    for (gain, factor, id, unit) in units {
        if is_near(length, gain) && turns_as_commanded && has_consistent_direction(&segments, logs) {
            logs.runs.iter_mut().for_each(|run| run.rows.edit_poses(|pose| pose.position_cm *= factor));
            return vec![Finding {
                id,
                rows_by_run: rows_with_pose(logs),
                handling: Handling::Corrected,
                withholds: &[],
                sentence: format!("Positions are in {unit}: write x_cm and y_cm in centimetres."),
            }];
        }
    }
    let other_speed = [(100.0, "m/s"), (0.1, "mm/s")]
        .into_iter()
        .find(|(gain, _)| is_near(length, *gain) && gains.turn.is_none_or(|turn| is_near(turn.abs(), *gain)));
    let Some((_, unit)) = other_speed else { return Vec::new() };
    vec![Finding {
        id: "full_speed_unit",
        rows_by_run: RunRows::all(logs),
        handling: Handling::Reported,
        withholds: &[Part::Motion],
        sentence: format!(
            "The robot drives {length:.3} times as fast as robot.toml states: full_speed_cm_s seems to be in {unit}; write cm/s."
        ),
    }]
}

/// Reports a robot that moves and turns by one factor of what is commanded, far from one.
pub fn scale(logs: &Logs) -> Option<Finding> {
    let gains = Gains::of(&segments(logs), &logs.robot);
    let (length, turn) = gains.length.zip(gains.turn.map(f64::abs))?;
    let is_one_factor = (length / turn - 1.0).abs() <= SAME_SCALE;
    let is_usual = (1.0 / UNUSUAL_SCALE..UNUSUAL_SCALE).contains(&length);
    (is_one_factor && !is_usual).then(|| Finding {
        id: "motion_scale",
        rows_by_run: RunRows::all(logs),
        handling: Handling::Reported,
        withholds: &[],
        sentence: format!(
            "The robot moves and turns {length:.2} times as far as commanded: correct full_speed_cm_s in robot.toml, or the clock, which \
             runs at another rate, as in a simulation that is not in real time (use its /clock)."
        ),
    })
}

/// Returns whether straight segments have a consistent direction to the heading, unlike noise; true with too few segments.
fn has_consistent_direction(segments: &[Segment], logs: &Logs) -> bool {
    directions(segments, &logs.robot).is_none_or(|shares| largest_share(&shares).1 >= super::frames::MIN_AGREEMENT)
}

fn rows_with_pose(logs: &Logs) -> Vec<RunRows> {
    let rows = logs.runs.iter().enumerate().flat_map(|(run, r)| {
        r.rows.iter().enumerate().filter(|(_, row)| row.pose.is_some()).map(move |(row, _)| (run, row))
    });
    RunRows::group(logs, &rows.collect::<Vec<_>>())
}

fn is_near(gain: f64, unit: f64) -> bool {
    (unit / WITHIN..unit * WITHIN).contains(&gain)
}
