//! From a folder of logs to a simulator: which networks the logs support, their training, and their scatter.

use mindgap_core::network::{Activation, Network};

use super::dataset::{Dataset, Datasets};
use super::genome::Shape;
use super::paper;
use super::reference;
use super::scatter;
use crate::logs::Logs;
use crate::problem::{Problem, Result};
use crate::simulator::scatter::{ConstantReading, motion_context};
use crate::simulator::{Learned, Missing, Origin, SCHEMA, Simulator};

/// Hidden neurons of the five networks (paper, Table I).
pub const TABLE_ONE: Shapes = Shapes {
    turn: Shape::halves(4),
    forward: Shape::halves(20),
    lateral: Shape::halves(20),
    echo_probability: Shape::halves(10),
    echo_value: Shape::halves(40),
};

/// How many networks there are.
const NETWORKS: usize = 5;
/// Every so many runs one is kept from training, for the scatter of the residuals.
const HELD_OUT: usize = 5;
/// Fewer samples than this train nothing.
const FEWEST_SAMPLES: usize = 30;

/// Hidden layers of the five networks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shapes {
    /// Of the turn.
    pub turn: Shape,
    /// Of the way forward.
    pub forward: Shape,
    /// Of the way to the left.
    pub lateral: Shape,
    /// Of the chance of an echo.
    pub echo_probability: Shape,
    /// Of its value.
    pub echo_value: Shape,
}

/// One of the five networks, as progress is told of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The network.
    pub network: &'static str,
    /// Generations so far.
    pub generation: usize,
    /// Mean squared error of the best so far, in the trainer's scaled unit.
    pub best_mse: f64,
}

/// Trains the networks that `logs` support, by the paper's trainer, one after the other.
///
/// # Errors
/// When the logs support none; the reasons are named.
pub fn train(logs: &Logs, options: &paper::Options, seed: u64, watch: impl Fn(Progress)) -> Result<Simulator> {
    let data = Datasets::from_logs(logs);
    let mut trainer = Trainer { options, seed, runs: logs.runs.len(), watch, missing: Vec::new() };
    let motion = Scattering { context: motion_context, moves: true };
    // D and α are the sonar's context themselves.
    let sonar = Scattering { context: |inputs: &[f32; 2]| *inputs, moves: false };
    let linear = Activation::Linear;
    let turn = trainer.learn("turn", &data.turn, TABLE_ONE.turn, linear, motion);
    let forward = trainer.learn("forward", &data.forward, TABLE_ONE.forward, linear, motion);
    let lateral = trainer.learn("lateral", &data.lateral, TABLE_ONE.lateral, linear, motion);
    let ramp = Activation::Ramp;
    let echo_probability =
        trainer.learn("echo_probability", &data.echo_probability, TABLE_ONE.echo_probability, ramp, sonar);
    let mut echo_value = trainer.learn("echo_value", &data.echo_value, TABLE_ONE.echo_value, linear, sonar);
    let constant_reading = echo_value.as_mut().and_then(|value| split_constant_reading(value, &data.echo_value));
    if trainer.missing.len() == NETWORKS {
        let reasons: Vec<String> = trainer.missing.iter().map(|m| format!("{}: {}", m.network, m.reason)).collect();
        return Err(Problem::new(format!("no network can be trained on these logs ({})", reasons.join("; "))));
    }
    let commands = logs.runs.iter().flat_map(|run| run.rows.iter().flat_map(|row| row.command()));
    let (low, high) = commands.fold((0.0, 0.0), |(l, h): (f64, f64), c| (l.min(c), h.max(c)));
    let mut simulator = Simulator {
        schema: SCHEMA,
        origin: Origin {
            version: env!("CARGO_PKG_VERSION").into(),
            trainer: "paper".into(),
            seed,
            runs: logs.runs.len(),
        },
        robot: logs.robot,
        commands: [low as f32, high as f32],
        turn,
        forward,
        lateral,
        echo_probability,
        echo_value,
        constant_reading,
        reference: None,
        missing: trainer.missing,
    };
    simulator.reference = Some(reference::learn(&simulator, logs));
    Ok(simulator)
}

