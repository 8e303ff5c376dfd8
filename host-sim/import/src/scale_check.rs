//! Compares wheel or commanded motion with tracked motion in one unit.
//!
//! The alignment of clocks is independent of scale, so without this check a track in metres would match wheels in centimetres
//! perfectly.

use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::Serialize;

use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::robust_slope;
use mindgap_logs::{Robot, Row, Run};

/// Commanded (or wheel) and tracked motion, summed over the steps with a command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ScaleCheck {
    /// Commanded travel, cm.
    pub commanded_cm: f64,
    /// Tracked travel, cm.
    pub tracked_cm: f64,
    /// Commanded rotation, degrees.
    pub commanded_deg: f64,
    /// Tracked rotation, degrees.
    pub tracked_deg: f64,
    /// Tracked per commanded travel, by a robust fit.
    pub travel_ratio: Option<f64>,
    /// Tracked per commanded rotation, by a robust fit; negative if the robot turns the opposite way.
    pub rotation_ratio: Option<f64>,
}

/// A step: commanded travel and rotation (cm, rad) and the poses at its ends.
type Step = ([f64; 2], Pose, Pose);

/// Minimum number of steps for a fit.
const MIN_STEPS: usize = 10;
/// A unit is wrong if the ratio is within this factor of the ratio of two units.
const WITHIN: f64 = 2.0;
/// Ratios of tracked to commanded length for each true unit and the unit it was read in.
const LENGTHS: [(f64, &str, &str); 6] = [
    (0.01, "m", "cm"),
    (0.1, "cm", "mm"),
    (0.001, "m", "mm"),
    (100.0, "cm", "m"),
    (10.0, "mm", "cm"),
    (1000.0, "mm", "m"),
];

/// Ratios of tracked to commanded travel and rotation for each unit of the wheels that was read as cm.
const WHEELS: [(f64, &str); 2] = [(100.0, "m"), (0.1, "mm")];
/// Ratios of tracked to commanded rotation, with their causes.
const ROTATIONS: [(f64, &str); 4] = [
    (
        PI / 180.0,
        "the heading seems to be in rad and was read in deg; name its column heading_rad or give --angle-unit rad",
    ),
    (
        180.0 / PI,
        "the heading seems to be in deg and was read in rad; name its column heading_deg or give --angle-unit deg",
    ),
    (0.01, "track_cm in robot.toml seems to be in m; write centimetres"),
    (10.0, "track_cm in robot.toml seems to be in mm; write centimetres"),
];

impl ScaleCheck {
    /// Sums and fits the steps.
    pub fn of(steps: impl Iterator<Item = Step>) -> Self {
        let mut totals = ScaleCheck::default();
        let (mut travels, mut rotations) = (Vec::new(), Vec::new());
        for ([cm, rad], from, to) in steps.filter(|(commanded, ..)| *commanded != [0.0; 2]) {
            let change = from.relative(&to);
            let tracked_cm = change.position_cm.length();
            totals.commanded_cm += cm.abs();
            totals.tracked_cm += tracked_cm;
            totals.commanded_deg += rad.abs().to_degrees();
            totals.tracked_deg += change.heading_rad.abs().to_degrees();
            travels.push((tracked_cm, cm.abs()));
            rotations.push((change.heading_rad, rad));
        }
        let fitted =
            |pairs: Vec<(f64, f64)>| (pairs.len() >= MIN_STEPS).then(|| robust_slope(pairs.into_iter())).flatten();
        ScaleCheck { travel_ratio: fitted(travels), rotation_ratio: fitted(rotations), ..totals }
    }

    /// Compares a run's rotation counters with its poses.
    pub fn of_wheels(run: &Run, robot: &Robot) -> Self {
        let cm_per_deg = PI * robot.wheel_diameter_cm / 360.0;
        let turned = |a: Option<f64>, b: Option<f64>| Some((b? - a?) * cm_per_deg);
        ScaleCheck::of(run.rows.pairs().filter_map(|pair| {
            let left_cm = turned(pair[0].rot_left_deg, pair[1].rot_left_deg)?;
            let right_cm = turned(pair[0].rot_right_deg, pair[1].rot_right_deg)?;
            Some((travel_and_rotation(left_cm, right_cm, robot), pair[0].pose?, pair[1].pose?))
        }))
    }

    /// Compares the commands of runs with their poses.
    pub fn of_commands(runs: &[Run], robot: &Robot) -> Self {
        let steps = runs.iter().flat_map(|run| run.rows.pairs());
        ScaleCheck::of(steps.filter_map(|pair| {
            let [left_cm, right_cm] = commanded_wheels_cm(&pair[0], pair[1].t_ms - pair[0].t_ms, robot);
            Some((travel_and_rotation(left_cm, right_cm, robot), pair[0].pose?, pair[1].pose?))
        }))
    }

