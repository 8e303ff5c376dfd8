//! The five things that a simulator predicts of a step.

use serde::{Deserialize, Serialize};

/// What a gap can lie in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// The way forward.
    Forward,
    /// The way to the left.
    Lateral,
    /// The turn.
    Turn,
    /// Whether there is an echo.
    EchoRate,
    /// The reading.
    EchoValue,
}

impl Channel {
    /// All of them.
    pub const ALL: [Channel; 5] =
        [Channel::Forward, Channel::Lateral, Channel::Turn, Channel::EchoRate, Channel::EchoValue];

    /// Those of a step's motion.
    pub const MOTION: [Channel; 3] = [Channel::Forward, Channel::Lateral, Channel::Turn];

    /// Its place among all.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Its place among forward, lateral and turn.
    pub fn motion_axis(self) -> Option<usize> {
        Self::MOTION.iter().position(|c| *c == self)
    }

    /// Its name in a diagnosis.
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
