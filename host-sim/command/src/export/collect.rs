//! What `mindgap export --format nxc-collect` takes.

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

/// Options of the format nxc-collect alone; a script says itself what they would.
#[derive(Args)]
#[command(next_help_heading = "Options of nxc-collect without a script")]
pub struct Collect {
    /// Time between two rows of the log, milliseconds; the controllers' step.
    #[arg(long, default_value_t = 400, conflicts_with = "input")]
    step_ms: u16,
    /// Steps of a run.
    #[arg(long, default_value_t = 150, conflicts_with = "input")]
    steps: u16,
    /// Something nearer than this makes the robot turn away.
    #[arg(long, default_value_t = 40, conflicts_with = "input")]
    near_cm: u8,
    /// Where the random commands start from.
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "input")]
    seed: u32,
}

impl Collect {
    /// The program that drives at random.
    pub fn options(&self, program: BrickName, wiring: Wiring) -> CollectOptions {
        let Collect { step_ms, steps, near_cm, seed } = *self;
        let commands = Commands::Random { steps, near_cm, seed };
        CollectOptions { program, wiring, safety: Safety::default(), step_ms, commands }
    }
}

/// The columns that a script needs; those of a log may stand beside them.
const COLUMNS: [&str; 3] = ["t_ms", "left", "right"];

/// The program that drives the commands of a script, such as `diagnose --next-experiment` writes it, or of a run.
///
/// # Errors
/// When the file holds neither, or its steps are not of one length of whole milliseconds.
pub fn script(path: &Path, program: BrickName, wiring: Wiring) -> Result<CollectOptions> {
    let rows = Run::parse(path, &files::read_text(path)?, &COLUMNS, warn)?.rows;
    let step_ms = rows.at(1).t_ms - rows.at(0).t_ms;
    let is_even = rows.pairs().all(|pair| pair[1].t_ms - pair[0].t_ms == step_ms);
    if !is_even || step_ms.fract() != 0.0 || step_ms > f64::from(u16::MAX) {
        return Err(Error::in_file(path, "is no script: its rows are not equally many whole milliseconds apart"));
    }
    let powers = rows.iter().map(|row| [row.left, row.right].map(|power| power.round() as i8)).collect();
    let commands = Commands::Script(powers);
    Ok(CollectOptions { program, wiring, safety: Safety::default(), step_ms: step_ms as u16, commands })
}
