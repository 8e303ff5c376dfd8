//! Checks each wall of the map against the readings that face it.

use glam::DVec2;

use super::finding::Finding;
use super::segments::{MIN_SAMPLES, stride};
use crate::Logs;
use mindgap_foundations::geometry::{Wall, cast};
use mindgap_foundations::statistics::summary::median;

/// Readings at larger incidence see other parts of a wall than the one ahead, rad.
const MAX_INCIDENCE_RAD: f64 = 0.4;
/// Minimum displacement of a wall, cm, and as a multiple of the scatter of its readings.
const MIN_MOVED_CM: f64 = 8.0;
const MIN_RATIO: f64 = 3.0;
/// Minimum fraction of readings of other walls that fit: otherwise the sensor or the frame is at fault.
const MIN_OTHERS_FITTING: f64 = 0.7;
/// Distance up to which a reading fits, cm, and as a fraction of itself.
const FITS_CM: f64 = 5.0;
const FITS: f64 = 0.05;

/// A wall must be seen from this number of places, farther apart than this, cm: from one place, an echo may come from elsewhere.
const MIN_PLACES: usize = 10;
const PLACE_CM: f64 = 2.0;

/// A reading that faces a wall: its row and place, and by how much it exceeds the distance.
struct Facing {
    row: (usize, usize),
    at_cm: DVec2,
    excess_cm: f64,
    fits: bool,
}

/// Reports walls that readings place elsewhere, while all others fit.
pub fn check(logs: &Logs) -> Vec<Finding> {
    let sides = logs.scene.sides();
    let facing = facing(logs, &sides);
    let moved: Vec<(usize, f64)> =
        facing.iter().enumerate().filter_map(|(wall, readings)| Some((wall, displacement_cm(readings)?))).collect();
    let is_moved = |wall: usize| moved.iter().any(|(other, _)| *other == wall);
    let others = facing.iter().enumerate().filter(|(wall, _)| !is_moved(*wall)).flat_map(|(_, readings)| readings);
    let (all, fitting) = others.fold((0, 0), |(all, fit), reading| (all + 1, fit + usize::from(reading.fits)));
    if moved.is_empty() || all < MIN_SAMPLES || (fitting as f64) < MIN_OTHERS_FITTING * all as f64 {
        return Vec::new();
    }
    let words = moved.iter().map(|(wall, cm)| {
        let Wall { from_cm, to_cm } = sides[*wall];
        let direction = if *cm > 0.0 { "farther" } else { "nearer" };
        format!(
            "the wall from ({:.0}, {:.0}) to ({:.0}, {:.0}) {:.0} cm {direction}",
            from_cm.x,
            from_cm.y,
            to_cm.x,
            to_cm.y,
            cm.abs()
        )
    });
    let sentence = format!(
        "The map disagrees with the readings, which place {}: measure it again and correct scene.toml.",
        words.collect::<Vec<_>>().join(", ")
    );
    let mut rows: Vec<(usize, usize)> =
        moved.iter().flat_map(|(wall, _)| facing[*wall].iter().map(|reading| reading.row)).collect();
    rows.sort_unstable();
    vec![Finding::of_readings(logs, "wall_moved", &rows, sentence)]
}

/// Returns the readings that face each wall; large logs are subsampled.
fn facing(logs: &Logs, sides: &[Wall]) -> Vec<Vec<Facing>> {
    let mut facing: Vec<Vec<Facing>> = sides.iter().map(|_| Vec::new()).collect();
    let Some(mount) = logs.robot.ultrasonic else { return facing };
    let rows = logs.runs.iter().enumerate().flat_map(|(run, r)| (0..r.rows.len()).map(move |row| (run, row)));
    for (run, row) in rows.step_by(stride(logs.rows())) {
        let logged = logs.runs[run].rows.at(row);
        let Some((pose, echo_cm)) = logged.pose.zip(logged.echo_cm) else { continue };
        let sensor = mount.pose_on(&pose);
        let Some(hit) = cast(sides, sensor.position_cm, sensor.direction()) else { continue };
        if hit.incidence_rad.abs() > MAX_INCIDENCE_RAD || hit.distance_cm > mount.max_cm {
            continue;
        }
        let excess_cm = echo_cm - hit.distance_cm;
        let fits = excess_cm.abs() <= FITS_CM.max(FITS * hit.distance_cm);
        facing[hit.wall].push(Facing { row: (run, row), at_cm: pose.position_cm, excess_cm, fits });
    }
    facing
}

/// Returns by how much readings place a wall farther away; `None` if they fit or scatter too much.
fn displacement_cm(readings: &[Facing]) -> Option<f64> {
    let moves = readings.windows(2).filter(|pair| pair[0].at_cm.distance(pair[1].at_cm) > PLACE_CM).count();
    if readings.len() < MIN_SAMPLES || moves < MIN_PLACES {
        return None;
    }
    let middle_cm = median(readings.iter().map(|reading| reading.excess_cm));
    let scatter_cm = median(readings.iter().map(|reading| (reading.excess_cm - middle_cm).abs()));
    (middle_cm.abs() >= MIN_MOVED_CM.max(MIN_RATIO * scatter_cm)).then_some(middle_cm)
}
