//! What `mindgap export --format nxc-collect` takes.

use clap::Args;
use mindgap_controller_export::collect::CollectOptions;
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::wiring::Wiring;

/// Options of the format nxc-collect alone.
#[derive(Args)]
#[command(next_help_heading = "Options of nxc-collect")]
pub struct Collect {
    /// Time between two rows of the log, milliseconds; the controllers' step.
    #[arg(long, default_value_t = 400)]
    step_ms: u16,
    /// Steps of a run.
    #[arg(long, default_value_t = 150)]
    steps: u16,
    /// Something nearer than this makes the robot turn away.
    #[arg(long, default_value_t = 40)]
    near_cm: u8,
    /// Where the random commands start from.
    #[arg(long, default_value_t = 1)]
    seed: u32,
}

impl Collect {
    /// The program that is asked for.
    pub fn options(&self, program: BrickName, wiring: Wiring) -> CollectOptions {
        let Collect { step_ms, steps, near_cm, seed } = *self;
        CollectOptions { program, wiring, step_ms, steps, near_cm, seed }
    }
}
