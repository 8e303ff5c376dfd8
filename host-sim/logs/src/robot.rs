//! `robot.toml`: the robot as measured by its builder (docs/reference/formats.md).

use std::path::Path;

use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use toml::Spanned;

use super::columns::{COLUMNS, REQUIRED, REQUIRED_WITHOUT_SENSOR};
use super::range_sensor::{RangeSensor, Sensors};
use super::ultrasonic::Ultrasonic;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// A differential-drive robot with one range sensor or none; of several it has the first, and [`Sensors`] has the others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// Diameter of the driven wheels, cm.
    pub wheel_diameter_cm: f64,
    /// Distance between the wheel centres, cm.
    pub track_cm: f64,
    /// Radius of the disc around the centre of the axle that must not touch a wall or an obstacle, cm.
    pub body_radius_cm: f64,
    /// Nominal time between two rows of a log, ms.
    pub step_ms: f64,
    /// Speed of a wheel's rim at command 100 with a fresh battery, cm/s.
    pub full_speed_cm_s: f64,
    /// The range sensor, if it has one: `[ultrasonic]`, or the first `[[range_sensor]]` where there is none.
    #[serde(default, deserialize_with = "possible_sensor", skip_serializing_if = "Option::is_none")]
    pub ultrasonic: Option<Ultrasonic>,
}

impl Robot {
    /// Reads `robot.toml`.
    ///
    /// # Errors
    /// When the file cannot be read or parsed, or holds an impossible length, speed or time.
    pub fn read(path: &Path) -> Result<Self> {
        Robot::parse(path, &files::read_text(path)?)
    }

    /// Parses the text of `robot.toml`; `path` is for messages.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        Ok(Robot::parse_all(path, text)?.0)
    }

    /// Reads `robot.toml` with all its range sensors.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn read_all(path: &Path) -> Result<(Self, Sensors)> {
        Robot::parse_all(path, &files::read_text(path)?)
    }

    /// Parses the text of `robot.toml` with all its range sensors; `path` is for messages.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn parse_all(path: &Path, text: &str) -> Result<(Self, Sensors)> {
        let parsed = files::from_toml(path, text);
        let is_scene = || ["[arena]", "[[obstacle]]", "[[wall]]", "[[start]]"].iter().any(|table| text.contains(table));
        let file: RobotFile<Spanned<RangeSensor>> = parsed.map_err(|error| match is_scene() {
            true => Error::in_file(path, "is a scene, not a robot: are --robot and --scene exchanged?"),
            false => error,
        })?;
        let (ultrasonic, sensors) = Sensors::of_file(path, text, file.ultrasonic, file.range_sensor)?;
        let robot = Robot {
            wheel_diameter_cm: file.wheel_diameter_cm,
            track_cm: file.track_cm,
            body_radius_cm: file.body_radius_cm,
            step_ms: file.step_ms,
            full_speed_cm_s: file.full_speed_cm_s,
            ultrasonic,
        };
        robot.check().map_err(|why| Error::in_file(path, why))?;
        Ok((robot, sensors))
    }

    /// Checks that the numbers are those of a possible robot.
    ///
    /// # Errors
    /// Names the first number that is not.
    pub fn check(&self) -> std::result::Result<(), String> {
        let numbers = [
            ("wheel_diameter_cm", self.wheel_diameter_cm),
            ("track_cm", self.track_cm),
            ("body_radius_cm", self.body_radius_cm),
            ("step_ms", self.step_ms),
            ("full_speed_cm_s", self.full_speed_cm_s),
        ];
        match numbers.iter().find(|(_, number)| !POSSIBLE.contains(number)) {
            Some((name, value)) => {
                Err(format!("{name} = {value} must lie between {} and {}", POSSIBLE.start(), POSSIBLE.end()))
            }
            None => Ok(()),
        }
    }

    /// Returns the pose of the sensor on the robot at `pose`; of a robot without one, `pose`.
    pub fn sensor_pose(&self, pose: &Pose) -> Pose {
        self.ultrasonic.map_or(*pose, |sensor| sensor.pose_on(pose))
    }

    /// Returns the columns that its runs must have. What a `[[range_sensor]]` makes necessary is none: the others can be compared.
    pub fn required_columns(&self, sensors: &Sensors) -> &'static [&'static str] {
        let needs_echoes = self.ultrasonic.is_some() && sensors.are_usual();
        &COLUMNS[..if needs_echoes { REQUIRED } else { REQUIRED_WITHOUT_SENSOR }]
    }

    /// Writes `robot.toml`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        files::write(path, self.to_text())
    }

    /// Returns the text of `robot.toml`.
    pub fn to_text(&self) -> String {
        self.to_text_with(&Sensors::default())
    }

    /// Returns the text of `robot.toml` with all these range sensors.
    pub fn to_text_with(&self, sensors: &Sensors) -> String {
        let (ultrasonic, range_sensor) = sensors.tables(self.ultrasonic);
        let file = RobotFile {
            wheel_diameter_cm: self.wheel_diameter_cm,
            track_cm: self.track_cm,
            body_radius_cm: self.body_radius_cm,
            step_ms: self.step_ms,
            full_speed_cm_s: self.full_speed_cm_s,
            ultrasonic,
            range_sensor,
        };
        toml::to_string(&file).expect("numbers and names have a TOML form")
    }
}

