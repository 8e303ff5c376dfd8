//! Recordings: the streams of one drive, each with its own timestamps, in centimetres, radians and milliseconds.

use std::path::{Path, PathBuf};

use super::frame::Frame;
use super::left_out::LeftOut;
use super::own_motion::OwnMotion;
use super::report::Source;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Robot;

/// The streams of one drive.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Commands to the robot.
    pub commands: Commands,
    /// Poses where the robot was seen; none if nobody tracked it.
    pub poses: Vec<Frame>,
    /// File of the poses, or of the commands if there are none.
    pub file: PathBuf,
    /// Readings of the range sensors that were heard, in the order of the sensors.
    pub readings: Vec<Readings>,
    /// What the robot measured of its own motion.
    pub own_motion: OwnMotion,
    /// Whether commands and poses, or what the robot measured of its motion if there are none, are known to share one clock.
    pub has_one_clock: bool,
    /// Sources, for the report.
    pub sources: Vec<Source>,
}

/// Commands to a robot: pairs of numbers, each held until the next.
#[derive(Clone, Debug)]
pub struct Commands {
    /// Meaning of the numbers.
    pub kind: Kind,
    /// Time, ms, and the pair, in temporal order.
    pub samples: Vec<(f64, [f64; 2])>,
}

/// The meaning of a pair of command numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Forward speed, cm/s, and turn rate to the left, rad/s.
    Twist,
    /// Speeds of the left and right wheel's rim, cm/s.
    WheelSpeeds,
    /// Angular speeds of the left and right wheel, rad/s.
    WheelRates,
    /// Left and right motor, -100 to 100.
    Motors,
}

/// Times, ms, and distances, cm; `None` if there was no echo.
pub type Echoes = Vec<(f64, Option<f64>)>;

/// Readings of a range sensor.
#[derive(Clone, Debug)]
pub struct Readings {
    /// Index of the sensor among those of the robot.
    pub sensor: usize,
    /// The readings, in temporal order.
    pub samples: Echoes,
    /// Whether they are on the clock of the poses rather than that of the commands.
    pub on_clock_of_poses: bool,
}

/// Maximum fraction of commands that may exceed full speed and are then saturated.
const MAX_SATURATED: f64 = 0.05;
/// Relative excess over full speed that counts as rounding.
const ROUNDING: f64 = 1e-6;

/// Numbers of values in a byte, and in a byte that is read as signed.
const BYTE: f64 = 256.0;
const SIGNED_BYTE: (f64, f64) = (-128.0, 127.0);
/// Fewer negative values stand for no echo.
const MIN_SIGNED: usize = 4;

impl Kind {
    /// Returns the rim speeds of the left and right wheel, cm/s.
    pub fn wheels_cm_s(self, [a, b]: [f64; 2], robot: &Robot) -> [f64; 2] {
        match self {
            Kind::Twist => [a - b * robot.track_cm / 2.0, a + b * robot.track_cm / 2.0],
            Kind::WheelSpeeds => [a, b],
            Kind::WheelRates => [a, b].map(|rad_s| rad_s * robot.wheel_diameter_cm / 2.0),
            Kind::Motors => [a, b].map(|command| command / 100.0 * robot.full_speed_cm_s),
        }
    }
}

impl Recording {
    /// Returns whether any pose was tracked.
    pub fn is_tracked(&self) -> bool {
        !self.poses.is_empty()
    }

    /// Corrects negative readings, and reports that.
    pub fn correct_signs(&mut self) {
        for readings in &mut self.readings {
            let (corrected, removed) = readings.correct_signs();
            if let Some(source) = self.sources.last_mut() {
                source.guessed.extend(corrected);
                source.unused.extend(removed);
            }
        }
    }

    /// Drops the readings of a robot without a range sensor.
    pub fn drop_readings(&mut self) {
        for readings in self.readings.drain(..) {
            let reason = "robot.toml has no [ultrasonic]";
            if let Some(source) = self.sources.last_mut() {
                source.unused.push(LeftOut::rows("reading", readings.samples.len(), reason));
            }
        }
    }
}