    /// Returns an error message if a unit seems wrong; `source` and `track` name the two sources.
    pub fn refusal(&self, source: &str, track: &str) -> Option<String> {
        let is_near = |gain: f64, unit: f64| (unit / WITHIN..unit * WITHIN).contains(&gain);
        let turned = self.rotation_ratio.map(f64::abs);
        let length = self.travel_ratio.and_then(|gain| LENGTHS.into_iter().find(|(unit, ..)| is_near(gain, *unit)));
        // A wrong wheel changes travel and rotation alike.
        let wheels = WHEELS.into_iter().find(|(unit, _)| {
            self.travel_ratio.is_some_and(|gain| is_near(gain, *unit))
                && turned.is_some_and(|gain| is_near(gain, *unit))
        });
        if let Some((_, is)) = wheels {
            return Some(format!(
                "{track} shows {} times the travel and {} times the rotation of {source}: wheel_diameter_cm or \
                 full_speed_cm_s in robot.toml seems to be in {is}; write centimetres",
                short(self.travel_ratio?),
                short(turned?)
            ));
        }
        if let Some((_, is, read)) = length {
            return Some(format!(
                "{source} travel {:.1} cm where {track} shows {:.1} cm, {} times as much: the track seems to be in {is} and was \
                 read in {read}; name its columns x_{is} and y_{is} or give --length-unit {is} (or correct the speeds and \
                 robot.toml if those are wrong)",
                self.commanded_cm,
                self.tracked_cm,
                short(self.travel_ratio?)
            ));
        }
        let gain = turned?;
        let off = |unit: f64| libm::log(gain / unit).abs();
        let (unit, cause) = ROTATIONS.into_iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
        is_near(gain, unit).then(|| {
            format!(
                "{source} turn {:.0} deg where {track} shows {:.0} deg, {} times as much: {cause} (or correct the turn rates if \
                 those are wrong)",
                self.commanded_deg,
                self.tracked_deg,
                short(gain)
            )
        })
    }
}

/// Returns the distances that the commands of a row require of the wheels within `ms`, cm.
pub fn commanded_wheels_cm(row: &Row, ms: f64, robot: &Robot) -> [f64; 2] {
    row.command().map(|command| command / 100.0 * robot.full_speed_cm_s * ms / 1000.0)
}

/// Returns travel (cm) and rotation (rad) for the distances covered by the wheels.
pub fn travel_and_rotation(left_cm: f64, right_cm: f64, robot: &Robot) -> [f64; 2] {
    [(left_cm + right_cm) / 2.0, (right_cm - left_cm) / robot.track_cm]
}

/// Formats a factor with about two significant digits.
fn short(factor: f64) -> String {
    if factor >= 10.0 { format!("{factor:.0}") } else { format!("{factor:.4}").trim_end_matches('0').to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(length: f64, angle: f64) -> ScaleCheck {
        ScaleCheck::of((0..20).map(|i| {
            // Not wrapped by the largest factor.
            let rad = 0.01 + 0.001 * f64::from(i % 5);
            ([4.0, rad], Pose::new(0.0, 0.0, 0.0), Pose::new(4.0 * length, 0.0, rad * angle))
        }))
    }

    #[test]
    fn wrong_units_are_reported_with_both_lengths() {
        assert_eq!(check(0.9, 1.2).refusal("the wheels", "the track"), None);
        let metres = check(0.01, 1.0).refusal("the wheels", "the track").expect("refused");
        assert!(
            metres.contains("80.0 cm where the track shows 0.8 cm") && metres.contains("--length-unit m "),
            "{metres}"
        );
        let degrees = check(1.0, PI / 180.0).refusal("the wheels", "the track").expect("refused");
        assert!(degrees.contains("--angle-unit rad"), "{degrees}");
        for (length, angle, what) in [
            (1.0, 0.01, "track_cm in robot.toml seems to be in m;"),
            (1.0, 10.0, "track_cm in robot.toml seems to be in mm;"),
            (100.0, 100.0, "full_speed_cm_s in robot.toml seems to be in m;"),
            (0.1, 0.1, "full_speed_cm_s in robot.toml seems to be in mm;"),
        ] {
            let refusal = check(length, angle).refusal("the wheels", "the track").expect("refused");
            assert!(refusal.contains(what), "{refusal}");
        }
    }
}
