//! The commands in the order of work with an example of each, for `--help` and the manual.

use clap::{Command, CommandFactory};

use super::Cli;

/// A part of the work: its title, and its commands with an example each.
type Part = (&'static str, &'static [(&'static str, &'static str)]);

const WORK: &[Part] = &[
    ("Getting started", &[("demo", "mindgap demo --out tried")]),
    (
        "Logs",
        &[
            ("new", "mindgap new my-robot"),
            ("record", "mindgap record --out logs --runs 24 --effect slip"),
            (
                "import",
                "mindgap import run-000.csv track.csv --scene scene.toml --robot robot.toml --out logs\n  mindgap import streams recordings/*.csv --robot robot.toml --out logs\n  mindgap import bag recordings/drive --robot robot.toml --out logs",
            ),
            ("check", "mindgap check logs"),
        ],
    ),
    (
        "Simulator",
        &[
            ("train", "mindgap train logs --out simulator.json"),
            ("evaluate", "mindgap evaluate simulator.json other-logs --html evaluation.html"),
        ],
    ),
    (
        "Controller",
        &[
            ("evolve", "mindgap evolve simulator.json --scene scene.toml --start 1 --out controller.toml"),
            ("simulate", "mindgap simulate simulator.json controller.toml --scene scene.toml --html runs.html"),
        ],
    ),
    (
        "Robot",
        &[
            ("drive", "mindgap drive controller.toml --scene scene.toml --start 1 --out run.csv"),
            (
                "loop",
                "mindgap loop trials --sim simulator.json --scene scene.toml --start 1 --robot \"sh robot.sh\"\n  mindgap \
                 loop trials --sim simulator.json --scene scene.toml --robot ask    for a robot that a person starts",
            ),
            ("adapt", "mindgap adapt simulator.json robot-logs --out adapted.json"),
            ("export", "mindgap export controller.toml --format nxc --out controller.nxc"),
            ("brick", "mindgap brick controller.rxe --scene scene.toml"),
            ("crosscheck", "mindgap crosscheck simulator.json logs"),
            ("monitor", "mindgap monitor simulator.json robot-logs"),
        ],
    ),
    (
        "Gap",
        &[
            (
                "diagnose",
                "mindgap diagnose simulator.json logs --html gap.html\n  mindgap diagnose kinematic logs    against \
                 a textbook differential drive and an ideal sonar, from robot.toml alone\n  mindgap diagnose \
                 simulator.json robots --fleet answer    for many robots, one folder of logs each",
            ),
            (
                "compare",
                "mindgap compare simulator.mcap --real robot.mcap --robot robot.toml --html gap.html\n  mindgap compare \
                 simulator-logs --real robot-logs --patch robot.urdf=patched.urdf    writes the causes into a model file",
            ),
            ("bundle", "mindgap bundle simulator.json logs --out wrong.zip"),
            ("explain", "mindgap explain payload"),
            (
                "challenge",
                "mindgap challenge make --cases 40 --out blind\n  mindgap challenge answer blind\n  mindgap challenge score blind",
            ),
            ("serve", "mindgap serve --port 8000    for people who prefer a browser"),
        ],
    ),
    (
        "Files",
        &[
            ("info", "mindgap info simulator.json"),
            ("completions", "mindgap completions bash > ~/.local/share/bash-completion/completions/mindgap"),
            ("manual", "mindgap manual --out ~/.local/share/man/man1\n  mindgap manual --format markdown --out pages"),
            ("schema", "mindgap schema diagnose"),
        ],
    ),
];

const TEMPLATE: &str = "{about}\n\n{usage-heading} {usage}{after-help}\n\nOptions:\n{options}";

/// Returns the complete definition of the command line, for parsing, help, completion and manual.
pub fn command() -> Command {
    let examples = WORK.iter().flat_map(|(_, commands)| *commands);
    let command = examples.fold(Cli::command(), |command, (name, example)| {
        command.mut_subcommand(name, |of| {
            let own = of.get_after_help().map_or_else(String::new, |own| format!("\n\n{own}"));
            of.after_help(format!("Example:\n  {example}{own}"))
        })
    });
    let list = list(&command);
    command.help_template(TEMPLATE).after_help(list)
}

/// Returns the parts of the work in order, each with the names of its commands.
pub fn parts() -> impl Iterator<Item = (&'static str, impl Iterator<Item = &'static str>)> {
    WORK.iter().map(|(title, commands)| (*title, commands.iter().map(|(name, _)| *name)))
}

/// Returns the list of commands by part, each with its summary.
fn list(command: &Command) -> String {
    let width = parts().flat_map(|(_, names)| names).map(str::len).max().unwrap_or(0);
    let line = |name: &str| {
        let about = command.find_subcommand(name).and_then(Command::get_about);
        format!("  {name:<width$}  {}", about.map(ToString::to_string).unwrap_or_default())
    };
    let part = |(title, names)| {
        let lines: Vec<String> = Iterator::map(names, line).collect();
        format!("{title}:\n{}\n\n", lines.join("\n"))
    };
    parts().map(part).collect::<String>().trim_end().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_is_listed_with_an_example_that_calls_it() {
        let command = Cli::command();
        let mut all: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        let mut placed: Vec<&str> = WORK.iter().flat_map(|(_, commands)| *commands).map(|(name, _)| *name).collect();
        all.sort_unstable();
        placed.sort_unstable();
        assert_eq!(placed, all);
        for (name, example) in WORK.iter().flat_map(|(_, commands)| *commands) {
            assert!(example.starts_with(&format!("mindgap {name} ")), "{example}");
        }
        super::command().debug_assert();
    }
}
