//! Trains a simulator from logs: which networks the logs support, their training, and their noise.

use mindgap_core::network::{Activation, Network};

use super::dataset::{Dataset, Datasets};
use super::fast::{self, Loss};
use super::genome::Shape;
use super::{drive_filter, echo_law, ensemble, nominal, paper, scatter};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::{self, Executor};
use mindgap_foundations::motion::Axis;
use mindgap_logs::heard::Heard;
use mindgap_logs::range_sensor::RangeSensor;
use mindgap_logs::{Logs, Robot, samples};
use mindgap_models::effects::drive_filter::DriveFilter;
use mindgap_models::simulator::further_sensor::FurtherSensor;
use mindgap_models::simulator::residuals::{ConstantReading, motion_context};
use mindgap_models::simulator::{Learned, Missing, Origin, SCHEMA, Simulator};

/// Hidden layers of the five networks (paper, Table I).
pub const TABLE_ONE: Shapes = Shapes {
    turn: Shape::halves(4),
    forward: Shape::halves(20),
    lateral: Shape::halves(20),
    echo_probability: Shape::halves(10),
    echo_value: Shape::halves(40),
};

/// The networks, in the order in which they are trained.
pub const NETWORKS: [&str; 5] = ["turn", "forward", "lateral", "echo_probability", "echo_value"];
/// Number of networks of a further range sensor.
pub const OF_A_SENSOR: usize = 2;
/// One run in this many is held out of training to estimate the residuals.
const HELD_OUT: usize = 5;
/// Least number of samples to train a network.
const FEWEST_SAMPLES: usize = 30;

/// Hidden layers of the five networks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shapes {
    /// Hidden layer for the turn.
    pub turn: Shape,
    /// Hidden layer for the displacement forward.
    pub forward: Shape,
    /// Hidden layer for the displacement to the left.
    pub lateral: Shape,
    /// Hidden layer for the probability of an echo.
    pub echo_probability: Shape,
    /// Hidden layer for the reading.
    pub echo_value: Shape,
}

/// The algorithm that trains networks.
#[derive(Clone, Copy, Debug)]
pub enum Trainer {
    /// The genetic algorithm on all weights (paper, section VII).
    Paper(paper::Options),
    /// Variable projection: a search for the exponents, with least squares for the other weights.
    Fast,
}

/// Progress of the training of one network.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Name of the network; that of a further range sensor ends in `_NAME`.
    pub network: String,
    /// Number of evaluations over all samples so far; the fast trainer reports it at the end only.
    pub evaluations: usize,
}

/// Trains a simulator on logs as each of the robot's range sensors heard them, the first sensor first.
///
/// # Errors
/// As [`train`].
pub fn train_sensors(
    executor: &dyn Executor,
    heard: &[Heard],
    trainer: &Trainer,
    shapes: &Shapes,
    seed: u64,
    watch: &dyn Fn(Progress),
) -> Result<Simulator> {
    let simulator = train(executor, &heard[0].logs, trainer, shapes, seed, watch)?;
    let add = |simulator, heard| add_sensor(simulator, executor, heard, (trainer, shapes), watch);
    heard[1..].iter().try_fold(simulator, add)
}

