//! `mindgap completions` and `mindgap manual`: made from the definitions by which the command is parsed.

mod markdown;

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::{Args, Command, ValueEnum};
use clap_complete::Shell;
use clap_mangen::Man;

use super::{Run, guide};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};

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
    /// What they are written in.
    #[arg(long, value_enum, default_value_t = Format::Man)]
    format: Format,
}

/// A format of manual pages.
#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// For the command `man`.
    Man,
    /// For a book or a browser.
    Markdown,
}

const NAME: &str = "mindgap";
/// What clap adds to the commands.
const HELP: &str = "help";

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
        let mut command = guide::command();
        command.build();
        let of_command = |of: &Command| (format!("{NAME}-{}", of.get_name()), of.clone());
        let mut pages: Vec<(String, Command)> =
            command.get_subcommands().filter(|of| of.get_name() != HELP).map(of_command).collect();
        pages.push((NAME.into(), command));
        let count = pages.len();
        let files = pages.into_iter().map(|(name, page)| {
            let (ending, text) = match self.format {
                Format::Man => ("1", man(page.name(leaked(&name)))?),
                Format::Markdown if name == NAME => ("md", markdown::overview(&page).into_bytes()),
                Format::Markdown => ("md", markdown::page(&page).into_bytes()),
            };
            Ok((format!("{name}.{ending}"), text))
        });
        let files: BTreeMap<String, Vec<u8>> = files.collect::<Result<_>>()?;
        files::write_folder(
            &self.out,
            |name| files.contains_key(name),
            |fresh| files.iter().try_for_each(|(name, text)| files::write(&fresh.join(name), text)),
        )?;
        Ok(format!("{count} manual pages written to {}\n", self.out.display()))
    }
}

fn man(page: Command) -> Result<Vec<u8>> {
    let mut text = Vec::new();
    let told = Man::new(page).render(&mut text);
    told.map_err(|e| Error::new(format!("the manual cannot be made: {e}")))?;
    Ok(text)
}

/// Names of commands are kept for as long as the program runs.
fn leaked(name: &str) -> &'static str {
    String::from(name).leak()
}