impl Readings {
    /// Corrects readings that a driver took for signed bytes, and removes other negative numbers; returns the correction, if
    /// any, and what was removed.
    pub fn correct_signs(&mut self) -> (Option<String>, Option<LeftOut>) {
        let mut negative: Vec<f64> = self.samples.iter().filter_map(|(_, cm)| cm.filter(|cm| *cm < 0.0)).collect();
        let count = negative.len();
        negative.sort_by(f64::total_cmp);
        negative.dedup();
        let is_byte = |cm: f64| (SIGNED_BYTE.0..=SIGNED_BYTE.1).contains(&cm) && (cm - cm.round()).abs() < 1e-3;
        let are_bytes = negative.len() >= MIN_SIGNED && self.samples.iter().filter_map(|(_, cm)| *cm).all(is_byte);
        let unsigned = |cm: f64| match cm {
            cm if cm >= 0.0 => Some(cm),
            cm if are_bytes => Some(cm + BYTE).filter(|cm| cm.round() < BYTE - 1.0),
            _ => None,
        };
        self.samples.iter_mut().for_each(|(_, cm)| *cm = cm.and_then(unsigned));
        if are_bytes {
            let what = format!(
                "{count} readings are negative, of {} values: a byte read as signed, so {BYTE} was added; -1 is 255, no echo",
                negative.len()
            );
            return (Some(what), None);
        }
        let what = if negative.len() < MIN_SIGNED { "no echo" } else { "not distances, and not bytes read as signed" };
        (
            None,
            (count > 0)
                .then(|| LeftOut::rows("negative reading", count, format!("of {} values: {what}", negative.len()))),
        )
    }
}

impl Commands {
    /// Converts to motor commands, -100 to 100, and returns how many were saturated.
    ///
    /// # Errors
    /// When many exceed the robot's full speed.
    pub fn as_motor_commands(&self, robot: &Robot, file: &Path) -> Result<(Commands, usize)> {
        let mut max_cm_s: f64 = 0.0;
        let mut saturated = 0;
        let samples = self.samples.iter().map(|(t_ms, pair)| {
            let wheels_cm_s = self.kind.wheels_cm_s(*pair, robot);
            let fastest_cm_s = wheels_cm_s[0].abs().max(wheels_cm_s[1].abs());
            max_cm_s = max_cm_s.max(fastest_cm_s);
            saturated += usize::from(fastest_cm_s > robot.full_speed_cm_s * (1.0 + ROUNDING));
            (*t_ms, wheels_cm_s.map(|cm_s| (100.0 * cm_s / robot.full_speed_cm_s).clamp(-100.0, 100.0)))
        });
        let commands = Commands { kind: Kind::Motors, samples: samples.collect() };
        if saturated as f64 > MAX_SATURATED * self.samples.len() as f64 {
            let what = format!(
                "{saturated} of {} commands require wheel speeds of up to {max_cm_s:.1} cm/s, but robot.toml has full_speed_cm_s = {}: \
                 correct it or the unit of the commands",
                self.samples.len(),
                robot.full_speed_cm_s
            );
            return Err(Error::in_file(file, what));
        }
        Ok((commands, saturated))
    }

    /// Returns the time-weighted mean command between two times, the first of which is not before the first command.
    pub fn mean(&self, from_ms: f64, to_ms: f64) -> [f64; 2] {
        let mut sum = [0.0; 2];
        let first = self.samples.partition_point(|(t_ms, _)| *t_ms <= from_ms).saturating_sub(1);
        let held = self.samples.iter().enumerate().skip(first).take_while(|(_, (t_ms, _))| *t_ms < to_ms);
        for (i, (t_ms, pair)) in held {
            let until_ms = self.samples.get(i + 1).map_or(to_ms, |(next_ms, _)| next_ms.min(to_ms));
            let ms = until_ms - t_ms.max(from_ms);
            sum = [sum[0] + ms * pair[0], sum[1] + ms * pair[1]];
        }
        sum.map(|s| s / (to_ms - from_ms))
    }
}

