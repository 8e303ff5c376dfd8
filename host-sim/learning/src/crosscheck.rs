//! Fixed point against float: whether a board computes the same as the PC with a simulator's networks.

mod arithmetic;
mod differences;
mod runs;

use mindgap_core::controller::Controller;
use schemars::JsonSchema;
use serde::Serialize;

use crate::learn::dataset::Datasets;
use arithmetic::{Fixed, Float};
pub use differences::{Differences, NetworkCheck};
use mindgap_foundations::error::Result;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::Logs;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::fixed_point::FixedNetworks;
pub use runs::{Difference, Divergence, RunState, Runs, Trials};

/// What `mindgap crosscheck --json` writes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Crosscheck {
    /// Version of the JSON.
    pub schema: SchemaNumber<2>,
    /// The five networks.
    pub networks: Networks,
    /// Controllers that ran in both arithmetics side by side.
    pub runs: Runs,
}

/// How far fixed point is from float.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Networks {
    /// Turn, degrees.
    pub turn: NetworkCheck,
    /// Displacement forward, cm.
    pub forward: NetworkCheck,
    /// Displacement to the left, cm.
    pub lateral: NetworkCheck,
    /// Probability of an echo.
    pub echo_probability: NetworkCheck,
    /// The reading, cm.
    pub echo_value: NetworkCheck,
}

/// Compares a simulator's networks in both arithmetics: on every sample of the logs, on a grid over their trained range, and
/// in whole runs of `controller`, or of random controllers, in the scene of the logs. `watch` receives the number of
/// finished runs and of all runs.
///
/// # Errors
/// If a network is missing or cannot be represented in fixed point, or if the robot does not fit at any pose of the logs.
pub fn crosscheck(
    simulator: &Simulator,
    logs: &Logs,
    controller: Option<&Controller>,
    trials: Trials,
    watch: impl Fn(usize, usize) + Sync,
) -> Result<Crosscheck> {
    let data = Datasets::from_logs(logs);
    let float = Float::new(simulator, &data)?;
    let quantised = FixedNetworks::quantise(simulator)?;
    let fixed = Fixed::new(&quantised, &float);
    let (commands, faced) = (&data.turn.inputs, &data.echo_probability.inputs);
    Ok(Crosscheck {
        schema: SchemaNumber,
        networks: Networks {
            turn: NetworkCheck::new(&float.turn, &quantised.turn, commands),
            forward: NetworkCheck::new(&float.forward, &quantised.forward, commands),
            lateral: NetworkCheck::new(&float.lateral, &quantised.lateral, commands),
            echo_probability: NetworkCheck::new(&float.echo_probability, &quantised.echo_probability, faced),
            echo_value: NetworkCheck::new(&float.echo_value, &quantised.echo_value, faced),
        },
        runs: runs::side_by_side(&float, &fixed, simulator, logs, controller, trials, watch)?,
    })
}
