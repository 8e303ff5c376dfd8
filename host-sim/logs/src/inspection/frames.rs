//! Frames: which way x, y and headings point, against where the commands take the robot and against the walls.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec2;

use super::finding::{Finding, Handling, Part, Place};
use super::map::{faced, fitting};
use super::ways::{FEWEST, Way, straight, turning, ways};
use crate::{Logs, Robot};
use mindgap_foundations::geometry::{Pose, Rectangle, wrap_rad};

/// The least share of ways that has to agree with a frame: one row in ten may be wrong, and each spoils two ways.
pub const DECISIVE: f64 = 0.8;
/// The largest share that agrees with the frame as it is when another one is right. A compass that is off by 20° and a
/// camera turned by as much leave all ways within the 45° that count as agreement.
const LEFT: f64 = 0.5;
/// By so much the share of readings that fit the walls grows in the right frame. A rectangular room looks half the same
/// when it is turned, and whatever the robot's faults the frame as it is fits best, if only by a few hundredths.
const MORE_FITTING: f64 = 0.2;
/// Of fewer readings a share may be off by half of that.
const FEWEST_READINGS: usize = 100;

/// Shares of straight ways that go where the robot heads, turned by quarters of a turn, and then those that go there when
/// headings are counted clockwise, turned likewise; none where too few ways tell it.
pub fn directions(ways: &[Way], robot: &Robot) -> Option<[f64; 8]> {
    let straight: Vec<&Way> = straight(ways, robot).into_iter().filter(|way| way.chord_cm.length() > 0.0).collect();
    if straight.len() < FEWEST {
        return None;
    }
    let mut shares = [0.0; 8];
    for way in &straight {
        let backwards = if way.asked.forward_cm < 0.0 { PI } else { 0.0 };
        let going_rad = libm::atan2(way.chord_cm.y, way.chord_cm.x) + backwards;
        for (i, share) in shares.iter_mut().enumerate() {
            let heading_rad = if i < 4 { way.heading_rad } else { -way.heading_rad };
            let off_rad = wrap_rad(going_rad - heading_rad - (i % 4) as f64 * FRAC_PI_2);
            *share += f64::from(u8::from(off_rad.abs() < FRAC_PI_4)) / straight.len() as f64;
        }
    }
    Some(shares)
}

/// The largest share and its place.
pub fn most_share(shares: &[f64; 8]) -> (usize, f64) {
    let mut most = (0, shares[0]);
    shares.iter().enumerate().for_each(|(i, share)| most = if *share > most.1 { (i, *share) } else { most });
    most
}

/// How the frame of a track lies against the way that its robot goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// In which of the `directions` it goes: 0 where it heads, or where that cannot be told.
    pub going: usize,
    /// Whether it turns against the commands.
    pub is_reversed: bool,
}

impl Orientation {
    /// That of logs.
    pub fn of(logs: &Logs) -> Self {
        let ways = ways(logs);
        let going = directions(&ways, &logs.robot).map_or(0, |shares| match most_share(&shares) {
            (best, share) if share >= DECISIVE && shares[0] <= LEFT => best,
            _ => 0,
        });
        Orientation { going, is_reversed: turns_are_reversed(&ways) }
    }
}

/// Tells frames that do not fit the motion, or do not fit the walls.
pub fn check(logs: &Logs) -> Vec<Finding> {
    let Orientation { going, is_reversed } = Orientation::of(logs);
    let (id, sentence): (_, &str) = match (going, is_reversed) {
        (0, false) => return against_walls(logs, &EVEN, "frame_turned").into_iter().collect(),
        (0, true) => {
            let mirrored = against_walls(logs, &ODD, "frame_mirrored");
            return vec![mirrored.unwrap_or_else(|| told(logs, "left_right_exchanged", EXCHANGED, &[Part::Motion]))];
        }
        (1..4, false) => (
            "frame_turned",
            "The robot goes a quarter or half a turn beside its heading: count heading_deg from +x of the frame of x_cm and y_cm.",
        ),
        (2, true) => (
            "commands_reversed",
            "The robot drives backwards and turns the other way: both motors' signs seem reversed; write positive commands for forwards.",
        ),
        (1..4, true) => (
            "frame_turned",
            "The robot goes a quarter of a turn beside its heading and turns the other way: count heading_deg counter-clockwise from +x, and check left and right.",
        ),
        (4, false) => {
            ("y_downwards", "Positions are mirrored against headings: y_cm seems to count downwards; write it upwards.")
        }
        (6, false) => (
            "frame_mirrored",
            "Positions are mirrored against headings: x_cm seems to count leftwards; write it to the right.",
        ),
        (_, false) => {
            ("xy_exchanged", "Positions are mirrored against headings along a diagonal: x_cm and y_cm seem exchanged.")
        }
        (_, true) => (
            "heading_clockwise",
            "Headings count clockwise, as a compass does: write heading_deg counter-clockwise from +x.",
        ),
    };
    vec![told(logs, id, sentence, &[Part::Motion, Part::Sonar])]
}

const EXCHANGED: &str = "The robot turns right where the commands turn it left: left and right seem exchanged (or, if they are \
                         not, the whole frame is mirrored: y_cm and heading_deg together).";

fn told(logs: &Logs, id: &'static str, sentence: &str, withholds: &'static [Part]) -> Finding {
    Finding { id, places: Place::all(logs), handling: Handling::Told, withholds, sentence: sentence.into() }
}

/// Whether the robot turns against the commands.
fn turns_are_reversed(ways: &[Way]) -> bool {
    let turning = turning(ways);
    let against = turning.iter().filter(|way| way.turn_rad * way.asked.turn_rad < 0.0).count() as f64;
    turning.len() >= FEWEST && against >= DECISIVE * turning.len() as f64
}

/// A symmetry of a rectangle: whether x and y are exchanged, and whether x and y then count from the other side.
type Symmetry = [bool; 3];
/// Those that turn,
const EVEN: [Symmetry; 3] = [[false, true, true], [true, true, false], [true, false, true]];
/// and those that mirror.
const ODD: [Symmetry; 4] = [[false, false, true], [false, true, false], [true, false, false], [true, true, true]];

/// Poses that fit the walls only once they are turned or mirrored.
fn against_walls(logs: &Logs, symmetries: &[Symmetry], id: &'static str) -> Option<Finding> {
    let room = logs.scene.bounding_box()?;
    let as_is = faced(logs, |pose| *pose);
    if as_is.len() < FEWEST_READINGS {
        return None;
    }
    let best = symmetries.iter().map(|symmetry| {
        let pairs = faced(logs, |pose| moved(pose, &room, *symmetry));
        // Readings that face nothing then do not fit.
        fitting(&pairs, 1.0) * pairs.len() as f64 / as_is.len().max(pairs.len()) as f64
    });
    let best = best.fold(0.0, f64::max);
    let sentence = "Readings fit the walls only once all poses are turned or mirrored in the room: write x_cm, y_cm and \
                    heading_deg in the frame of scene.toml, x to the right, y up, headings counter-clockwise from +x.";
    let withholds: &[Part] = if id == "frame_mirrored" { &[Part::Motion, Part::Sonar] } else { &[Part::Sonar] };
    (best >= fitting(&as_is, 1.0) + MORE_FITTING).then(|| told(logs, id, sentence, withholds))
}

fn moved(pose: &Pose, room: &Rectangle, [exchange, flip_x, flip_y]: Symmetry) -> Pose {
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
