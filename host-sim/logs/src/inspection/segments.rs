//! Segments of runs long enough that motion outweighs the tracker's noise, with their commanded motion.

use glam::DVec2;

use crate::{Logs, Robot};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::robust_slope;

/// Minimum duration of a segment, ms: even a slow robot then covers more than the centimetre of a camera's noise. Rows farther
/// apart make a segment each.
const SEGMENT_MS: f64 = 300.0;
/// A step longer than this multiple of `step_ms` spans missing rows and belongs to no segment.
const LONGEST_STEP: f64 = 1.5;
/// Segments with less than this fraction of the largest commanded motion are mostly noise.
pub const LARGE: f64 = 0.25;
/// Minimum number of samples for a decision: of twenty coin tosses, sixteen fall on one side once in a hundred times.
pub const MIN_SAMPLES: usize = 20;

/// Number of steps beyond which further ones add little.
const MAX_SAMPLES: usize = 300_000;

/// Returns the subsampling stride for a number of rows. It is odd, so that periodically changing commands are seen at all
/// their ages.
pub fn stride(rows: usize) -> usize {
    rows.div_ceil(MAX_SAMPLES).max(1) | 1
}

/// Displacement of a differential drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    /// Forward, cm.
    pub forward_cm: f64,
    /// Turn to the left, rad.
    pub turn_rad: f64,
}

impl Displacement {
    /// Returns this displacement followed by another.
    pub fn and(&self, other: &Displacement) -> Displacement {
        Displacement { forward_cm: self.forward_cm + other.forward_cm, turn_rad: self.turn_rad + other.turn_rad }
    }
}

/// A segment of a run with a pose in every row.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Vector from start to end, cm.
    pub chord_cm: DVec2,
    /// Heading halfway, rad.
    pub heading_rad: f64,
    /// Observed turn, rad.
    pub turn_rad: f64,
    /// Commanded motion.
    pub commanded: Displacement,
}

/// Returns the displacement that a command should cause within `ms`.
pub fn commanded(robot: &Robot, [left, right]: [f64; 2], ms: f64) -> Displacement {
    let cm = |command: f64| command / 100.0 * robot.full_speed_cm_s * ms / 1000.0;
    Displacement { forward_cm: (cm(left) + cm(right)) / 2.0, turn_rad: (cm(right) - cm(left)) / robot.track_cm }
}

/// Returns whether a step spans missing rows.
pub fn is_gap(robot: &Robot, from_ms: f64, to_ms: f64) -> bool {
    to_ms - from_ms > LONGEST_STEP * robot.step_ms
}

/// Splits logs into segments; large logs are subsampled.
pub fn segments(logs: &Logs) -> Vec<Segment> {
    let mut segments = Vec::new();
    let stride = stride(logs.rows());
    let mut found = 0_usize;
    for r in &logs.runs {
        let mut from = 0;
        while from + 1 < r.rows.len() {
            let mut turn_rad = 0.0;
            let mut driven = Displacement::default();
            let mut to = from;
            let segment = loop {
                let Some(next) = r.rows.get(to + 1) else { break None };
                let here = &r.rows.at(to);
                let (Some(a), Some(b)) = (here.pose, next.pose) else { break None };
                if is_gap(&logs.robot, here.t_ms, next.t_ms) {
                    break None;
                }
                let step = commanded(&logs.robot, here.command(), next.t_ms - here.t_ms);
                driven.forward_cm += step.forward_cm;
                driven.turn_rad += step.turn_rad;
                turn_rad += wrap_rad(b.heading_rad - a.heading_rad);
                to += 1;
                let ms = next.t_ms - r.rows.at(from).t_ms;
                let Some(start) = r.rows.at(from).pose.filter(|_| ms >= SEGMENT_MS) else { continue };
                break Some(Segment {
                    chord_cm: b.position_cm - start.position_cm,
                    heading_rad: start.heading_rad + turn_rad / 2.0,
                    turn_rad,
                    commanded: driven,
                });
            };
            segments.extend(segment.filter(|_| found.is_multiple_of(stride)));
            found += usize::from(segment.is_some());
            from = to.max(from + 1);
        }
    }
    segments
}

/// Returns the segments with a large forward command and wheels that do not oppose each other.
pub fn straight<'a>(segments: &'a [Segment], robot: &Robot) -> Vec<&'a Segment> {
    let largest = segments.iter().map(|segment| segment.commanded.forward_cm.abs()).fold(0.0, f64::max);
    let is_straight = |segment: &&Segment| {
        let Displacement { forward_cm, turn_rad } = segment.commanded;
        largest > 0.0
            && forward_cm.abs() >= LARGE * largest
            && turn_rad.abs() * robot.track_cm / 2.0 <= forward_cm.abs()
    };
    segments.iter().filter(is_straight).collect()
}

/// Returns the segments with a large commanded turn.
pub fn turning(segments: &[Segment]) -> Vec<&Segment> {
    let largest = segments.iter().map(|segment| segment.commanded.turn_rad.abs()).fold(0.0, f64::max);
    segments.iter().filter(|segment| largest > 0.0 && segment.commanded.turn_rad.abs() >= LARGE * largest).collect()
}

/// Observed motion per commanded motion; `None` with too few segments.
#[derive(Clone, Copy, Debug)]
pub struct Gains {
    /// Observed per commanded length, whatever the direction.
    pub length: Option<f64>,
    /// Observed per commanded turn; negative if the robot turns the opposite way.
    pub turn: Option<f64>,
}

impl Gains {
    /// Fits the gains by least absolute deviations.
    pub fn of(segments: &[Segment], robot: &Robot) -> Self {
        let length = straight(segments, robot)
            .into_iter()
            .map(|segment| (segment.chord_cm.length(), segment.commanded.forward_cm.abs()));
        let turn = turning(segments).into_iter().map(|segment| (segment.turn_rad, segment.commanded.turn_rad));
        Gains { length: slope(length.collect()), turn: slope(turn.collect()) }
    }
}

/// Fits the slope of observed over commanded motion; `None` with too few pairs.
fn slope(pairs: Vec<(f64, f64)>) -> Option<f64> {
    if pairs.len() < MIN_SAMPLES { None } else { robust_slope(pairs.into_iter()) }
}
