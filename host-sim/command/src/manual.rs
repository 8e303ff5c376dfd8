//! `mindgap completions` and `mindgap manual`, generated from the definition of the command line.

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
use mindgap_foundations::executor::Executor;

/// Generate a shell completion script.
#[derive(Args)]
pub struct Completions {
    /// Shell to generate the script for.
    shell: Shell,
}

/// Write manual pages, one per command.
#[derive(Args)]
pub struct Manual {
    /// Output folder.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Format of the pages.
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
/// Subcommand that clap adds.
const HELP: &str = "help";

impl Run for Completions {
    fn places(&self) -> Places {
        Places::default()
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut guide::command(), NAME, &mut script);
        let printed = files::to_standard_output(&script);
        printed.map_err(|e| Error::new(format!("cannot write to standard output: {e}")))?;
        Ok(String::new())
    }
}

impl Run for Manual {
    fn places(&self) -> Places {
        Places::default().filling([&self.out])
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
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
    Man::new(page).render(&mut text).map_err(|e| Error::new(format!("cannot render the manual: {e}")))?;
    Ok(text)
}

/// Leaks a name, since clap needs names that live as long as the program.
fn leaked(name: &str) -> &'static str {
    String::from(name).leak()
}
