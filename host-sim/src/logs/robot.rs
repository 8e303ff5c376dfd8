//! `robot.toml`: the robot as measured by its builder (docs/formats.md).

use std::path::Path;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::files;
use crate::geometry::Pose;

/// A differential-drive robot with one ultrasonic sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    /// The ultrasonic sensor.
    pub ultrasonic: Ultrasonic,
}

/// Mounting and range of the ultrasonic sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
        let robot: Robot = files::read_toml(path)?;
        let sonar = &robot.ultrasonic;
        let positive = [
            ("wheel_diameter_cm", robot.wheel_diameter_cm),
            ("track_cm", robot.track_cm),
            ("body_radius_cm", robot.body_radius_cm),
            ("step_ms", robot.step_ms),
            ("full_speed_cm_s", robot.full_speed_cm_s),
            ("ultrasonic.max_cm", sonar.max_cm),
        ];
        if let Some((name, value)) = positive.iter().find(|(_, v)| !(*v > 0.0 && *v < 1e5)) {
            return Err(Error::in_file(path, format!("{name} = {value} must lie between 0 and 100000")));
        }
        let finite = [sonar.x_cm, sonar.y_cm, sonar.yaw_deg].iter().all(|v| v.abs() < 1e5);
        if !finite || !(0.0..sonar.max_cm).contains(&sonar.min_cm) {
            return Err(Error::in_file(path, "[ultrasonic] needs finite numbers and 0 <= min_cm < max_cm"));
        }
        Ok(robot)
    }

    /// Writes `robot.toml`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = toml::to_string(self).expect("numbers have a TOML form");
        files::write(path, text)
    }
}

impl Ultrasonic {
    /// The pose of the sensor on a robot at `robot`; its heading is that of the axis.
    pub fn pose_on(&self, robot: &Pose) -> Pose {
        robot.compose(&Pose { position_cm: DVec2::new(self.x_cm, self.y_cm), heading_rad: self.yaw_deg.to_radians() })
    }
}
