//! `mindgap train`

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;

use super::checkpoint_args::{Checkpoint, CheckpointOption};
use super::json_output::JsonOption;
use super::{Run, kinds, progress, warn};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_learning::learn::genome::Shape;
use mindgap_learning::learn::train::{NETWORKS, OF_A_SENSOR, TABLE_ONE};
use mindgap_learning::learn::{paper, train};
use mindgap_models::simulator::Missing;

/// Train the five networks of a simulator on a folder of logs.
#[derive(Args)]
pub struct Train {
    /// Folder with robot.toml, scene.toml and run-*.csv.
    logs: PathBuf,
    /// The simulator file to write.
    #[arg(long)]
    out: PathBuf,
    /// Training method.
    #[arg(long, value_enum, default_value_t = Trainer::Fast)]
    trainer: Trainer,
    /// Number of hidden neurons, half of them product units, in place of the paper's Table I (turn=4, forward=20,
    /// lateral=20, echo_probability=10, echo_value=40); `evaluate` then shows both; repeatable.
    #[arg(long, value_name = "NETWORK=N", value_parser = hidden_layer)]
    hidden: Vec<(String, Shape)>,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    json: JsonOption,
    #[command(flatten)]
    checkpoint: CheckpointOption,
}

fn hidden_layer(text: &str) -> Result<(String, Shape), String> {
    let (network, hidden) = text.split_once('=').ok_or("expected NETWORK=N")?;
    if TABLE_ONE.clone().of(network).is_none() {
        return Err(format!("no such network: {network}{}", files::did_you_mean(network, NETWORKS)));
    }
    let shape = hidden.parse().ok().and_then(Shape::checked_halves);
    Ok((network.into(), shape.ok_or("N must be even, from 2 to 64")?))
}

/// The trainers.
#[derive(Clone, Copy, ValueEnum)]
enum Trainer {
    /// The paper's genetic algorithm for all weights.
    Paper,
    /// Least squares for the linear weights, and a search for the exponents only.
    Fast,
}

/// Results of `mindgap train`.
#[derive(Serialize, JsonSchema)]
pub struct TrainResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// The simulator file.
    simulator: &'a Path,
    /// Number of runs of the logs.
    runs: usize,
    /// Random seed.
    seed: u64,
    /// Number of times that each network was evaluated over all samples.
    evaluations: BTreeMap<String, usize>,
    /// Networks that the logs could not support.
    missing: &'a [Missing],
}

impl Run for Train {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.logs]).writing([&self.out], kinds::SIMULATOR);
        places.writing(self.json.path(), kinds::REPORT).writing(self.checkpoint.path(), kinds::CHECKPOINT)
    }

    fn run(&self, executor: &dyn Executor) -> error::Result<String> {
        let heard = super::read_sound_logs_by_sensor(&self.logs)?;
        let bar = progress::bar((NETWORKS.len() + OF_A_SENSOR * (heard.len() - 1)) as u64);
        // The latest count of each network.
        let evaluations = RefCell::new(BTreeMap::new());
        let watch = |p: train::Progress| {
            evaluations.borrow_mut().insert(p.network.clone(), p.evaluations);
            progress::training(&bar, p);
        };
        let trainer = match self.trainer {
            Trainer::Paper => train::Trainer::Paper(paper::Options::default()),
            Trainer::Fast => train::Trainer::Fast,
        };
        let mut shapes = TABLE_ONE;
        for (network, shape) in &self.hidden {
            shapes.of(network).into_iter().for_each(|layer| *layer = *shape);
        }
        let mut simulator = train::train_sensors(executor, &heard, &trainer, &shapes, self.seed, &watch)?;
        if shapes != TABLE_ONE {
            let table_one = train::train_sensors(executor, &heard, &trainer, &TABLE_ONE, self.seed, &watch)?;
            simulator.table_one = Some(table_one.into());
        }
        bar.finish_and_clear();
        simulator.missing.iter().for_each(|missing| warn(missing.to_string()));
        simulator.write(&self.out)?;
        let evaluations = evaluations.take();
        let counts: Vec<String> = evaluations.iter().map(|(name, n)| format!("{name} {n}")).collect();
        let filter = if simulator.filter.is_none() {
            String::new()
        } else {
            let filter = simulator.filter.in_words(&simulator.robot);
            format!(
                "the robot takes more than a step to respond; its networks see commands behind a filter: {filter}\n"
            )
        };
        let text = format!(
            "{filter}passes over all samples, per network: {}\nsimulator written to {}\n",
            counts.join(", "),
            self.out.display()
        );
        let results = TrainResults {
            schema: SchemaNumber,
            simulator: &self.out,
            runs: simulator.origin.runs,
            seed: self.seed,
            evaluations,
            missing: &simulator.missing,
        };
        self.json.emit_sorted(&results, text)
    }

    fn checkpoint(&self) -> Option<Checkpoint> {
        self.checkpoint.for_output(&self.out)
    }

    fn is_shared(&self) -> bool {
        true
    }
}
