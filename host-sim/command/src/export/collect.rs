//! Options of `mindgap export` for programs that collect data.

use std::path::Path;

use clap::Args;
use mindgap_controller_export::collect::Commands;

use crate::warn;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Run;

/// Options of the formats nxc-collect and pybricks-collect; a script replaces them.
#[derive(Args)]
#[command(next_help_heading = "Options of nxc-collect and pybricks-collect without a script")]
pub struct Collect {
    /// Time between two rows of the log, ms; also the controllers' step.
    #[arg(long, default_value_t = 400, conflicts_with = "input")]
    step_ms: u16,
    /// Steps per run.
    #[arg(long, default_value_t = 150, conflicts_with = "input")]
    steps: u16,
    /// Turn away from anything nearer than this.
    #[arg(long, default_value_t = 40, conflicts_with = "input")]
    near_cm: u8,
    /// Random seed of the commands.
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "input")]
    seed: u32,
}

impl Collect {
    /// Returns the step time and the commands of a program that drives at random.
    pub fn random(&self) -> (u16, Commands) {
        let Collect { step_ms, steps, near_cm, seed } = *self;
        (step_ms, Commands::Random { steps, near_cm, seed })
    }
}

/// Required columns of a script; it may have those of a log as well.
const COLUMNS: [&str; 3] = ["t_ms", "left", "right"];

/// Returns the step time and the commands of a run, or of a script from `diagnose --next-experiment`.
///
/// # Errors
/// If the file is neither, or its steps are not all the same whole number of milliseconds.
pub fn script(path: &Path) -> Result<(u16, Commands)> {
    let rows = Run::parse(path, &files::read_text(path)?, &COLUMNS, warn)?.rows;
    let step_ms = rows.at(1).t_ms - rows.at(0).t_ms;
    let is_even = rows.pairs().all(|pair| pair[1].t_ms - pair[0].t_ms == step_ms);
    if !is_even || step_ms.fract() != 0.0 || step_ms > f64::from(u16::MAX) {
        return Err(Error::in_file(
            path,
            "is not a script: its rows must be the same whole number of milliseconds apart",
        ));
    }
    let powers = rows.iter().map(|row| [row.left, row.right].map(|power| power.round() as i8)).collect();
    Ok((step_ms as u16, Commands::Script(powers)))
}
