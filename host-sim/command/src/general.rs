//! The options of every command.

use clap::Args;
use log::LevelFilter;
use rayon::ThreadPoolBuilder;

use super::logging;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_workers::Workers;

/// Options of every command.
#[derive(Args)]
#[command(next_help_heading = "General options")]
pub struct General {
    /// Overwrite existing outputs, whatever they are; other files in an output folder are kept.
    #[arg(long, global = true)]
    pub force: bool,
    /// Number of threads (default: all cores, shared by MPI ranks on one machine). Results do not depend on it.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print errors only: no report, no warnings, no progress. Files are still written, including `--json -`.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Log decisions to standard error.
    #[arg(short, long, global = true)]
    verbose: bool,
    /// Let a mindgap.toml next to the logs set this option, which would otherwise be refused because it names a program to run or a
    /// file to write; repeatable. Example: loop.robot.
    #[arg(long, global = true, value_name = "COMMAND.OPTION")]
    pub allow: Vec<String>,
}

impl General {
    /// Applies the options to this process.
    ///
    /// # Errors
    /// If threads cannot be started.
    pub fn take_effect(&self, workers: &Workers) -> Result<()> {
        logging::set_level(match (self.quiet || !workers.is_first(), self.verbose) {
            (true, _) => LevelFilter::Error,
            (false, false) => LevelFilter::Warn,
            (false, true) => LevelFilter::Info,
        });
        // Zero means as many as there are processors.
        let threads = self.threads.map(usize::from).or_else(|| workers.threads()).unwrap_or_default();
        let pool = ThreadPoolBuilder::new().num_threads(threads).build_global();
        pool.map_err(|e| Error::new(format!("cannot start threads: {e}")))?;
        log::info!("mindgap {} on {} threads", env!("CARGO_PKG_VERSION"), rayon::current_num_threads());
        Ok(())
    }
}
