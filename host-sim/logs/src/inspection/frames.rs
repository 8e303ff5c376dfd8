//! Checks the frame of poses: the directions of x, y and headings against the commanded motion and the walls.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec2;

use super::finding::{Finding, Handling, Part, RunRows};
use super::map::{MIN_READINGS, fitting_fraction, ranges_along_axis};
use super::segments::{MIN_SAMPLES, Segment, segments, straight, turning};
use crate::{Logs, Robot};
use mindgap_foundations::geometry::{Pose, Rectangle, wrap_rad};

/// Minimum fraction of segments that must agree with a frame: one row in ten may be wrong, and each spoils two segments.
pub const MIN_AGREEMENT: f64 = 0.8;
/// Maximum fraction that agrees with the given frame if another one is right. A compass off by 20° and a camera turned by as
/// much leave all segments within the 45° that count as agreement.
const MAX_AGREEMENT_OF_WRONG_FRAME: f64 = 0.5;
/// Minimum gain, in the right frame, of the fraction of readings that fit the walls. A turned rectangular room looks half the
/// same, and whatever the robot's faults, the given frame fits best if it is right, if only by a few hundredths.
const MIN_FITTING_GAIN: f64 = 0.2;

/// Sine of the largest difference between headings that count as one.
const SAME_HEADING: f64 = 0.01;
/// Minimum commanded rotation that must be seen in headings, rad: one turn.
const MIN_ASKED_RAD: f64 = 2.0 * PI;
/// Minimum path of a robot that moves, cm.
const MIN_MOVED_CM: f64 = 50.0;

/// Returns the fractions of straight segments that run along the heading turned by 0 to 3 quarter turns, then the same with
/// clockwise headings; `None` with too few segments.
pub fn directions(segments: &[Segment], robot: &Robot) -> Option<[f64; 8]> {
    mean_by_frame(segments, robot, |off_rad| f64::from(u8::from(off_rad < FRAC_PI_4)))
}

/// Returns the mean angle between the course of straight segments and their heading, rad, in the frame of [`directions`] that
/// fits best; `None` with too few segments.
pub fn off_course_rad(segments: &[Segment], robot: &Robot) -> Option<f64> {
    let means_rad = mean_by_frame(segments, robot, |off_rad| off_rad)?;
    Some(means_rad.into_iter().fold(f64::INFINITY, f64::min))
}

/// Returns the mean over straight segments of a function of the angle between course and heading, for each frame of
/// [`directions`].
fn mean_by_frame(segments: &[Segment], robot: &Robot, of: impl Fn(f64) -> f64) -> Option<[f64; 8]> {
    let straight: Vec<&Segment> =
        straight(segments, robot).into_iter().filter(|segment| segment.chord_cm.length() > 0.0).collect();
    if straight.len() < MIN_SAMPLES {
        return None;
    }
    let mut means = [0.0; 8];
    for segment in &straight {
        let backwards = if segment.commanded.forward_cm < 0.0 { PI } else { 0.0 };
        let course_rad = libm::atan2(segment.chord_cm.y, segment.chord_cm.x) + backwards;
        for (i, mean) in means.iter_mut().enumerate() {
            let heading_rad = if i < 4 { segment.heading_rad } else { -segment.heading_rad };
            let off_rad = wrap_rad(course_rad - heading_rad - (i % 4) as f64 * FRAC_PI_2);
            *mean += of(off_rad.abs()) / straight.len() as f64;
        }
    }
    Some(means)
}

/// Returns the index of the largest share, and the share.
pub fn largest_share(shares: &[f64; 8]) -> (usize, f64) {
    let mut largest = (0, shares[0]);
    shares.iter().enumerate().for_each(|(i, share)| largest = if *share > largest.1 { (i, *share) } else { largest });
    largest
}

/// Orientation of a track's frame relative to the robot's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Index into `directions`: 0 if the robot moves along its heading, or if that cannot be determined.
    pub direction: usize,
    /// Whether the robot turns against the commands.
    pub is_reversed: bool,
}

impl Orientation {
    /// Determines the orientation of logs.
    pub fn of(logs: &Logs) -> Self {
        let segments = segments(logs);
        let direction = directions(&segments, &logs.robot).map_or(0, |shares| match largest_share(&shares) {
            (best, share) if share >= MIN_AGREEMENT && shares[0] <= MAX_AGREEMENT_OF_WRONG_FRAME => best,
            _ => 0,
        });
        Orientation { direction, is_reversed: turns_are_reversed(&segments) }
    }
}