/// Trains the networks that `logs` support, one after the other.
///
/// # Errors
/// When the logs support none; the message gives the reason for each.
pub fn train(
    executor: &dyn Executor,
    logs: &Logs,
    trainer: &Trainer,
    shapes: &Shapes,
    seed: u64,
    watch: &dyn Fn(Progress),
) -> Result<Simulator> {
    let filter = match trainer {
        Trainer::Paper(_) => DriveFilter::default(),
        Trainer::Fast => executor::once(executor, || Ok(drive_filter::learn(logs)))?,
    };
    let data = Datasets::behind(filter, logs);
    let mut network_trainer = NetworkTrainer::new(executor, trainer, seed, logs.runs.len(), watch);
    let value = Kind { activation: Activation::Linear, loss: Loss::Squares };
    let turn = network_trainer.train("turn", &data.turn, shapes.turn, value, motion_context)?;
    let forward = network_trainer.train("forward", &data.forward, shapes.forward, value, motion_context)?;
    let lateral = network_trainer.train("lateral", &data.lateral, shapes.lateral, value, motion_context)?;
    let Echoes { echo_probability, echo_value, constant_reading } = network_trainer.train_echoes(&data, shapes)?;
    let missing = blame_missing_sensor(network_trainer.missing, &logs.robot);
    if missing.len() == NETWORKS.len() {
        let reasons: Vec<String> = missing.iter().map(|m| format!("{}: {}", m.network, m.reason)).collect();
        return Err(Error::new(format!("no network can be trained on these logs ({})", reasons.join("; "))));
    }
    let commands = logs.runs.iter().flat_map(|run| run.rows.iter().flat_map(|row| row.command()));
    let (low, high) = commands.fold((0.0, 0.0), |(l, h): (f64, f64), c| (l.min(c), h.max(c)));
    let first_echo = executor::once(executor, || Ok(echo_law::learn(logs, seed)))?;
    let mut simulator = Simulator {
        schema: SCHEMA,
        origin: Origin {
            version: env!("CARGO_PKG_VERSION").into(),
            trainer: trainer.name().into(),
            seed,
            runs: logs.runs.len(),
        },
        robot: logs.robot,
        sensor: logs.sensors().first_table().map(str::to_owned),
        commands: [low as f32, high as f32],
        filter,
        turn,
        forward,
        lateral,
        echo_probability,
        echo_value,
        first_echo: first_echo.as_ref().map(|law| law.sensor.clone()),
        constant_reading,
        further: Vec::new(),
        reference: None,
        ensemble: None,
        table_one: None,
        added: Vec::new(),
        missing,
    };
    let reference =
        executor::once(executor, || Ok(nominal::learn(&simulator, first_echo.map(|law| law.as_logged), logs)))?;
    if let Some(motion) = &reference.motion {
        let sent: Vec<[f32; 4]> = samples::steps(logs).map(|step| step.speeds.map(|v| v as f32)).collect();
        let misfit = |axis: Axis| move |speeds: &[f64; 4]| motion.correction(speeds).turn_in_degrees()[axis];
        set_residual_quantiles(&mut simulator.forward, &data.forward, &sent, misfit(Axis::Forward));
        set_residual_quantiles(&mut simulator.lateral, &data.lateral, &sent, misfit(Axis::Lateral));
        set_residual_quantiles(&mut simulator.turn, &data.turn, &sent, misfit(Axis::Turn));
    }
    simulator.reference = Some(reference);
    simulator.ensemble = executor::once(executor, || Ok(ensemble::learn(&simulator, logs)))?;
    Ok(simulator)
}

/// Trains the networks of a further range sensor on logs as it heard them, and adds it to a simulator that was trained on the
/// others of these logs' columns. The networks that they do not support are added to the missing ones.
///
/// # Errors
/// When the executor cannot finish.
fn add_sensor(
    mut simulator: Simulator,
    executor: &dyn Executor,
    heard: &Heard,
    (trainer, shapes): (&Trainer, &Shapes),
    watch: &dyn Fn(Progress),
) -> Result<Simulator> {
    let (seed, Heard { sensor, logs }) = (simulator.origin.seed, heard);
    let named = |progress: Progress| {
        watch(Progress { network: Missing::network_of(&progress.network, sensor), ..progress });
    };
    let data = Datasets::from_logs(logs);
    let mut network_trainer = NetworkTrainer::new(executor, trainer, seed, logs.runs.len(), &named);
    let echoes = network_trainer.train_echoes(&data, shapes)?;
    let missing = network_trainer.missing.into_iter();
    simulator.missing.extend(missing.map(|m| Missing { network: Missing::network_of(&m.network, sensor), ..m }));
    let first_echo = executor::once(executor, || Ok(echo_law::learn(logs, seed)))?;
    let law = first_echo.as_ref().map(|law| law.sensor.clone());
    let learn = || nominal::learn_sonar(echoes.constant_reading, first_echo.map(|law| law.as_logged), logs);
    let reference = executor::once(executor, || Ok(learn()))?;
    simulator.further.extend(logs.robot.ultrasonic.map(|mount| FurtherSensor {
        sensor: RangeSensor::new(sensor.clone(), mount),
        echo_probability: echoes.echo_probability,
        echo_value: echoes.echo_value,
        first_echo: law,
        constant_reading: echoes.constant_reading,
        reference: Some(reference),
    }));
    Ok(simulator)
}

