//! Assignment of motors and sensor to the ports of the brick.

use std::fmt;
use std::str::FromStr;

use crate::error::ExportError;

/// The ports of the motors and the ultrasonic sensor.
///
/// ```
/// use mindgap_controller_export::wiring::{MotorPort, Wiring};
///
/// let wiring = Wiring { left: MotorPort::A, ..Wiring::default() };
/// assert!(wiring.check().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wiring {
    /// The left motor.
    pub left: MotorPort,
    /// The right motor.
    pub right: MotorPort,
    /// The ultrasonic sensor.
    pub sonar: SensorPort,
}

/// A motor port of the brick.
///
/// ```
/// use mindgap_controller_export::wiring::MotorPort;
///
/// assert_eq!("b".parse(), Ok(MotorPort::B));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorPort {
    /// Port A.
    A,
    /// Port B.
    B,
    /// Port C.
    C,
}

/// A sensor port of the brick.
///
/// ```
/// use mindgap_controller_export::wiring::SensorPort;
///
/// assert_eq!(SensorPort::Four.to_string(), "4");
/// ```
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
    /// Returns the usual ports: left motor on B, right motor on C, ultrasonic sensor on 4.
    fn default() -> Self {
        Wiring { left: MotorPort::B, right: MotorPort::C, sonar: SensorPort::Four }
    }
}

impl Wiring {
    /// Checks that each motor has its own port.
    ///
    /// # Errors
    /// Returns [`ExportError::OnePortForTwoMotors`] when both are on one port.
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
    fn ports_parse_from_their_own_text() {
        for port in ["A", "B", "C"] {
            assert_eq!(port.parse::<MotorPort>().unwrap().to_string(), port);
        }
        for port in ["1", "2", "3", "4"] {
            assert_eq!(port.parse::<SensorPort>().unwrap().to_string(), port);
        }
        assert_eq!(
            "5".parse::<SensorPort>().unwrap_err().to_string(),
            "\"5\" is not a sensor port; the brick has 1, 2, 3 and 4"
        );
    }
}
