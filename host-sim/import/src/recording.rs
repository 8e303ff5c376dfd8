//! A recording: the streams of one drive, each with stamps of its own, in centimetres, radians and milliseconds.

use std::path::{Path, PathBuf};

use super::frame::Frame;
use super::report::Source;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Robot;

/// The streams of one drive.
#[derive(Clone, Debug)]
pub struct Recording {
    /// What the robot was told to do.
    pub commands: Commands,
    /// Where it was seen; `None` where it was lost.
    pub poses: Vec<Option<Frame>>,
    /// The file that the poses are from.
    pub track: PathBuf,
    /// What its range sensor read, if it has one.
    pub readings: Option<Readings>,
    /// Whether one clock stamped all of it for certain.
    pub has_one_clock: bool,
    /// What was read, for the report.
    pub sources: Vec<Source>,
}

/// What a robot was told to do: pairs of numbers, each held until the next.
#[derive(Clone, Debug)]
pub struct Commands {
    /// What the numbers mean.
    pub kind: Kind,
    /// Time, ms, and the pair, in order of time.
    pub samples: Vec<(f64, [f64; 2])>,
}

/// What a pair of numbers commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Speed ahead, cm/s, and turn rate to the left, rad/s.
    Twist,
    /// Speeds of the left and right wheel's rim, cm/s.
    WheelSpeeds,
    /// Angular speeds of the left and right wheel, rad/s.
    WheelRates,
    /// Left and right motor, -100 to 100.
    Motors,
}

/// Readings of a range sensor.
#[derive(Clone, Debug)]
pub struct Readings {
    /// Time, ms, and distance, cm; `None` where there was no echo.
    pub samples: Vec<(f64, Option<f64>)>,
    /// Whether they are stamped by the clock of the poses rather than that of the commands.
    pub on_clock_of_poses: bool,
}

/// Largest share of the commands that may ask for more than the full speed, at which wheels then turn.
const MOST_LIMITED: f64 = 0.05;
/// Speeds this little above full are rounding.
const ROUNDING: f64 = 1e-6;

impl Kind {
    /// Speeds of the left and right wheel's rim, cm/s.
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
    /// Leaves its readings out, since the robot is said to have no range sensor.
    pub fn leave_readings_out(&mut self) {
        if let (Some(_), Some(source)) = (self.readings.take(), self.sources.last_mut()) {
            source.left_out.push("all readings, since robot.toml has no [ultrasonic]".into());
        }
    }
}

impl Commands {
    /// The same as commands of the motors, -100 to 100, and how many were beyond what the robot can do.
    ///
    /// # Errors
    /// When many ask for more than the robot's full speed.
    pub fn of_motors(&self, robot: &Robot, file: &Path) -> Result<(Commands, usize)> {
        let mut most_cm_s: f64 = 0.0;
        let mut limited = 0;
        let samples = self.samples.iter().map(|(t_ms, pair)| {
            let wheels_cm_s = self.kind.wheels_cm_s(*pair, robot);
            let fastest_cm_s = wheels_cm_s[0].abs().max(wheels_cm_s[1].abs());
            most_cm_s = most_cm_s.max(fastest_cm_s);
            limited += usize::from(fastest_cm_s > robot.full_speed_cm_s * (1.0 + ROUNDING));
            (*t_ms, wheels_cm_s.map(|cm_s| (100.0 * cm_s / robot.full_speed_cm_s).clamp(-100.0, 100.0)))
        });
        let commands = Commands { kind: Kind::Motors, samples: samples.collect() };
        if limited as f64 > MOST_LIMITED * self.samples.len() as f64 {
            let what = format!(
                "{limited} of {} commands ask a wheel for up to {most_cm_s:.1} cm/s, and robot.toml has full_speed_cm_s = {}: \
                 correct that, or the unit of the commands",
                self.samples.len(),
                robot.full_speed_cm_s
            );
            return Err(Error::in_file(file, what));
        }
        Ok((commands, limited))
    }

    /// The mean of what is held between two times, the first of which is not before the first command.
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
    /// The last reading at a time, unless it is older than `most_ms`.
    pub fn at(&self, t_ms: f64, most_ms: f64) -> Option<f64> {
        let (read_ms, cm) = self.samples.get(self.samples.partition_point(|(ms, _)| *ms <= t_ms).checked_sub(1)?)?;
        cm.filter(|_| t_ms - read_ms < most_ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::default_robot;

    fn robot() -> Robot {
        Robot { track_cm: 20.0, full_speed_cm_s: 50.0, wheel_diameter_cm: 10.0, ..default_robot() }
    }

    fn of_motors(kind: Kind, pair: [f64; 2]) -> Result<[f64; 2]> {
        let commands = Commands { kind, samples: vec![(0.0, pair)] };
        commands.of_motors(&robot(), Path::new("c.csv")).map(|(commands, _)| commands.samples[0].1)
    }

    #[test]
    fn every_kind_becomes_commands_of_motors() {
        assert_eq!(of_motors(Kind::Twist, [30.0, 1.0]).expect("slow"), [40.0, 80.0]);
        assert_eq!(of_motors(Kind::WheelSpeeds, [10.0, -20.0]).expect("slow"), [20.0, -40.0]);
        assert_eq!(of_motors(Kind::WheelRates, [2.0, -4.0]).expect("slow"), [20.0, -40.0]);
        assert_eq!(of_motors(Kind::Motors, [50.0, -100.0]).expect("slow"), [50.0, -100.0]);
    }

    #[test]
    fn more_than_full_speed_is_refused() {
        let error = of_motors(Kind::WheelSpeeds, [10.0, 60.0]).expect_err("too fast").to_string();
        assert!(error.contains("60.0 cm/s, and robot.toml has full_speed_cm_s = 50"), "{error}");
    }

    #[test]
    fn what_is_held_counts_by_its_time() {
        let commands = Commands { kind: Kind::Motors, samples: vec![(0.0, [0.0, 8.0]), (30.0, [40.0, 8.0])] };
        assert_eq!(commands.mean(0.0, 40.0), [10.0, 8.0]);
        assert_eq!(commands.mean(100.0, 140.0), [40.0, 8.0]);
    }
}
