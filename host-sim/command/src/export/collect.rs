//! Options of `mindgap export --format nxc-collect`.

use std::path::Path;

use clap::Args;
use mindgap_controller_export::collect::{CollectOptions, Commands};
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::wiring::Wiring;

use crate::warn;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Run;

/// Options of the format nxc-collect; a script replaces them.
#[derive(Args)]
#[command(next_help_heading = "Options of nxc-collect without a script")]
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
    /// Returns the options of a program that drives at random.
    pub fn options(&self, program: BrickName, wiring: Wiring) -> CollectOptions {
        let Collect { step_ms, steps, near_cm, seed } = *self;
        let commands = Commands::Random { steps, near_cm, seed };
        CollectOptions { program, wiring, safety: Safety::default(), step_ms, commands }
    }
}

/// Required columns of a script; it may have those of a log as well.
const COLUMNS: [&str; 3] = ["t_ms", "left", "right"];

/// Returns the options of a program that replays the commands of a run or of a script from `diagnose --next-experiment`.
///
/// # Errors
/// If the file is neither, or its steps are not all the same whole number of milliseconds.
pub fn script(path: &Path, program: BrickName, wiring: Wiring) -> Result<CollectOptions> {
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
    let commands = Commands::Script(powers);
    Ok(CollectOptions { program, wiring, safety: Safety::default(), step_ms: step_ms as u16, commands })
}
