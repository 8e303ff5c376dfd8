//! Assignment of motors and sensor to the ports of the brick.

use std::fmt;
use std::str::FromStr;

use crate::error::ExportError;

/// The ports of motors and ultrasonic sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wiring {
    /// The left motor.
    pub left: MotorPort,
    /// The right motor.
    pub right: MotorPort,
    /// The ultrasonic sensor.
    pub sonar: SensorPort,
}

/// An output of the brick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorPort {
    /// Port A.
    A,
    /// Port B.
    B,
    /// Port C.
    C,
}

/// An input of the brick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorPort {
    /// Port 1.
    One,
    /// Port 2.
    Two,
    /// Port 3.
    Three,
    /// Port 4.
    Four,
}

impl Default for Wiring {
    /// Left motor on B, right motor on C, ultrasonic sensor on 4.
    fn default() -> Self {
        Wiring { left: MotorPort::B, right: MotorPort::C, sonar: SensorPort::Four }
    }
}

impl Wiring {
    /// Checks that the motors have a port each.
    ///
    /// # Errors
    /// [`ExportError::OnePortForTwoMotors`].
    pub fn check(&self) -> Result<(), ExportError> {
        if self.left == self.right {
            return Err(ExportError::OnePortForTwoMotors(self.left.letter()));
        }
        Ok(())
    }
}

impl MotorPort {
    fn letter(self) -> char {
        match self {
            MotorPort::A => 'A',
            MotorPort::B => 'B',
            MotorPort::C => 'C',
        }
    }
}

impl FromStr for MotorPort {
    type Err = ExportError;

    fn from_str(port: &str) -> Result<Self, ExportError> {
        match port {
            "A" | "a" => Ok(MotorPort::A),
            "B" | "b" => Ok(MotorPort::B),
            "C" | "c" => Ok(MotorPort::C),
            _ => Err(ExportError::NoSuchPort { port: port.to_owned(), kind: "motor", has: "A, B and C" }),
        }
    }
}

impl FromStr for SensorPort {
    type Err = ExportError;

    fn from_str(port: &str) -> Result<Self, ExportError> {
        match port {
            "1" => Ok(SensorPort::One),
            "2" => Ok(SensorPort::Two),
            "3" => Ok(SensorPort::Three),
            "4" => Ok(SensorPort::Four),
            _ => Err(ExportError::NoSuchPort { port: port.to_owned(), kind: "sensor", has: "1, 2, 3 and 4" }),
        }
    }
}

impl fmt::Display for MotorPort {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}", self.letter())
    }
}

impl fmt::Display for SensorPort {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}", *self as u8 + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_read_back_as_they_print() {
        for port in ["A", "B", "C"] {
            assert_eq!(port.parse::<MotorPort>().unwrap().to_string(), port);
        }
        for port in ["1", "2", "3", "4"] {
            assert_eq!(port.parse::<SensorPort>().unwrap().to_string(), port);
        }
        assert_eq!(
            "5".parse::<SensorPort>().unwrap_err().to_string(),
            "\"5\" is no sensor port; the brick has 1, 2, 3 and 4"
        );
    }
}