/// Reports a frame that does not fit the motion or the walls. If that of all runs fits, excludes the runs of a minority whose
/// commands do not, which can hide what all the others have.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let of_all_runs = check_whole(logs);
    if !of_all_runs.is_empty() {
        return of_all_runs;
    }
    let mut found = exclude_runs(logs);
    if !found.is_empty() {
        found.extend(check_whole(logs));
    }
    found
}

fn check_whole(logs: &Logs) -> Vec<Finding> {
    if let Some(found) = without_rotation(logs) {
        return vec![found];
    }
    let Orientation { direction, is_reversed } = Orientation::of(logs);
    let (id, sentence): (_, &str) = match (direction, is_reversed) {
        (0, false) => return compare_with_walls(logs, &ROTATIONS, "frame_turned").into_iter().collect(),
        (0, true) => {
            let mirrored = compare_with_walls(logs, &REFLECTIONS, "frame_mirrored");
            return vec![
                mirrored.unwrap_or_else(|| reported(logs, "left_right_exchanged", EXCHANGED, &[Part::Motion])),
            ];
        }
        (1..4, false) => (
            "frame_turned",
            "The robot moves at a quarter or half turn to its heading: measure heading_deg from the +x axis of x_cm and y_cm.",
        ),
        (2, true) => (
            "commands_reversed",
            "The robot drives backwards and turns the opposite way: both motors seem reversed; positive commands must drive forwards.",
        ),
        (1..4, true) => (
            "frame_turned",
            "The robot moves at a quarter turn to its heading and turns the opposite way: measure heading_deg counter-clockwise from +x, and check left and right.",
        ),
        (4, false) => (
            "y_downwards",
            "Positions are mirrored against headings: y_cm seems to point downwards; it must point upwards.",
        ),
        (6, false) => (
            "frame_mirrored",
            "Positions are mirrored against headings: x_cm seems to point left; it must point right.",
        ),
        (_, false) => {
            ("xy_exchanged", "Positions are mirrored against headings along a diagonal: x_cm and y_cm seem exchanged.")
        }
        (_, true) => (
            "heading_clockwise",
            "Headings increase clockwise, like a compass: measure heading_deg counter-clockwise from +x.",
        ),
    };
    vec![reported(logs, id, sentence, &[Part::Motion, Part::Sonar])]
}

/// Excludes the runs of a minority whose commands are reversed or exchanged.
fn exclude_runs(logs: &mut Logs) -> Vec<Finding> {
    let faults: Vec<Option<(&'static str, &'static str)>> = logs.runs.iter().map(|run| fault(logs, run)).collect();
    if 2 * faults.iter().flatten().count() >= faults.len() {
        return Vec::new();
    }
    let kinds = [REVERSED_RUNS, EXCHANGED_RUNS];
    let found = kinds.iter().filter_map(|kind| {
        let is_affected = |(_, fault): &(RunRows, &Option<(&'static str, &'static str)>)| **fault == Some(*kind);
        let rows_by_run = RunRows::all(logs).into_iter().zip(&faults).filter(is_affected).map(|(rows, _)| rows);
        let rows_by_run: Vec<RunRows> = rows_by_run.collect();
        let names: Vec<&str> = rows_by_run.iter().map(|rows| rows.run.as_str()).collect();
        let sentence = format!("In {}, {}", names.join(", "), kind.1);
        let (handling, withholds): (_, &[Part]) = (Handling::Excluded, &[]);
        (!rows_by_run.is_empty()).then_some(Finding { id: kind.0, rows_by_run, handling, withholds, sentence })
    });
    let found = found.collect();
    let mut faults = faults.iter();
    logs.runs.retain(|_| faults.next().is_some_and(Option::is_none));
    found
}

const REVERSED_RUNS: (&str, &str) = (
    "commands_reversed",
    "the robot drives backwards and turns the opposite way, unlike in the other runs: the commands are negated there.",
);
const EXCHANGED_RUNS: (&str, &str) = (
    "left_right_exchanged",
    "the robot turns the opposite way, unlike in the other runs: left and right are exchanged there.",
);

/// Returns the fault of a single run's commands.
fn fault(logs: &Logs, run: &crate::Run) -> Option<(&'static str, &'static str)> {
    let alone = Logs { robot: logs.robot, scene: crate::Scene::default(), runs: vec![run.clone()] };
    match Orientation::of(&alone) {
        Orientation { direction: 2, is_reversed: true } => Some(REVERSED_RUNS),
        Orientation { direction: 0, is_reversed: true } => Some(EXCHANGED_RUNS),
        _ => None,
    }
}

