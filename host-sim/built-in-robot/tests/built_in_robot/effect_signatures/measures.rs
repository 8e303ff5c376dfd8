//! What is measured of logs, on plain terms of their own: none of the robot's inner quantities is read.

use std::sync::LazyLock;

use mindgap_built_in_robot::{default_robot, record, training_room};
use mindgap_logs::Logs;
use mindgap_logs::samples::{MotionSample, SonarSample, motion, sonar};

/// What one unit of command asks of a wheel in a step, cm.
const ASKED_CM: f64 = 0.164;
/// A wheel's distance from the middle of the axle, cm.
const HALF_TRACK_CM: f64 = 5.75;

/// Every effect is tried on as many random drives: what one of them shows by luck is no mark.
const SEEDS: [u64; 3] = [2024, 2025, 2026];

static HEALTHY: LazyLock<[Measured; SEEDS.len()]> = LazyLock::new(|| SEEDS.map(|seed| measured(seed, "")));

/// Logs with their samples.
pub struct Measured {
    pub logs: Logs,
    pub motion: Vec<MotionSample>,
    pub sonar: Vec<SonarSample>,
}

/// One random drive, with whatever effect.
pub struct Driving(usize);

/// All of them.
pub fn drivings() -> impl Iterator<Item = Driving> {
    (0..SEEDS.len()).map(Driving)
}

impl Driving {
    /// The healthy robot's measure, and that with the effect.
    pub fn without_and_with<T>(&self, effect: &str, measure: impl Fn(&Measured) -> T) -> (T, T) {
        (self.healthy(&measure), self.with_effect(effect, measure))
    }

    /// The measure of the healthy robot.
    pub fn healthy<T>(&self, measure: impl FnOnce(&Measured) -> T) -> T {
        measure(&HEALTHY[self.0])
    }

    /// The measure with the effect.
    pub fn with_effect<T>(&self, effect: &str, measure: impl FnOnce(&Measured) -> T) -> T {
        measure(&measured(SEEDS[self.0], effect))
    }
}

fn measured(seed: u64, effect: &str) -> Measured {
    let effects: Vec<_> = effect.split_whitespace().map(|text| text.parse().expect("an effect")).collect();
    let logs = record(&default_robot(), &training_room(), 20, 60, &effects, seed).expect("the room is large enough");
    Measured { motion: motion(&logs), sonar: sonar(&logs), logs }
}

/// What the left and the right wheel covered, cm.
pub fn covered_cm(s: &MotionSample) -> [f64; 2] {
    let turned_cm = s.turn_rad * HALF_TRACK_CM;
    [s.forward_cm - turned_cm, s.forward_cm + turned_cm]
}

/// What the commands ask of them, the last ones still at work for a while, cm.
pub fn asked_cm(s: &MotionSample) -> [f64; 2] {
    let [left, right, last_left, last_right] = s.speeds;
    [(left, last_left), (right, last_right)].map(|(now, last)| ASKED_CM * (0.85 * now + 0.15 * last))
}

/// What they ask of the middle of the axle: forward in cm, and the turn in radians.
pub fn asked_motion(s: &MotionSample) -> (f64, f64) {
    let [left, right] = asked_cm(s);
    ((left + right) / 2.0, (right - left) / (2.0 * HALF_TRACK_CM))
}

/// Way forward that is covered and was not asked for, at the healthy robot's share, cm.
pub fn surplus_cm(s: &MotionSample) -> f64 {
    s.forward_cm - 0.93 * asked_motion(s).0
}

/// Whether both commands were held from the step before.
pub fn is_steady(s: &MotionSample) -> bool {
    s.speeds[0] == s.speeds[2] && s.speeds[1] == s.speeds[3]
}

/// How far the mean command jumped at this step.
pub fn jump(s: &MotionSample) -> f64 {
    (s.speeds[0] + s.speeds[1] - s.speeds[2] - s.speeds[3]) / 2.0
}

/// The slope of `y` over `x` through zero.
pub fn slope(xy: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (top, bottom) = xy.fold((0.0, 0.0), |(top, bottom), (x, y)| (top + x * y, bottom + x * x));
    assert!(bottom > 0.0, "nothing to measure");
    top / bottom
}

/// The weights of `a` and `b` that come nearest to `y`.
pub fn two_slopes(aby: impl Iterator<Item = (f64, f64, f64)>) -> (f64, f64) {
    let [mut aa, mut ab, mut bb, mut ay, mut by] = [0.0; 5];
    for (a, b, y) in aby {
        (aa, ab, bb, ay, by) = (aa + a * a, ab + a * b, bb + b * b, ay + a * y, by + b * y);
    }
    let across = aa * bb - ab * ab;
    ((ay * bb - by * ab) / across, (by * aa - ay * ab) / across)
}

pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0), |(sum, n), v| (sum + v, n + 1));
    assert!(n >= 10, "only {n} to measure");
    sum / f64::from(n)
}

pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    assert!(values.len() >= 10, "only {} to measure", values.len());
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Standard deviation about zero.
pub fn scatter(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.map(|v| v * v)).sqrt()
}

/// The share for which something holds.
pub fn share(holds: impl Iterator<Item = bool>) -> f64 {
    mean(holds.map(|h| if h { 1.0 } else { 0.0 }))
}
