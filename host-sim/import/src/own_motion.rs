//! What a robot measures of its own motion: rotation counters and a gyro.

use super::frame::{Frame, GAP_MS};
use super::left_out::LeftOut;
use super::scale_check::travel_and_rotation;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::median;
use mindgap_logs::Robot;

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
/// Time between poses by dead reckoning, ms.
const RECKONED_MS: f64 = 50.0;
/// Number of these times between two samples beyond which the motion between them is unknown: ten seconds.
const MOST_BETWEEN: usize = 200;

impl OwnMotion {
    /// Returns whether the wheels of both sides were counted.
    pub fn has_counters(&self) -> bool {
        self.wheels.iter().all(|wheels| !wheels.is_empty())
    }

    /// Returns whether what shows the motion best is on the clock of the poses rather than that of the commands.
    pub fn is_on_clock_of_poses(&self) -> bool {
        self.best().is_some_and(|series| series.on_clock_of_poses)
    }

    /// Returns the poses of a robot by dead reckoning from its rotation counters; with a gyro alone it turns in its place.
    pub fn dead_reckoned(&self, robot: &Robot) -> Vec<Frame> {
        let samples = self.best().map_or(&[][..], |best| &best.samples);
        let Some((first_ms, _)) = samples.first() else { return Vec::new() };
        // A clock that was wrong for one sample must not make years of frames.
        let mut steps: Vec<usize> = Vec::new();
        for (t_ms, _) in samples {
            let step = ((t_ms - first_ms) / RECKONED_MS) as usize;
            let next = steps.last().map_or(0, |last| last + 1);
            steps.extend(if step.saturating_sub(next) > MOST_BETWEEN { step..=step } else { next..=step });
        }
        let (mut pose, mut before, mut turned_rad) = (Pose::new(0.0, 0.0, 0.0), None, 0.0);
        let frame = |step| {
            let t_ms = first_ms + RECKONED_MS * step as f64;
            let moved = if self.has_counters() {
                let [left_rad, right_rad] = [self.angle_rad(0, [t_ms; 2])?, self.angle_rad(1, [t_ms; 2])?];
                let cm_per_rad = robot.wheel_diameter_cm / 2.0;
                travel_and_rotation(left_rad * cm_per_rad, right_rad * cm_per_rad, robot)
            } else {
                turned_rad += self.yaw_rad_s([t_ms; 2])? * RECKONED_MS / 1e3;
                [0.0, turned_rad]
            };
            let [cm, rad] = before.replace(moved).map_or([0.0; 2], |[cm, rad]| [moved[0] - cm, moved[1] - rad]);
            let (sin, cos) = libm::sincos(rad / 2.0);
            pose = pose.compose(&Pose::new(cm * cos, cm * sin, rad));
            Some(Frame { t_ms, pose })
        };
        steps.into_iter().filter_map(frame).collect()
    }

    /// Returns a wheel if the wheels were counted, or else the gyro.
    fn best(&self) -> Option<&Series> {
        if self.has_counters() { self.wheels[0].first() } else { self.gyro.as_ref() }
    }

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
    use mindgap_built_in_robot::default_robot;

    #[test]
    fn numbers_are_interpolated_but_not_across_gaps() {
        let samples = vec![(0.0, 1.0), (90.0, 1e9), (100.0, 2.0), (200.0, 4.0), (1200.0, 8.0)];
        let (series, dropped) = Series::of_gyro(samples, false);
        assert_eq!(dropped.and_then(|dropped| dropped.rows), Some(1));
        let at = [-1.0, 0.0, 50.0, 150.0, 200.0, 700.0, 1200.0, 1201.0].map(|ms| series.at(ms));
        assert_eq!(at, [None, Some(1.0), Some(1.5), Some(3.0), Some(4.0), None, Some(8.0), None]);
    }

    #[test]
    fn dead_reckoning_follows_the_wheels_or_turns_with_the_gyro() {
        let robot = Robot { wheel_diameter_cm: 10.0, track_cm: 20.0, ..default_robot() };
        let turn_rad = std::f64::consts::FRAC_PI_2;
        // A quarter of a circle of 30 cm about a point to the left.
        let wheel = |cm: f64| vec![Series::of_wheel(vec![(0.0, 0.0), (1000.0, cm * turn_rad / 5.0)], false).0];
        let gyro = Some(Series::of_gyro(vec![(0.0, turn_rad), (1000.0, turn_rad)], false).0);
        let motion = OwnMotion { wheels: [wheel(20.0), wheel(40.0)], gyro };
        let last = motion.dead_reckoned(&robot).pop().expect("frames");
        assert!(last.t_ms == 1000.0 && (last.pose.heading_rad - turn_rad).abs() < 1e-9, "{last:?}");
        assert!(last.pose.position_cm.distance(glam::DVec2::new(30.0, 30.0)) < 0.02, "{last:?}");
        let turning = OwnMotion { wheels: [Vec::new(), wheel(40.0)], ..motion };
        let last = turning.dead_reckoned(&robot).pop().expect("frames");
        assert!((last.pose.heading_rad - turn_rad).abs() < 0.1 && last.pose.position_cm.length() == 0.0, "{last:?}");
        assert!(OwnMotion::default().dead_reckoned(&robot).is_empty());
    }

    #[test]
    fn a_sample_of_another_year_makes_no_frames_until_then() {
        const YEAR_MS: f64 = 365.0 * 86_400_000.0;
        let turned = (0..100).map(|k| (YEAR_MS + 50.0 * f64::from(k), 0.1 * f64::from(k)));
        let wheel = || vec![Series::of_wheel([(0.0, 0.0)].into_iter().chain(turned.clone()).collect(), false).0];
        let motion = OwnMotion { wheels: [wheel(), wheel()], gyro: None };
        assert!((100..=101).contains(&motion.dead_reckoned(&default_robot()).len()));
    }

    #[test]
    fn wheels_of_a_side_are_averaged_and_must_all_be_known() {
        let wheel = |rad: f64, last_ms: f64| Series::of_wheel(vec![(0.0, 7.0), (last_ms, 7.0 + rad)], false).0;
        let motion = OwnMotion { wheels: [vec![wheel(1.0, 100.0), wheel(1.0, 50.0)], Vec::new()], gyro: None };
        assert_eq!(motion.angle_rad(0, [25.0, 0.0]), Some(0.375));
        assert_eq!((motion.angle_rad(0, [80.0, 0.0]), motion.angle_rad(1, [20.0, 0.0])), (None, None));
    }
}
