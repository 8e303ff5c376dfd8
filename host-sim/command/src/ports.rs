//! Ports of the motors and the sensor on a brick.

use clap::Args;
use mindgap_controller_export::wiring::{MotorPort, SensorPort, Wiring};

/// The port options of commands that write or run a brick's program.
#[derive(Args)]
pub struct PortOptions {
    /// Port of the left motor.
    #[arg(long, default_value = "B")]
    left: MotorPort,
    /// Port of the right motor.
    #[arg(long, default_value = "C")]
    right: MotorPort,
    /// Port of the ultrasonic sensor.
    #[arg(long, default_value = "4")]
    sonar: SensorPort,
}

impl PortOptions {
    /// Returns the wiring.
    pub fn wiring(&self) -> Wiring {
        Wiring { left: self.left, right: self.right, sonar: self.sonar }
    }
}