/// The tables of `robot.toml`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotFile<T> {
    wheel_diameter_cm: f64,
    track_cm: f64,
    body_radius_cm: f64,
    step_ms: f64,
    full_speed_cm_s: f64,
    #[serde(default, deserialize_with = "possible_sensor", skip_serializing_if = "Option::is_none")]
    ultrasonic: Option<Ultrasonic>,
    #[serde(default = "Vec::new", skip_serializing_if = "Vec::is_empty")]
    range_sensor: Vec<T>,
}

/// Reads a sensor whose numbers are possible.
fn possible_sensor<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<Option<Ultrasonic>, D::Error> {
    let sensor = Ultrasonic::deserialize(from)?;
    if sensor.is_possible() {
        Ok(Some(sensor))
    } else {
        Err(D::Error::custom("[ultrasonic] needs numbers within 100000 and 0 <= min_cm < max_cm"))
    }
}

/// Numbers of possible robots, in cm, ms and cm/s. Products and quotients of these do not overflow.
const POSSIBLE: std::ops::RangeInclusive<f64> = 1e-3..=1e5;
/// Two people who measure one robot agree to this share.
const SAME: f64 = 0.02;

/// Checks that logs are of the robot that the simulator was learned from.
///
/// # Errors
/// Names the first measurement that differs.
pub fn same_robot(simulator: &Robot, logs: &Robot) -> Result<()> {
    match first_difference(simulator, logs) {
        Some((name, [a, b])) => Err(Error::new(format!(
            "these are logs of another robot than the simulator's: {name} is {b} in the logs' robot.toml and {a} in the simulator; \
             mend robot.toml, or train a simulator of this robot"
        ))),
        None => Ok(()),
    }
}

/// Returns the first measurement in which two robots differ, with both values. The mounting of a sensor is compared where both
/// have one.
pub fn first_difference(one: &Robot, other: &Robot) -> Option<(&'static str, [f64; 2])> {
    let body = |r: &Robot| {
        vec![
            ("step_ms", r.step_ms),
            ("wheel_diameter_cm", r.wheel_diameter_cm),
            ("track_cm", r.track_cm),
            ("full_speed_cm_s", r.full_speed_cm_s),
        ]
    };
    let mount =
        |s: &Ultrasonic| [("ultrasonic.x_cm", s.x_cm), ("ultrasonic.y_cm", s.y_cm), ("ultrasonic.yaw_deg", s.yaw_deg)];
    let (mut ours, mut theirs) = (body(one), body(other));
    if let (Some(a), Some(b)) = (&one.ultrasonic, &other.ultrasonic) {
        ours.extend(mount(a));
        theirs.extend(mount(b));
    }
    let mut pairs = ours.into_iter().zip(theirs).map(|((name, a), (_, b))| (name, [a, b]));
    pairs.find(|(_, [a, b])| (a - b).abs() > SAME * a.abs().max(1.0))
}
