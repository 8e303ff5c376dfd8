//! Units of time, length and angle in which a track may be written.

use clap::ValueEnum;

/// Units of the columns whose names do not state one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Units {
    /// Of the time.
    pub time: Option<Time>,
    /// Of x and y.
    pub length: Option<Length>,
    /// Of the heading.
    pub angle: Option<Angle>,
}

/// A unit of time.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum Time {
    /// Seconds
    S,
    /// Milliseconds
    Ms,
    /// Microseconds
    Us,
}

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum Length {
    /// Metres
    M,
    /// Centimetres
    Cm,
    /// Millimetres
    Mm,
}

/// A unit of angle.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum Angle {
    /// Degrees
    Deg,
    /// Radians
    Rad,
}

impl Time {
    /// Milliseconds in one unit.
    pub fn ms(self) -> f64 {
        match self {
            Time::S => 1e3,
            Time::Ms => 1.0,
            Time::Us => 1e-3,
        }
    }
}

impl Length {
    /// Centimetres in one unit.
    pub fn cm(self) -> f64 {
        match self {
            Length::M => 100.0,
            Length::Cm => 1.0,
            Length::Mm => 0.1,
        }
    }
}

impl Angle {
    /// Radians in one unit.
    pub fn rad(self) -> f64 {
        match self {
            Angle::Deg => std::f64::consts::PI / 180.0,
            Angle::Rad => 1.0,
        }
    }
}
