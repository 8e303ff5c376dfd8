//! The five quantities that a simulator predicts per step.

use serde::{Deserialize, Serialize};

/// A quantity in which a gap can lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Forward motion.
    Forward,
    /// Motion to the left.
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

    /// Returns its index in [`Channel::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// Returns its index in [`Channel::MOTION`], or `None` for a channel of the sonar.
    pub fn motion_axis(self) -> Option<usize> {
        Self::MOTION.iter().position(|c| *c == self)
    }

    /// Returns its name in diagnosis.json.
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
