//! `mindgap completions` and `mindgap manual`: made from the definitions by which the command is parsed.

use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;

use super::{Run, guide};
use crate::error::{Error, Result};
use crate::files;
use crate::files::places::Places;

/// Print what makes a shell complete this command.
#[derive(Args)]
pub struct Completions {
    /// The shell.
    shell: Shell,
}

/// Write manual pages, one a command.
#[derive(Args)]
pub struct Manual {
    /// The folder to write them into.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

const NAME: &str = "mindgap";

impl Run for Completions {
    fn places(&self) -> Places {
        Places::default()
    }

    fn run(&self) -> Result<String> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut guide::command(), NAME, &mut script);
        let printed = files::to_standard_output(&script);
        printed.map_err(|e| Error::new(format!("standard output cannot be written: {e}")))?;
        Ok(String::new())
    }
}

impl Run for Manual {
    fn places(&self) -> Places {
        Places::default().filling([&self.out])
    }

    fn run(&self) -> Result<String> {
        let command = guide::command();
        let subcommands = command.get_subcommands().map(|of| (format!("{NAME}-{}", of.get_name()), of.clone()));
        let pages: Vec<(String, Command)> = subcommands.collect();
        files::make_folder(&self.out)?;
        let count = pages.len() + 1;
        for (name, page) in pages.into_iter().chain([(NAME.into(), command)]) {
            let mut text = Vec::new();
            let told = Man::new(page.name(leaked(&name))).render(&mut text);
            told.map_err(|e| Error::new(format!("the manual cannot be made: {e}")))?;
            files::write(&self.out.join(format!("{name}.1")), text)?;
        }
        Ok(format!("{count} manual pages written to {}\n", self.out.display()))
    }
}

/// Names of commands are kept for as long as the program runs.
fn leaked(name: &str) -> &'static str {
    String::from(name).leak()
}
