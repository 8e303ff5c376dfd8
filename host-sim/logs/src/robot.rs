//! `robot.toml`: the robot as measured by its builder (docs/reference/formats.md).

use std::path::Path;

use glam::DVec2;
use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::columns::{COLUMNS, REQUIRED, REQUIRED_WITHOUT_SENSOR};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// A differential-drive robot with one ultrasonic sensor or none.
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
    /// The ultrasonic sensor, if it has one.
    #[serde(default, deserialize_with = "possible_sensor", skip_serializing_if = "Option::is_none")]
    pub ultrasonic: Option<Ultrasonic>,
}

/// Mounting and range of the ultrasonic sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ultrasonic {
    /// Distance ahead of the centre of the axle, cm.
    pub x_cm: f64,
    /// Distance to the left of the centre of the axle, cm.
    pub y_cm: f64,
    /// Direction of its axis, degrees counter-clockwise from straight ahead.
    pub yaw_deg: f64,
    /// Smallest reading, cm.
    pub min_cm: f64,
    /// Largest reading, cm.
    pub max_cm: f64,
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
        let robot: Robot = files::from_toml(path, text)?;
        let positive = [
            ("wheel_diameter_cm", robot.wheel_diameter_cm),
            ("track_cm", robot.track_cm),
            ("body_radius_cm", robot.body_radius_cm),
            ("step_ms", robot.step_ms),
            ("full_speed_cm_s", robot.full_speed_cm_s),
        ];
        if let Some((name, value)) = positive.iter().find(|(_, v)| !(*v > 0.0 && *v < 1e5)) {
            return Err(Error::in_file(path, format!("{name} = {value} must lie between 0 and 100000")));
        }
        Ok(robot)
    }

    /// Returns the pose of the sensor on the robot at `pose`; of a robot without one, `pose`.
    pub fn sensor_pose(&self, pose: &Pose) -> Pose {
        self.ultrasonic.map_or(*pose, |sensor| sensor.pose_on(pose))
    }

    /// Returns the columns that its runs must have.
    pub fn required_columns(&self) -> &'static [&'static str] {
        &COLUMNS[..if self.ultrasonic.is_none() { REQUIRED_WITHOUT_SENSOR } else { REQUIRED }]
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
        toml::to_string(self).expect("numbers have a TOML form")
    }
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

impl Ultrasonic {
    fn is_possible(&self) -> bool {
        let is_within = [self.x_cm, self.y_cm, self.yaw_deg, self.max_cm].iter().all(|v| v.abs() < 1e5);
        is_within && (0.0..self.max_cm).contains(&self.min_cm)
    }

    /// Its least and its largest reading, cm.
    pub fn range_cm(&self) -> [f64; 2] {
        [self.min_cm, self.max_cm]
    }

    /// Returns the pose of the sensor on a robot at `robot`; its heading is the direction of the axis.
    pub fn pose_on(&self, robot: &Pose) -> Pose {
        robot.compose(&Pose { position_cm: DVec2::new(self.x_cm, self.y_cm), heading_rad: self.yaw_deg.to_radians() })
    }
}

/// Two people who measure one robot agree to this share.
const SAME: f64 = 0.02;

/// Checks that logs are of the robot that the simulator was learned from.
///
/// # Errors
/// Names the first measurement that differs.
pub fn same_robot(simulator: &Robot, logs: &Robot) -> Result<()> {
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
    let (mut ours, mut theirs) = (body(simulator), body(logs));
    // The mounting of a sensor is compared where both have one.
    if let (Some(a), Some(b)) = (&simulator.ultrasonic, &logs.ultrasonic) {
        ours.extend(mount(a));
        theirs.extend(mount(b));
    }
    match ours.into_iter().zip(theirs).find(|((_, a), (_, b))| (a - b).abs() > SAME * a.abs().max(1.0)) {
        Some(((name, a), (_, b))) => Err(Error::new(format!(
            "these are logs of another robot than the simulator's: {name} is {b} in the logs' robot.toml and {a} in the simulator; \
             mend robot.toml, or train a simulator of this robot"
        ))),
        None => Ok(()),
    }
}