/// Returns the networks that logs do not support, and why.
pub fn unsupported(logs: &Logs) -> Vec<Missing> {
    let (data, runs) = (Datasets::from_logs(logs), logs.runs.len());
    let reasons = [
        ("turn", reason_against(&fitted_runs(&data.turn, runs))),
        ("forward", reason_against(&fitted_runs(&data.forward, runs))),
        ("lateral", reason_against(&fitted_runs(&data.lateral, runs))),
        ("echo_probability", reason_against(&fitted_runs(&data.echo_probability, runs))),
        ("echo_value", reason_against(&fitted_runs(&data.echo_value, runs))),
    ];
    let missing =
        |(network, reason): (&str, Option<String>)| Some(Missing { network: network.into(), reason: reason? });
    let missing = reasons.into_iter().filter_map(missing).collect();
    blame_missing_sensor(missing, &logs.robot)
}

/// Gives the lack of a range sensor, if the robot has none, as the reason why its networks are missing.
fn blame_missing_sensor(mut missing: Vec<Missing>, robot: &Robot) -> Vec<Missing> {
    if robot.ultrasonic.is_none() {
        let of_sensor = missing.iter_mut().filter(|missing| missing.network.starts_with("echo"));
        of_sensor.for_each(|missing| {
            missing.reason = "the robot has no range sensor: robot.toml has no [ultrasonic]".into()
        });
    }
    missing
}

/// Estimates the noise of a motion network about its bias-corrected predictions; `sent` are the commands before the filter.
fn set_residual_quantiles(
    learned: &mut Option<Learned<4>>,
    data: &Dataset<4>,
    sent: &[[f32; 4]],
    correction: impl Fn(&[f64; 4]) -> f64,
) {
    let Some(learned) = learned else { return };
    let contexts: Vec<[f32; 2]> = data.inputs.iter().map(motion_context).collect();
    let misfit = data.inputs.iter().map(|speeds| correction(&speeds.map(f64::from)) as f32);
    let left: Vec<f32> = residuals(&learned.network, data).iter().zip(misfit).map(|(r, m)| r - m).collect();
    learned.residuals = scatter::residual_quantiles(&contexts, &left);
    learned.residuals.components = scatter::variance_components(&learned.residuals, &contexts, &left, sent, &data.runs);
}

impl Shapes {
    /// Returns the hidden layer of the network of this name.
    pub fn of(&mut self, network: &str) -> Option<&mut Shape> {
        match network {
            "turn" => Some(&mut self.turn),
            "forward" => Some(&mut self.forward),
            "lateral" => Some(&mut self.lateral),
            "echo_probability" => Some(&mut self.echo_probability),
            "echo_value" => Some(&mut self.echo_value),
            _ => None,
        }
    }
}

/// Returns whether a run is held out of training, so that its residuals are unbiased; none is when there are too few runs.
pub fn is_held_out(run: usize, runs: usize) -> bool {
    runs >= HELD_OUT && run % HELD_OUT == HELD_OUT - 1
}

impl Trainer {
    /// Returns its name on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Trainer::Paper(_) => "paper",
            Trainer::Fast => "fast",
        }
    }
}

/// Trains the networks of a simulator one by one and notes those that the logs do not support.
struct NetworkTrainer<'a> {
    executor: &'a dyn Executor,
    trainer: &'a Trainer,
    seed: u64,
    runs: usize,
    watch: &'a dyn Fn(Progress),
    missing: Vec<Missing>,
}

/// The networks of a range sensor.
struct Echoes {
    echo_probability: Option<Learned<2>>,
    echo_value: Option<Learned<2>>,
    constant_reading: Option<ConstantReading>,
}

/// Kind of quantity that a network predicts.
#[derive(Clone, Copy)]
struct Kind {
    activation: Activation,
    /// Loss function of the fast trainer; that of the paper is always the squared error.
    loss: Loss,
}

impl<'a> NetworkTrainer<'a> {
    fn new(
        executor: &'a dyn Executor,
        trainer: &'a Trainer,
        seed: u64,
        runs: usize,
        watch: &'a dyn Fn(Progress),
    ) -> Self {
        NetworkTrainer { executor, trainer, seed, runs, watch, missing: Vec::new() }
    }