/// Reports headings that never change although the robot moves and the commands turn it.
fn without_rotation(logs: &Logs) -> Option<Finding> {
    let segments = segments(logs);
    let asked_rad: f64 = segments.iter().map(|segment| segment.commanded.turn_rad.abs()).sum();
    let moved_cm: f64 = segments.iter().map(|segment| segment.chord_cm.length()).sum();
    let headings = || logs.runs.iter().flat_map(|run| &run.rows).filter_map(|row| Some(row.pose?.heading_rad));
    let first_rad = headings().next()?;
    // A rotation about another axis may look like half a turn.
    let is_constant = headings().all(|rad| libm::sin(rad - first_rad).abs() < SAME_HEADING);
    (is_constant && asked_rad > MIN_ASKED_RAD && moved_cm > MIN_MOVED_CM).then(|| {
        let sentence = format!(
            "The heading never changes, although the commands turn the robot by {:.0} degrees: the track has no rotation, or \
             another axis than z points upwards. Write heading_deg, or set the tracker's up axis to Z.",
            asked_rad.to_degrees()
        );
        reported(logs, "heading_constant", &sentence, &[Part::Motion, Part::Sonar])
    })
}

const EXCHANGED: &str = "The robot turns right when commanded to turn left: left and right seem exchanged (or, if not, the whole \
                         frame is mirrored: y_cm and heading_deg together).";

fn reported(logs: &Logs, id: &'static str, sentence: &str, withholds: &'static [Part]) -> Finding {
    Finding { id, rows_by_run: RunRows::all(logs), handling: Handling::Reported, withholds, sentence: sentence.into() }
}

/// Whether the robot turns against the commands. Observed turns count by their size, since small ones are mostly noise; one that
/// is larger than any commanded turn is a jump of the heading, and counts as that commanded turn.
fn turns_are_reversed(segments: &[Segment]) -> bool {
    let turning = turning(segments);
    let largest_rad = turning.iter().map(|segment| segment.commanded.turn_rad.abs()).fold(0.0, f64::max);
    let (mut against_rad, mut all_rad) = (0.0, 0.0);
    for segment in &turning {
        let size_rad = segment.turn_rad.abs().min(largest_rad);
        all_rad += size_rad;
        against_rad += if segment.turn_rad * segment.commanded.turn_rad < 0.0 { size_rad } else { 0.0 };
    }
    turning.len() >= MIN_SAMPLES && all_rad > 0.0 && against_rad >= MIN_AGREEMENT * all_rad
}

/// A symmetry of a rectangle: whether x and y are exchanged, then whether x and whether y are flipped.
type Symmetry = [bool; 3];
/// The rotations.
const ROTATIONS: [Symmetry; 3] = [[false, true, true], [true, true, false], [true, false, true]];
/// The reflections.
const REFLECTIONS: [Symmetry; 4] =
    [[false, false, true], [false, true, false], [true, false, false], [true, true, true]];

/// Reports poses that fit the walls only after being turned or mirrored.
fn compare_with_walls(logs: &Logs, symmetries: &[Symmetry], id: &'static str) -> Option<Finding> {
    let room = logs.scene.bounding_box()?;
    let unchanged = ranges_along_axis(logs, |pose| *pose);
    if unchanged.len() < MIN_READINGS {
        return None;
    }
    let best = symmetries.iter().map(|symmetry| {
        let pairs = ranges_along_axis(logs, |pose| transformed(pose, &room, *symmetry));
        // Readings that then face no wall do not fit.
        fitting_fraction(&pairs, 1.0) * pairs.len() as f64 / unchanged.len().max(pairs.len()) as f64
    });
    let best = best.fold(0.0, f64::max);
    let sentence = "Readings fit the walls only after turning or mirroring all poses in the room: write x_cm, y_cm and \
                    heading_deg in the frame of scene.toml, x to the right, y up, headings counter-clockwise from +x.";
    let withholds: &[Part] = if id == "frame_mirrored" { &[Part::Motion, Part::Sonar] } else { &[Part::Sonar] };
    (best >= fitting_fraction(&unchanged, 1.0) + MIN_FITTING_GAIN).then(|| reported(logs, id, sentence, withholds))
}

fn transformed(pose: &Pose, room: &Rectangle, [exchange, flip_x, flip_y]: Symmetry) -> Pose {
    let mut at = pose.position_cm - room.low_cm;
    let mut size = room.high_cm - room.low_cm;
    let mut heading_rad = pose.heading_rad;
    if exchange {
        let exchanged = |v: DVec2| DVec2::new(v.y, v.x);
        (at, size, heading_rad) = (exchanged(at), exchanged(size), FRAC_PI_2 - heading_rad);
    }
    if flip_x {
        (at.x, heading_rad) = (size.x - at.x, PI - heading_rad);
    }
    if flip_y {
        (at.y, heading_rad) = (size.y - at.y, -heading_rad);
    }
    let at = at + room.low_cm;
    Pose::new(at.x, at.y, heading_rad)
}
