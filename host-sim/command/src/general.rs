//! The options that every command has.

use clap::Args;
use log::LevelFilter;
use rayon::ThreadPoolBuilder;

use super::voice;
use mindgap_foundations::error::{Error, Result};
use mindgap_workers as workers;

/// Options of every command.
#[derive(Args)]
#[command(next_help_heading = "General options")]
pub struct General {
    /// Replace what is at the place of an output, whatever it is; what else lies in a folder stays.
    #[arg(long, global = true)]
    pub force: bool,
    /// Work on so many processors at once; on all when left out, which ranks on one machine share. Results are the same.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Say nothing but errors: no text, no warnings, no progress. Files are written as ever, `--json -` too.
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Also say on standard error what is decided on the way.
    #[arg(short, long, global = true)]
    verbose: bool,
}

impl General {
    /// Makes them hold for this process.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn take_effect(&self) -> Result<()> {
        voice::speak_up_to(match (self.quiet || !workers::is_first(), self.verbose) {
            (true, _) => LevelFilter::Error,
            (false, false) => LevelFilter::Warn,
            (false, true) => LevelFilter::Info,
        });
        // None are as many as there are processors.
        let threads = self.threads.map(usize::from).or_else(workers::threads).unwrap_or_default();
        let pool = ThreadPoolBuilder::new().num_threads(threads).build_global();
        pool.map_err(|e| Error::new(format!("threads cannot be started: {e}")))?;
        log::info!("mindgap {} on {} threads", env!("CARGO_PKG_VERSION"), rayon::current_num_threads());
        Ok(())
    }
}
