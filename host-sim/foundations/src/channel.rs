//! The channels in which a simulator predicts a step.

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
}

impl Channel {
    /// Number of channels.
    pub const COUNT: usize = 5;

    /// All channels.
    pub const ALL: [Channel; Channel::COUNT] =
        [Channel::Forward, Channel::Lateral, Channel::Turn, Channel::EchoRate, Channel::EchoValue];

    /// The channels of a step's motion.
    pub const MOTION: [Channel; 3] = [Channel::Forward, Channel::Lateral, Channel::Turn];

    /// Returns its place in [`Channel::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// Returns its axis, for a channel of the motion.
    pub fn axis(self) -> Option<Axis> {
        match self {
            Channel::Forward => Some(Axis::Forward),
            Channel::Lateral => Some(Axis::Lateral),
            Channel::Turn => Some(Axis::Turn),
            Channel::EchoRate | Channel::EchoValue => None,
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
        }
    }
}

impl From<Axis> for Channel {
    fn from(axis: Axis) -> Self {
        Channel::MOTION[axis as usize]
    }
}
