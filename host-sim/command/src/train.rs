//! `mindgap train`

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::facts::FactsOption;
use super::lasting::{KeepOption, Kept};
use super::{Run, kinds, progress, warn};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error;
use mindgap_learning::learn::genome::Shape;
use mindgap_learning::learn::train::{NETWORKS, TABLE_ONE};
use mindgap_learning::learn::{paper, train};

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
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    facts: FactsOption,
    #[command(flatten)]
    keep: KeepOption,
}

fn hidden_layer(text: &str) -> Result<(String, Shape), String> {
    let (network, hidden) = text.split_once('=').ok_or("needs the form NETWORK=N")?;
    if TABLE_ONE.clone().of(network).is_none() {
        return Err(format!("there is no network {network}{}", files::did_you_mean(network, NETWORKS)));
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
        let places = Places::default().reading([&self.logs]).writing([&self.out], kinds::SIMULATOR);
        places.writing(self.facts.asked(), kinds::REPORT).writing(self.keep.asked(), kinds::CHECKPOINT)
    }

    fn run(&self) -> error::Result<String> {
        let logs = super::read_sound_logs(&self.logs)?;
        let bar = progress::bar(NETWORKS.len() as u64);
        // The last that is told of each network.
        let evaluations = RefCell::new(BTreeMap::new());
        let watch = |p: train::Progress| {
            evaluations.borrow_mut().insert(p.network, p.evaluations);
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
        let mut simulator = train::train(&logs, &trainer, &shapes, self.seed, &watch)?;
        if shapes != TABLE_ONE {
            simulator.table_one = Some(train::train(&logs, &trainer, &TABLE_ONE, self.seed, &watch)?.into());
        }
        bar.finish_and_clear();
        for missing in &simulator.missing {
            warn(format!("no {} network: {}", missing.network, missing.reason));
        }
        simulator.write(&self.out)?;
        let evaluations = evaluations.take();
        let counts: Vec<String> = evaluations.iter().map(|(name, n)| format!("{name} {n}")).collect();
        let text = format!(
            "networks evaluated over all samples: {}\nsimulator written to {}\n",
            counts.join(", "),
            self.out.display()
        );
        let facts = json!({
            "schema": 1, "simulator": self.out, "runs": simulator.origin.runs, "seed": self.seed,
            "evaluations": evaluations, "missing": simulator.missing,
        });
        self.facts.told(&facts, text)
    }

    fn kept(&self) -> Option<Kept> {
        self.keep.beside(&self.out)
    }

    fn is_shared(&self) -> bool {
        true
    }
}