/// Whether a run is kept from training, so that residuals on it are honest; none is when there are too few.
pub fn is_held_out(run: usize, runs: usize) -> bool {
    runs >= HELD_OUT && run % HELD_OUT == HELD_OUT - 1
}

struct Trainer<'a, W> {
    options: &'a paper::Options,
    seed: u64,
    runs: usize,
    watch: W,
    missing: Vec<Missing>,
}

impl<W: Fn(Progress)> Trainer<'_, W> {
    fn learn<const N: usize>(
        &mut self,
        network: &'static str,
        data: &Dataset<N>,
        shape: Shape,
        activation: Activation,
        Scattering { context, moves }: Scattering<N>,
    ) -> Option<Learned<N>> {
        let fitted = data.of_runs(|run| !is_held_out(run, self.runs));
        if let Some(reason) = unsupported(&fitted) {
            self.missing.push(Missing { network: network.into(), reason });
            return None;
        }
        let watch = |generation, fitness: f64| (self.watch)(Progress { network, generation, best_mse: 1.0 / fitness });
        let trained = paper::train(&fitted, shape, activation, self.options, self.seed, watch);
        let judged = if self.runs >= HELD_OUT { data.of_runs(|run| is_held_out(run, self.runs)) } else { fitted };
        let contexts: Vec<[f32; 2]> = judged.inputs.iter().map(context).collect();
        let residuals = residuals(&trained.network, &judged);
        let mut spread = scatter::spread(&contexts, &residuals);
        if moves {
            spread.own_share = scatter::own_share(&residuals, &judged.runs);
        }
        Some(Learned { network: trained.network, spread })
    }
}

/// What the scatter about a network depends on.
#[derive(Clone, Copy)]
struct Scattering<const N: usize> {
    /// The two context variables.
    context: fn(&[f32; N]) -> [f32; 2],
    /// Whether the network predicts a difference of tracked poses.
    moves: bool,
}

/// Why a data set trains nothing, if so.
fn unsupported<const N: usize>(data: &Dataset<N>) -> Option<String> {
    if data.len() < FEWEST_SAMPLES {
        return Some(format!("the logs hold {} samples for it, fewer than {FEWEST_SAMPLES}", data.len()));
    }
    let flat = |range: &std::ops::RangeInclusive<f32>| range.start() >= range.end();
    if data.ranges().iter().any(flat) {
        return Some("one of its inputs is the same in all samples (such as all commands equal)".into());
    }
    let targets = data.target_range();
    flat(&targets).then(|| format!("what it should predict is {} in every sample", targets.start()))
}

/// Takes a constant wrong reading out of the spread of the readings, which then is that of the others.
fn split_constant_reading(value: &mut Learned<2>, data: &Dataset<2>) -> Option<ConstantReading> {
    let predicted: Vec<f32> = data.inputs.iter().map(|x| value.network.evaluate(*x)).collect();
    let constant = scatter::constant_reading(&data.targets, &predicted)?;
    let right = |i: &usize| !scatter::is_constant(&constant, data.targets[*i], predicted[*i]);
    let others: Vec<usize> = (0..data.len()).filter(right).collect();
    let contexts: Vec<[f32; 2]> = others.iter().map(|i| data.inputs[*i]).collect();
    let residuals: Vec<f32> = others.iter().map(|i| data.targets[*i] - predicted[*i]).collect();
    value.spread = scatter::spread(&contexts, &residuals);
    Some(constant)
}

fn residuals<const N: usize>(network: &Network<f32, N>, data: &Dataset<N>) -> Vec<f32> {
    data.inputs.iter().zip(&data.targets).map(|(x, target)| target - network.evaluate(*x)).collect()
}
