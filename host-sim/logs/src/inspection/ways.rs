//! Ways: stretches of runs long enough that motion outweighs a tracker's noise, beside what their commands ask for.

use glam::DVec2;

use crate::{Logs, Robot};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::robust_slope;

/// A way takes at least this long: within it even a slow robot covers more than a camera's centimetre of noise. Rows that
/// are farther apart make a way each.
const WAY_MS: f64 = 300.0;
/// A step longer than this multiple of `step_ms` spans missing rows and belongs to no way.
const LONGEST_STEP: f64 = 1.5;
/// A way that asks for less than this share of the most that is asked for tells more of noise than of the robot.
pub const LARGE: f64 = 0.25;
/// With fewer ways nothing is decided: of twenty tosses of a coin sixteen fall on one side once in a hundred times.
pub const FEWEST: usize = 20;

/// What so many steps of a robot tell of it, more of them hardly would.
const ENOUGH: usize = 300_000;

/// Of so many rows every so many are enough. It is an odd number, so that commands which change every so many rows are seen
/// at all their ages.
pub fn one_in(rows: usize) -> usize {
    rows.div_ceil(ENOUGH).max(1) | 1
}

/// What a differential drive covers: forward (cm) and to the left (rad).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    /// Forward, cm.
    pub forward_cm: f64,
    /// To the left, rad.
    pub turn_rad: f64,
}

impl Drive {
    /// This and another one after it.
    pub fn and(&self, other: &Drive) -> Drive {
        Drive { forward_cm: self.forward_cm + other.forward_cm, turn_rad: self.turn_rad + other.turn_rad }
    }
}

/// A stretch of a run with a pose in every row.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// From its begin to its end, cm.
    pub chord_cm: DVec2,
    /// The heading halfway.
    pub heading_rad: f64,
    /// How far the robot turned.
    pub turn_rad: f64,
    /// What the commands ask for.
    pub asked: Drive,
}

/// What a command asks for within a time.
pub fn asked(robot: &Robot, [left, right]: [f64; 2], ms: f64) -> Drive {
    let cm = |command: f64| command / 100.0 * robot.full_speed_cm_s * ms / 1000.0;
    Drive { forward_cm: (cm(left) + cm(right)) / 2.0, turn_rad: (cm(right) - cm(left)) / robot.track_cm }
}

/// Whether a step spans missing rows.
pub fn is_broken(robot: &Robot, from_ms: f64, to_ms: f64) -> bool {
    to_ms - from_ms > LONGEST_STEP * robot.step_ms
}

/// The ways of logs, one after the other; of large logs enough of them.
pub fn ways(logs: &Logs) -> Vec<Way> {
    let mut ways = Vec::new();
    let one_in = one_in(logs.rows());
    let mut found = 0_usize;
    for r in &logs.runs {
        let mut from = 0;
        while from + 1 < r.rows.len() {
            let mut turn_rad = 0.0;
            let mut driven = Drive::default();
            let mut to = from;
            let way = loop {
                let Some(next) = r.rows.get(to + 1) else { break None };
                let here = &r.rows.at(to);
                let (Some(a), Some(b)) = (here.pose, next.pose) else { break None };
                if is_broken(&logs.robot, here.t_ms, next.t_ms) {
                    break None;
                }
                let step = asked(&logs.robot, here.command(), next.t_ms - here.t_ms);
                driven.forward_cm += step.forward_cm;
                driven.turn_rad += step.turn_rad;
                turn_rad += wrap_rad(b.heading_rad - a.heading_rad);
                to += 1;
                let ms = next.t_ms - r.rows.at(from).t_ms;
                let Some(begin) = r.rows.at(from).pose.filter(|_| ms >= WAY_MS) else { continue };
                break Some(Way {
                    chord_cm: b.position_cm - begin.position_cm,
                    heading_rad: begin.heading_rad + turn_rad / 2.0,
                    turn_rad,
                    asked: driven,
                });
            };
            ways.extend(way.filter(|_| found.is_multiple_of(one_in)));
            found += usize::from(way.is_some());
            from = to.max(from + 1);
        }
    }
    ways
}

/// The ways that ask for enough forward and more of it than of turning: neither wheel runs against the other.
pub fn straight<'a>(ways: &'a [Way], robot: &Robot) -> Vec<&'a Way> {
    let most = ways.iter().map(|way| way.asked.forward_cm.abs()).fold(0.0, f64::max);
    let is_straight = |way: &&Way| {
        let Drive { forward_cm, turn_rad } = way.asked;
        most > 0.0 && forward_cm.abs() >= LARGE * most && turn_rad.abs() * robot.track_cm / 2.0 <= forward_cm.abs()
    };
    ways.iter().filter(is_straight).collect()
}

/// The ways that ask for enough turning.
pub fn turning(ways: &[Way]) -> Vec<&Way> {
    let most = ways.iter().map(|way| way.asked.turn_rad.abs()).fold(0.0, f64::max);
    ways.iter().filter(|way| most > 0.0 && way.asked.turn_rad.abs() >= LARGE * most).collect()
}

/// How much of what is asked for the robot does; none where too few ways tell it.
#[derive(Clone, Copy, Debug)]
pub struct Gains {
    /// Length covered for length asked for, whatever its direction.
    pub length: Option<f64>,
    /// Turn for turn; below zero where it turns the other way.
    pub turn: Option<f64>,
}

impl Gains {
    /// By least absolute deviations.
    pub fn of(ways: &[Way], robot: &Robot) -> Self {
        let length = straight(ways, robot).into_iter().map(|way| (way.chord_cm.length(), way.asked.forward_cm.abs()));
        let turn = turning(ways).into_iter().map(|way| (way.turn_rad, way.asked.turn_rad));
        Gains { length: slope(length.collect()), turn: slope(turn.collect()) }
    }
}

/// The slope of what is done over what is asked; none of few.
fn slope(pairs: Vec<(f64, f64)>) -> Option<f64> {
    if pairs.len() < FEWEST { None } else { robust_slope(pairs.into_iter()) }
}
