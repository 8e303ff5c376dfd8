//! How large a robot's commands are. They are percent of full speed for one robot, cm/s for another and duty cycles of 255
//! for a third; where friction bends what wheels do, and how fine commands differ, goes by what the robot can drive.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the largest command of training logs is taken for: they leave some of full speed out, as those of `mindgap record` do.
const LARGEST_PERCENT: f64 = 80.0;

/// Commands in percent of full speed, left and right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Percent(pub [f64; 2]);

/// The factor that makes percent of a robot's commands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CommandScale(f64);

impl Default for CommandScale {
    fn default() -> Self {
        CommandScale::PERCENT
    }
}

impl CommandScale {
    /// Of robots whose commands are percent already.
    pub const PERCENT: CommandScale = CommandScale(1.0);

    /// Of the least and the largest command of training logs: a power of two, so that it loses no digit, and logs of one robot
    /// that differ a little have the same.
    pub fn of(commands: [f32; 2]) -> Self {
        let largest = commands.into_iter().map(|c| f64::from(c).abs()).fold(0.0, f64::max);
        if !largest.is_normal() {
            return CommandScale::PERCENT;
        }
        CommandScale(libm::ldexp(1.0, libm::round(libm::log2(LARGEST_PERCENT / largest)) as i32))
    }

    /// The factor that makes shares of full speed of commands.
    pub fn share(self) -> f32 {
        (0.01 * self.0) as f32
    }

    /// Whether a command is zero: below half a percent, the resolution of controllers.
    pub fn is_rest(self, command: [f64; 2]) -> bool {
        self.percent(command).0.iter().all(|percent| percent.abs() < 0.5)
    }

    /// A command in percent.
    pub fn percent(self, command: [f64; 2]) -> Percent {
        Percent(command.map(|c| self.0 * c))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_largest_command_is_some_eighty_percent(largest in 1e-30f32..1e30) {
            let Percent([least, most]) = CommandScale::of([-0.1 * largest, largest]).percent([0.0, f64::from(largest)]);
            prop_assert!(least == 0.0 && most > 56.0 && most < 114.0, "{most}");
        }
    }

    #[test]
    fn commands_in_percent_stay_as_they_are() {
        for commands in [[-80.0, 80.0], [0.0, 100.0], [-100.0, 60.0], [0.0, 0.0], [f32::NAN, f32::NAN]] {
            assert_eq!(CommandScale::of(commands), CommandScale::PERCENT, "{commands:?}");
        }
        assert_eq!(CommandScale::of([-3.2, 13.4]).percent([2.0, -0.5]), Percent([16.0, -4.0]));
    }
}