    fn train_echoes(&mut self, data: &Datasets, shapes: &Shapes) -> Result<Echoes> {
        let probability = Kind { activation: Activation::Ramp, loss: Loss::Logistic };
        let reading = Kind { activation: Activation::Linear, loss: Loss::Mixture };
        // D and α themselves are the context of the sonar networks.
        let context = |inputs: &[f32; 2]| *inputs;
        let [of_probability, of_value] = [shapes.echo_probability, shapes.echo_value];
        let echo_probability =
            self.train("echo_probability", &data.echo_probability, of_probability, probability, context)?;
        let mut echo_value = self.train("echo_value", &data.echo_value, of_value, reading, context)?;
        let constant_reading = echo_value.as_mut().and_then(|value| split_constant_reading(value, &data.echo_value));
        Ok(Echoes { echo_probability, echo_value, constant_reading })
    }

    fn train<const N: usize>(
        &mut self,
        network: &'static str,
        data: &Dataset<N>,
        shape: Shape,
        kind: Kind,
        context: impl Fn(&[f32; N]) -> [f32; 2],
    ) -> Result<Option<Learned<N>>> {
        let fitted = fitted_runs(data, self.runs);
        if let Some(reason) = reason_against(&fitted) {
            self.missing.push(Missing { network: network.into(), reason });
            return Ok(None);
        }
        let held_out = data.of_runs(|run| is_held_out(run, self.runs));
        let judged = if held_out.is_empty() { &fitted } else { &held_out };
        let watch = |evaluations| (self.watch)(Progress { network: network.into(), evaluations });
        watch(0);
        let (trained, evaluations) = match self.trainer {
            Trainer::Paper(options) => {
                let watch = |generation, _| watch(generation * options.genetic.population);
                let done = paper::train(self.executor, &fitted, shape, kind.activation, options, self.seed, watch)?;
                (done.network, done.evaluations)
            }
            Trainer::Fast => {
                let done = fast::train(self.executor, &fitted, judged, shape, kind.activation, kind.loss, self.seed)?;
                (done.network, done.evaluations)
            }
        };
        watch(evaluations);
        let contexts: Vec<[f32; 2]> = judged.inputs.iter().map(context).collect();
        let residuals = scatter::residual_quantiles(&contexts, &residuals(&trained, judged));
        Ok(Some(Learned { network: trained, residuals }))
    }
}

/// Returns the samples of the runs that are not held out.
fn fitted_runs<const N: usize>(data: &Dataset<N>, runs: usize) -> Dataset<N> {
    data.of_runs(|run| !is_held_out(run, runs))
}

/// Returns the reason why a data set cannot train a network; `None` if it can.
fn reason_against<const N: usize>(data: &Dataset<N>) -> Option<String> {
    if data.len() < FEWEST_SAMPLES {
        return Some(format!("the logs hold {} samples for it, fewer than {FEWEST_SAMPLES}", data.len()));
    }
    let flat = |range: &std::ops::RangeInclusive<f32>| range.start() >= range.end();
    if data.ranges().iter().any(flat) {
        return Some("one of its inputs is constant over all samples (all commands equal, for example)".into());
    }
    let targets = data.target_range();
    flat(&targets).then(|| format!("its target is {} in every sample", targets.start()))
}

/// Separates a constant wrong reading from the others and estimates the noise of those again.
fn split_constant_reading(value: &mut Learned<2>, data: &Dataset<2>) -> Option<ConstantReading> {
    let predicted: Vec<f32> = data.inputs.iter().map(|x| value.network.evaluate(*x)).collect();
    let constant = scatter::constant_reading(&data.targets, &predicted)?;
    let right = |i: &usize| !scatter::is_constant(&constant, data.targets[*i], predicted[*i]);
    let others: Vec<usize> = (0..data.len()).filter(right).collect();
    let contexts: Vec<[f32; 2]> = others.iter().map(|i| data.inputs[*i]).collect();
    let residuals: Vec<f32> = others.iter().map(|i| data.targets[*i] - predicted[*i]).collect();
    value.residuals = scatter::residual_quantiles(&contexts, &residuals);
    Some(constant)
}

fn residuals<const N: usize>(network: &Network<f32, N>, data: &Dataset<N>) -> Vec<f32> {
    data.inputs.iter().zip(&data.targets).map(|(x, target)| target - network.evaluate(*x)).collect()
}
