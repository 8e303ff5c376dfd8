//! How a controller's run ended.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a controller's run ended, on a robot or in a simulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Termination {
    /// The sixth tuple's test held.
    Finished,
    /// The step limit was reached.
    TimedOut,
    /// The robot touched a wall or an obstacle.
    Crashed,
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Termination::Finished => "finished",
            Termination::TimedOut => "timed out",
            Termination::Crashed => "crashed",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terminations_have_fixed_names_in_json() {
        let all = [Termination::Finished, Termination::TimedOut, Termination::Crashed];
        let written = serde_json::to_string(&all).expect("JSON");
        assert_eq!(written, r#"["finished","timed_out","crashed"]"#);
        assert_eq!(serde_json::from_str::<[Termination; 3]>(&written).expect("the same"), all);
    }
}
