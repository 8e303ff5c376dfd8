//! Both sides of the motion in one unit: what wheels turned or commands asked for, and what the track shows of it.
//!
//! Neither the alignment of clocks nor a share of explained motion depends on units, so a track in metres against wheels in
//! centimetres would look like a perfect match.

use std::f64::consts::PI;

use serde::Serialize;

use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::robust_slope;
use mindgap_logs::{Robot, Row, Run};

/// Lengths and angles on both sides, summed over the steps in which something was asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Sides {
    /// Travel that was asked for, cm.
    pub asked_cm: f64,
    /// Travel that the track shows, cm.
    pub tracked_cm: f64,
    /// Rotation that was asked for, degrees.
    pub asked_deg: f64,
    /// Rotation that the track shows, degrees.
    pub tracked_deg: f64,
    /// What a robust fit says that the track shows of each centimetre asked for.
    pub of_travel: Option<f64>,
    /// The same of each degree; below zero where the robot turns the other way.
    pub of_rotation: Option<f64>,
}

/// A step: what was asked for (cm, rad) and the poses at its ends.
type Step = ([f64; 2], Pose, Pose);

/// With fewer steps nothing is said.
const FEWEST: usize = 10;
/// A unit is the matter where the factor lies within this factor of it.
const WITHIN: f64 = 2.0;
/// What lengths differ by in other units, and which these are.
const LENGTHS: [(f64, &str, &str); 6] = [
    (0.01, "m", "cm"),
    (0.1, "cm", "mm"),
    (0.001, "m", "mm"),
    (100.0, "cm", "m"),
    (10.0, "mm", "cm"),
    (1000.0, "mm", "m"),
];

impl Sides {
    /// Of steps in order of time.
    pub fn of(steps: impl Iterator<Item = Step>) -> Self {
        let mut sides = Sides::default();
        let (mut travels, mut rotations) = (Vec::new(), Vec::new());
        for ([cm, rad], from, to) in steps.filter(|(asked, ..)| *asked != [0.0; 2]) {
            let change = from.relative(&to);
            let tracked_cm = change.position_cm.length();
            sides.asked_cm += cm.abs();
            sides.tracked_cm += tracked_cm;
            sides.asked_deg += rad.abs().to_degrees();
            sides.tracked_deg += change.heading_rad.abs().to_degrees();
            travels.push((tracked_cm, cm.abs()));
            rotations.push((change.heading_rad, rad));
        }
        let fitted =
            |pairs: Vec<(f64, f64)>| (pairs.len() >= FEWEST).then(|| robust_slope(pairs.into_iter())).flatten();
        Sides { of_travel: fitted(travels), of_rotation: fitted(rotations), ..sides }
    }

    /// Of a run, by its rotation counters.
    pub fn of_wheels(run: &Run, robot: &Robot) -> Self {
        let cm_per_deg = PI * robot.wheel_diameter_cm / 360.0;
        let turned = |a: Option<f64>, b: Option<f64>| Some((b? - a?) * cm_per_deg);
        Sides::of(run.rows.pairs().filter_map(|pair| {
            let left_cm = turned(pair[0].rot_left_deg, pair[1].rot_left_deg)?;
            let right_cm = turned(pair[0].rot_right_deg, pair[1].rot_right_deg)?;
            Some((drive(left_cm, right_cm, robot), pair[0].pose?, pair[1].pose?))
        }))
    }

    /// Of runs, by their commands.
    pub fn of_commands(runs: &[Run], robot: &Robot) -> Self {
        let steps = runs.iter().flat_map(|run| run.rows.pairs());
        Sides::of(steps.filter_map(|pair| {
            let [left_cm, right_cm] = covered(&pair[0], pair[1].t_ms - pair[0].t_ms, robot);
            Some((drive(left_cm, right_cm, robot), pair[0].pose?, pair[1].pose?))
        }))
    }

    /// Which unit is wrong on one side, if one is; `asking` and `track` name the sides.
    pub fn refusal(&self, asking: &str, track: &str) -> Option<String> {
        let is_near = |gain: f64, unit: f64| (unit / WITHIN..unit * WITHIN).contains(&gain);
        let length = self.of_travel.and_then(|gain| LENGTHS.into_iter().find(|(unit, ..)| is_near(gain, *unit)));
        if let Some((_, is, read)) = length {
            return Some(format!(
                "{asking} travel {:.1} cm where {track} shows {:.1} cm, {} times as much: the track seems to be in {is} and was \
                 read in {read}; name its columns x_{is} and y_{is} or give --length-unit {is} (or correct the speeds and \
                 robot.toml, if it is they that are off)",
                self.asked_cm,
                self.tracked_cm,
                short(self.of_travel?)
            ));
        }
        let gain = self.of_rotation?.abs();
        let (is, read) = match gain {
            gain if is_near(gain, PI / 180.0) => ("rad", "deg"),
            gain if is_near(gain, 180.0 / PI) => ("deg", "rad"),
            _ => return None,
        };
        Some(format!(
            "{asking} turn {:.0} deg where {track} shows {:.0} deg, {} times as much: the heading seems to be in {is} and was read \
             in {read}; name its column heading_{is} or give --angle-unit {is} (or correct the turn rates, if it is they that \
             are off)",
            self.asked_deg,
            self.tracked_deg,
            short(gain)
        ))
    }
}

/// What the commands of a row ask of the wheels within a time, cm.
pub fn covered(row: &Row, ms: f64, robot: &Robot) -> [f64; 2] {
    row.command().map(|command| command / 100.0 * robot.full_speed_cm_s * ms / 1000.0)
}

/// Travel (cm) and rotation (rad) of wheels that cover these lengths.
pub fn drive(left_cm: f64, right_cm: f64, robot: &Robot) -> [f64; 2] {
    [(left_cm + right_cm) / 2.0, (right_cm - left_cm) / robot.track_cm]
}

/// A factor with two digits that count.
fn short(factor: f64) -> String {
    if factor >= 10.0 { format!("{factor:.0}") } else { format!("{factor:.4}").trim_end_matches('0').to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sides(length: f64, angle: f64) -> Sides {
        Sides::of((0..20).map(|i| {
            let rad = 0.1 + 0.01 * f64::from(i % 5);
            ([4.0, rad], Pose::new(0.0, 0.0, 0.0), Pose::new(4.0 * length, 0.0, rad * angle))
        }))
    }

    #[test]
    fn other_units_are_named_with_both_sides() {
        assert_eq!(sides(0.9, 1.2).refusal("the wheels", "the track"), None);
        let metres = sides(0.01, 1.0).refusal("the wheels", "the track").expect("refused");
        assert!(
            metres.contains("80.0 cm where the track shows 0.8 cm") && metres.contains("--length-unit m "),
            "{metres}"
        );
        let degrees = sides(1.0, PI / 180.0).refusal("the wheels", "the track").expect("refused");
        assert!(degrees.contains("--angle-unit rad"), "{degrees}");
    }
}
