//! `mindgap train`

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{Run, kinds, progress, warn};
use crate::error;
use crate::files::places::Places;
use crate::learn::genome::Shape;
use crate::learn::train::TABLE_ONE;
use crate::learn::{paper, train};

/// Train the five networks of a simulator on a folder of logs.
#[derive(Args)]
pub struct Train {
    /// Folder with robot.toml, scene.toml and run-*.csv.
    logs: PathBuf,
    /// The simulator file to write.
    #[arg(long)]
    out: PathBuf,
    /// How to train.
    #[arg(long, value_enum, default_value_t = Trainer::Fast)]
    trainer: Trainer,
    /// Another number of hidden neurons than the paper's Table I has (turn=4, forward=20, lateral=20,
    /// echo_probability=10, echo_value=40), half of them product units; `evaluate` then shows both.
    #[arg(long, value_name = "NETWORK=N", value_parser = hidden_layer)]
    hidden: Vec<(String, Shape)>,
    /// Fixes every draw.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

fn hidden_layer(text: &str) -> Result<(String, Shape), String> {
    let (network, hidden) = text.split_once('=').ok_or("needs the form NETWORK=N")?;
    if TABLE_ONE.clone().of(network).is_none() {
        return Err(format!("there is no network {network}"));
    }
    let shape = hidden.parse().ok().and_then(Shape::checked_halves);
    Ok((network.into(), shape.ok_or("the hidden layer has two equal halves of 1 to 32 neurons")?))
}

/// The trainers.
#[derive(Clone, Copy, ValueEnum)]
enum Trainer {
    /// The paper's genetic algorithm on all weights.
    Paper,
    /// Least squares for the linear weights, and a search for the exponents alone.
    Fast,
}

impl Run for Train {
    fn places(&self) -> Places {
        Places::default().reading([&self.logs]).writing([&self.out], kinds::SIMULATOR)
    }

    fn run(&self) -> error::Result<String> {
        let logs = super::read_sound_logs(&self.logs)?;
        let spinner = progress::spinner();
        // The last that is told of each network.
        let evaluations = RefCell::new(BTreeMap::new());
        let watch = |p: train::Progress| {
            evaluations.borrow_mut().insert(p.network, p.evaluations);
            spinner.tick();
            spinner.set_message(progress::training(&p));
        };
        let trainer = match self.trainer {
            Trainer::Paper => train::Trainer::Paper(paper::Options::default()),
            Trainer::Fast => train::Trainer::Fast,
        };
        let mut shapes = TABLE_ONE;
        for (network, shape) in &self.hidden {
            shapes.of(network).into_iter().for_each(|layer| *layer = *shape);
        }
        let mut simulator = train::train(&logs, &trainer, &shapes, self.seed, watch)?;
        if shapes != TABLE_ONE {
            simulator.table_one = Some(train::train(&logs, &trainer, &TABLE_ONE, self.seed, watch)?.into());
        }
        spinner.finish_and_clear();
        for missing in &simulator.missing {
            warn(format!("no {} network: {}", missing.network, missing.reason));
        }
        simulator.write(&self.out)?;
        let evaluations: Vec<String> = evaluations.take().iter().map(|(name, n)| format!("{name} {n}")).collect();
        Ok(format!(
            "networks evaluated over all samples: {}\nsimulator written to {}\n",
            evaluations.join(", "),
            self.out.display()
        ))
    }
}
