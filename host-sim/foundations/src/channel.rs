//! The channels in which a simulator predicts a step, and those in which a robot measures itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::motion::Axis;

/// What a gap can lie in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Distance forward.
    Forward,
    /// Distance to the left.
    Lateral,
    /// Turn.
    Turn,
    /// Whether there is an echo.
    EchoRate,
    /// The reading.
    EchoValue,
    /// How far the left wheel turns, by its rotation counter.
    RotLeft,
    /// How far the right wheel turns, by its rotation counter.
    RotRight,
    /// The yaw rate, by the gyro.
    Gyro,
}

impl Channel {
    /// Number of channels.
    pub const COUNT: usize = 8;

    /// All channels.
    pub const ALL: [Channel; Channel::COUNT] = [
        Channel::Forward,
        Channel::Lateral,
        Channel::Turn,
        Channel::EchoRate,
        Channel::EchoValue,
        Channel::RotLeft,
        Channel::RotRight,
        Channel::Gyro,
    ];

    /// The channels that simulated runs have: those that a gap can lie in.
    pub const SIMULATED: [Channel; 5] =
        [Channel::Forward, Channel::Lateral, Channel::Turn, Channel::EchoRate, Channel::EchoValue];

    /// The channels of a step's motion.
    pub const MOTION: [Channel; 3] = [Channel::Forward, Channel::Lateral, Channel::Turn];

    /// The channels of the range sensor.
    pub const SONAR: [Channel; 2] = [Channel::EchoRate, Channel::EchoValue];

    /// The witnesses: what the robot measures of its own motion. They show where in the robot a cause sits.
    pub const WITNESSES: [Channel; 3] = [Channel::RotLeft, Channel::RotRight, Channel::Gyro];

    /// Returns its place in [`Channel::ALL`]; that of a simulated one in [`Channel::SIMULATED`] is the same.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Returns its axis, for a channel of the motion.
    pub fn axis(self) -> Option<Axis> {
        match self {
            Channel::Forward => Some(Axis::Forward),
            Channel::Lateral => Some(Axis::Lateral),
            Channel::Turn => Some(Axis::Turn),
            _ => None,
        }
    }

    /// Returns the place of its axis in [`Axis::ALL`].
    pub fn motion_axis(self) -> Option<usize> {
        self.axis().map(|axis| axis as usize)
    }

    /// Returns its name in a diagnosis.
    pub fn name(self) -> &'static str {
        match self {
            Channel::Forward => "forward",
            Channel::Lateral => "lateral",
            Channel::Turn => "turn",
            Channel::EchoRate => "echo_rate",
            Channel::EchoValue => "echo_value",
            Channel::RotLeft => "rot_left",
            Channel::RotRight => "rot_right",
            Channel::Gyro => "gyro",
        }
    }

    /// Returns the column of a witness; `None` for other channels, which come from several.
    pub fn column(self) -> Option<&'static str> {
        match self {
            Channel::RotLeft => Some("rot_left_deg"),
            Channel::RotRight => Some("rot_right_deg"),
            Channel::Gyro => Some("gyro_deg_s"),
            _ => None,
        }
    }
}

impl From<Axis> for Channel {
    fn from(axis: Axis) -> Self {
        Channel::MOTION[axis as usize]
    }
}
