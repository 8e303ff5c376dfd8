//! `robot.toml`: what the builder measured of the robot.

use std::path::Path;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::files;
use crate::geometry::Pose;
use crate::problem::{Problem, Result};

/// A differential-drive robot with one ultrasonic sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// Diameter of the driven wheels.
    pub wheel_diameter_cm: f64,
    /// Distance between the wheels' middles.
    pub track_cm: f64,
    /// The robot crashes when a disc of this radius round the axle's middle touches a wall or an obstacle.
    pub body_radius_cm: f64,
    /// Time between two rows of a log.
    pub step_ms: f64,
    /// Speed of a wheel's rim at command 100 with a fresh battery.
    pub full_speed_cm_s: f64,
    /// The sensor.
    pub ultrasonic: Ultrasonic,
}

/// Where the sensor sits on the robot, and what it can report.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ultrasonic {
    /// Ahead of the axle's middle.
    pub x_cm: f64,
    /// To its left.
    pub y_cm: f64,
    /// Axis of the sensor, counter-clockwise from straight ahead.
    pub yaw_deg: f64,
    /// Least reading.
    pub min_cm: f64,
    /// Largest reading.
    pub max_cm: f64,
}

impl Robot {
    /// Reads `robot.toml`.
    ///
    /// # Errors
    /// When the file is missing, broken, or holds a length, speed or time that cannot be.
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
            return Err(Problem::in_file(path, format!("{name} = {value} must lie between 0 and 100000")));
        }
        let finite = [sonar.x_cm, sonar.y_cm, sonar.yaw_deg].iter().all(|v| v.abs() < 1e5);
        if !finite || !(0.0..sonar.max_cm).contains(&sonar.min_cm) {
            return Err(Problem::in_file(path, "[ultrasonic] needs finite numbers and 0 <= min_cm < max_cm"));
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
    /// Where the sensor is, and which way its axis points, on a robot at `robot`.
    pub fn pose_on(&self, robot: &Pose) -> Pose {
        robot.compose(&Pose { position_cm: DVec2::new(self.x_cm, self.y_cm), heading_rad: self.yaw_deg.to_radians() })
    }
}
