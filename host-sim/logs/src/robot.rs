//! `robot.toml`: the robot as measured by its builder (docs/formats.md).

use std::path::Path;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::columns::{COLUMNS, REQUIRED, REQUIRED_WITHOUT_SENSOR};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// A differential-drive robot with one ultrasonic sensor or none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// Diameter of the driven wheels, cm.
    pub wheel_diameter_cm: f64,
    /// Distance between the middles of the wheels, cm.
    pub track_cm: f64,
    /// Radius of the disc round the axle's middle that must not touch a wall or an obstacle, cm.
    pub body_radius_cm: f64,
    /// Nominal time between two rows of a log, ms.
    pub step_ms: f64,
    /// Speed of a wheel's rim at command 100 with a fresh battery, cm/s.
    pub full_speed_cm_s: f64,
    /// The ultrasonic sensor; [`Ultrasonic::NONE`] where there is none.
    #[serde(default = "Ultrasonic::none", skip_serializing_if = "Ultrasonic::is_none")]
    pub ultrasonic: Ultrasonic,
}

/// Mounting and range of the ultrasonic sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ultrasonic {
    /// Distance ahead of the axle's middle, cm.
    pub x_cm: f64,
    /// Distance to the left of the axle's middle, cm.
    pub y_cm: f64,
    /// Direction of its axis, degrees counter-clockwise from straight ahead.
    pub yaw_deg: f64,
    /// Least reading, cm.
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

    /// The robot that a text says; `path` is for messages.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let robot: Robot = files::from_toml(path, text)?;
        let sonar = &robot.ultrasonic;
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
        let is_within = [sonar.x_cm, sonar.y_cm, sonar.yaw_deg, sonar.max_cm].iter().all(|v| v.abs() < 1e5);
        let is_possible = is_within && (0.0..sonar.max_cm).contains(&sonar.min_cm);
        if !(sonar.is_none() || is_possible) {
            return Err(Error::in_file(path, "[ultrasonic] needs numbers within 100000 and 0 <= min_cm < max_cm"));
        }
        Ok(robot)
    }

    /// The columns that its runs must have.
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

    /// The text of `robot.toml`.
    pub fn to_text(&self) -> String {
        toml::to_string(self).expect("numbers have a TOML form")
    }
}

impl Ultrasonic {
    /// What a robot without such a sensor has: one that reaches nowhere.
    pub const NONE: Ultrasonic = Ultrasonic { x_cm: 0.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 0.0, max_cm: 0.0 };

    /// Whether there is no sensor.
    pub fn is_none(&self) -> bool {
        *self == Ultrasonic::NONE
    }

    fn none() -> Self {
        Ultrasonic::NONE
    }

    /// The pose of the sensor on a robot at `robot`; its heading is that of the axis.
    pub fn pose_on(&self, robot: &Pose) -> Pose {
        robot.compose(&Pose { position_cm: DVec2::new(self.x_cm, self.y_cm), heading_rad: self.yaw_deg.to_radians() })
    }
}
