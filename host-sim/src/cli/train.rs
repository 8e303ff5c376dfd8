//! `mindgap train`

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::progress;
use crate::learn::{paper, train};
use crate::problem::Result;

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
    /// Fixes every draw.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The trainers.
#[derive(Clone, Copy, ValueEnum)]
enum Trainer {
    /// The paper's genetic algorithm on all weights.
    Paper,
    /// Least squares for the linear weights, and a search for the exponents alone.
    Fast,
}

impl Train {
    /// Trains and writes the simulator.
    pub fn run(&self) -> Result<String> {
        let logs = super::read_logs(&self.logs)?;
        let spinner = progress::spinner();
        let watch = |p: train::Progress| {
            spinner.tick();
            spinner.set_message(progress::training(&p));
        };
        let trainer = match self.trainer {
            Trainer::Paper => train::Trainer::Paper(paper::Options::default()),
            Trainer::Fast => train::Trainer::Fast,
        };
        let simulator = train::train(&logs, &trainer, self.seed, watch)?;
        spinner.finish_and_clear();
        for missing in &simulator.missing {
            eprintln!("mindgap: warning: no {} network: {}", missing.network, missing.reason);
        }
        simulator.write(&self.out)?;
        Ok(format!("simulator written to {}\n", self.out.display()))
    }
}