impl Readings {
    /// Returns the latest reading at a time on the clocks of commands and poses, unless it is older than `max_age_ms`.
    pub fn at(&self, [command_ms, pose_ms]: [f64; 2], max_age_ms: f64) -> Option<f64> {
        let t_ms = if self.on_clock_of_poses { pose_ms } else { command_ms };
        let (read_ms, cm) = self.samples.get(self.samples.partition_point(|(ms, _)| *ms <= t_ms).checked_sub(1)?)?;
        cm.filter(|_| t_ms - read_ms < max_age_ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::default_robot;

    fn robot() -> Robot {
        Robot { track_cm: 20.0, full_speed_cm_s: 50.0, wheel_diameter_cm: 10.0, ..default_robot() }
    }

    fn as_motor_commands(kind: Kind, pair: [f64; 2]) -> Result<[f64; 2]> {
        let commands = Commands { kind, samples: vec![(0.0, pair)] };
        commands.as_motor_commands(&robot(), Path::new("c.csv")).map(|(commands, _)| commands.samples[0].1)
    }

    #[test]
    fn every_kind_is_converted_to_motor_commands() {
        assert_eq!(as_motor_commands(Kind::Twist, [30.0, 1.0]).expect("slow"), [40.0, 80.0]);
        assert_eq!(as_motor_commands(Kind::WheelSpeeds, [10.0, -20.0]).expect("slow"), [20.0, -40.0]);
        assert_eq!(as_motor_commands(Kind::WheelRates, [2.0, -4.0]).expect("slow"), [20.0, -40.0]);
        assert_eq!(as_motor_commands(Kind::Motors, [50.0, -100.0]).expect("slow"), [50.0, -100.0]);
    }

    #[test]
    fn signed_bytes_are_corrected_and_other_negative_readings_reported() {
        let corrected = |numbers: &[f64]| {
            let samples = numbers.iter().map(|cm| (0.0, Some(*cm))).collect();
            let mut readings = Readings { sensor: 0, samples, on_clock_of_poses: false };
            let (corrected, removed) = readings.correct_signs();
            let cm: Vec<Option<f64>> = readings.samples.iter().map(|(_, cm)| *cm).collect();
            (cm, corrected, removed)
        };
        let (cm, what, removed) = corrected(&[100.0, 127.0, -128.0, -116.0, -60.0, -1.0]);
        assert_eq!(cm, [Some(100.0), Some(127.0), Some(128.0), Some(140.0), Some(196.0), None]);
        assert!(what.expect("corrected").contains("a byte read as signed") && removed.is_none());
        let (cm, what, removed) = corrected(&[100.0, 230.0, -1.0, -1.0]);
        assert_eq!((cm, what), (vec![Some(100.0), Some(230.0), None, None], None));
        assert_eq!(removed.and_then(|removed| removed.rows), Some(2));
        let (cm, what, removed) = corrected(&[30.5, -1.5, -2.5, -3.5, -4.5]);
        assert_eq!((cm[1], what), (None, None));
        assert!(removed.expect("reported").reason.contains("not bytes read as signed"));
    }

    #[test]
    fn commands_above_full_speed_are_rejected() {
        let error = as_motor_commands(Kind::WheelSpeeds, [10.0, 60.0]).expect_err("too fast").to_string();
        assert!(error.contains("60.0 cm/s, but robot.toml has full_speed_cm_s = 50"), "{error}");
    }

    #[test]
    fn mean_is_weighted_by_duration() {
        let commands = Commands { kind: Kind::Motors, samples: vec![(0.0, [0.0, 8.0]), (30.0, [40.0, 8.0])] };
        assert_eq!(commands.mean(0.0, 40.0), [10.0, 8.0]);
        assert_eq!(commands.mean(100.0, 140.0), [40.0, 8.0]);
    }
}
