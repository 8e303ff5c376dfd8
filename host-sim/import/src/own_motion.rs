//! What a robot measures of its own motion: rotation counters and a gyro.

use super::frame::GAP_MS;
use super::left_out::LeftOut;
use mindgap_foundations::statistics::summary::median;

/// Rotation counters and a gyro, as far as they were recorded.
#[derive(Clone, Debug, Default)]
pub struct OwnMotion {
    /// Angles of the left and of the right wheels, rad; one stream per wheel.
    pub wheels: [Vec<Series>; 2],
    /// Yaw rate, rad/s, positive counter-clockwise.
    pub gyro: Option<Series>,
}

/// Numbers over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Time, ms, and number, in temporal order.
    pub samples: Vec<(f64, f64)>,
    /// Whether they are on the clock of the poses rather than that of the commands.
    pub on_clock_of_poses: bool,
    /// Numbers farther apart than this are not interpolated, ms.
    gap_ms: f64,
}

/// A wheel turns no farther in a recording, rad: that of a large robot has then gone some ten kilometres.
const MAX_RAD: f64 = 1e5;
/// A robot turns no faster, rad/s.
const MAX_RAD_S: f64 = 1e3;
/// Numbers are interpolated up to this multiple of their usual interval.
const USUAL_GAP: f64 = 2.5;

impl OwnMotion {
    /// Returns the angle of the wheels of a side, rad, at a time on the clocks of commands and poses: the mean of its wheels;
    /// `None` if one of them is unknown.
    pub fn angle_rad(&self, side: usize, times_ms: [f64; 2]) -> Option<f64> {
        let wheels = &self.wheels[side];
        let angles: Option<Vec<f64>> = wheels.iter().map(|wheel| wheel.on(times_ms)).collect();
        angles.filter(|angles| !angles.is_empty()).map(|angles| angles.iter().sum::<f64>() / angles.len() as f64)
    }

    /// Returns the yaw rate, rad/s, at a time on the clocks of commands and poses.
    pub fn yaw_rad_s(&self, times_ms: [f64; 2]) -> Option<f64> {
        self.gyro.as_ref()?.on(times_ms)
    }
}

impl Series {
    /// Makes a series of the angles of a wheel, rad, in temporal order, counted from the first; also returns how many were left out
    /// because no wheel turns that far.
    pub fn of_wheel(mut samples: Vec<(f64, f64)>, on_clock_of_poses: bool) -> (Self, Option<LeftOut>) {
        let first_rad = samples.iter().map(|(_, rad)| *rad).find(|rad| rad.is_finite()).unwrap_or(0.0);
        samples.iter_mut().for_each(|(_, rad)| *rad -= first_rad);
        Series::within("angle", MAX_RAD, samples, on_clock_of_poses)
    }

    /// Makes a series of yaw rates, rad/s, in temporal order; also returns how many were left out because no robot turns that fast.
    pub fn of_gyro(samples: Vec<(f64, f64)>, on_clock_of_poses: bool) -> (Self, Option<LeftOut>) {
        Series::within("yaw rate", MAX_RAD_S, samples, on_clock_of_poses)
    }

    fn within(
        what: &str,
        largest: f64,
        mut samples: Vec<(f64, f64)>,
        on_clock_of_poses: bool,
    ) -> (Self, Option<LeftOut>) {
        let all = samples.len();
        samples.retain(|(_, number)| number.abs() <= largest);
        let dropped = all - samples.len();
        let usual_ms = median(samples.windows(2).map(|pair| pair[1].0 - pair[0].0));
        let series = Series { samples, on_clock_of_poses, gap_ms: GAP_MS.max(USUAL_GAP * usual_ms) };
        (series, (dropped > 0).then(|| LeftOut::rows(what, dropped, "larger than any robot's")))
    }

    /// Returns the number at a time on the clocks of commands and poses.
    fn on(&self, [command_ms, pose_ms]: [f64; 2]) -> Option<f64> {
        self.at(if self.on_clock_of_poses { pose_ms } else { command_ms })
    }

    /// Returns the number at a time, interpolated; `None` outside the samples and in gaps.
    fn at(&self, t_ms: f64) -> Option<f64> {
        let after = self.samples.partition_point(|(ms, _)| *ms <= t_ms);
        let (from_ms, from) = *self.samples.get(after.checked_sub(1)?)?;
        if from_ms == t_ms {
            return Some(from);
        }
        let (to_ms, to) = *self.samples.get(after)?;
        (to_ms - from_ms <= self.gap_ms).then(|| from + (t_ms - from_ms) / (to_ms - from_ms) * (to - from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_interpolated_but_not_across_gaps() {
        let samples = vec![(0.0, 1.0), (90.0, 1e9), (100.0, 2.0), (200.0, 4.0), (1200.0, 8.0)];
        let (series, dropped) = Series::of_gyro(samples, false);
        assert_eq!(dropped.and_then(|dropped| dropped.rows), Some(1));
        let at = [-1.0, 0.0, 50.0, 150.0, 200.0, 700.0, 1200.0, 1201.0].map(|ms| series.at(ms));
        assert_eq!(at, [None, Some(1.0), Some(1.5), Some(3.0), Some(4.0), None, Some(8.0), None]);
    }

    #[test]
    fn wheels_of_a_side_are_averaged_and_must_all_be_known() {
        let wheel = |rad: f64, last_ms: f64| Series::of_wheel(vec![(0.0, 7.0), (last_ms, 7.0 + rad)], false).0;
        let motion = OwnMotion { wheels: [vec![wheel(1.0, 100.0), wheel(1.0, 50.0)], Vec::new()], gyro: None };
        assert_eq!(motion.angle_rad(0, [25.0, 0.0]), Some(0.375));
        assert_eq!((motion.angle_rad(0, [80.0, 0.0]), motion.angle_rad(1, [20.0, 0.0])), (None, None));
    }
}
