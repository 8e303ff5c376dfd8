//! Units of time, length and angle in recordings.

use std::str::FromStr;

/// Units of columns whose names do not state one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Units {
    /// Unit of the time.
    pub time: Option<Time>,
    /// Unit of x and y.
    pub length: Option<Length>,
    /// Unit of the heading.
    pub angle: Option<Angle>,
}

/// A unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Time {
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
}

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// Metres.
    M,
    /// Centimetres.
    Cm,
    /// Millimetres.
    Mm,
}

/// A unit of angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Angle {
    /// Degrees.
    Deg,
    /// Radians.
    Rad,
}

impl Time {
    /// Returns the milliseconds in one unit.
    pub fn ms(self) -> f64 {
        match self {
            Time::S => 1e3,
            Time::Ms => 1.0,
            Time::Us => 1e-3,
        }
    }
}

impl Length {
    /// Returns the centimetres in one unit.
    pub fn cm(self) -> f64 {
        match self {
            Length::M => 100.0,
            Length::Cm => 1.0,
            Length::Mm => 0.1,
        }
    }
}

impl Angle {
    /// Returns the radians in one unit.
    pub fn rad(self) -> f64 {
        match self {
            Angle::Deg => std::f64::consts::PI / 180.0,
            Angle::Rad => 1.0,
        }
    }
}

impl FromStr for Time {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "s" => Ok(Time::S),
            "ms" => Ok(Time::Ms),
            "us" => Ok(Time::Us),
            _ => Err(format!("{name:?} is not a unit of time")),
        }
    }
}

impl FromStr for Length {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "m" => Ok(Length::M),
            "cm" => Ok(Length::Cm),
            "mm" => Ok(Length::Mm),
            _ => Err(format!("{name:?} is not a unit of length")),
        }
    }
}

impl FromStr for Angle {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "deg" => Ok(Angle::Deg),
            "rad" => Ok(Angle::Rad),
            _ => Err(format!("{name:?} is not a unit of angle")),
        }
    }
}
