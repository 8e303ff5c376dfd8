//! The documents are true: their command lines run and say what they are said to say, all others are calls that the command
//! takes, links lead somewhere, and the pages of commands are those that the command writes.
//!
//! Command lines that are not run, as those in blocks other than `console`, are reported as ignored, by name.
//! `MINDGAP_DOCS=slow cargo test -p mindgap-tests --test docs` runs those in `console,slow` too, `MINDGAP_DOCS=overwrite`
//! writes what is said now into the documents, and `MINDGAP_DOCS=slow,overwrite` does both.

mod book;
mod consoles;
mod lines;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};
use mindgap_tests::command::workspace;

/// Documents whose command lines begin with nothing but a scene; others find logs, a simulator and a controller.
const FROM_NOTHING: [&str; 2] = ["README.md", "docs/tutorial.md"];
/// Pages of commands, which hold examples and no walks.
const PAGES: &str = "docs/commands/";

fn main() -> ExitCode {
    let mut trials = vec![
        Trial::test("book: every document is in the summary once", book::every_document_is_in_the_summary_once),
        Trial::test("book: every link leads somewhere", book::every_link_leads_somewhere),
        Trial::test("book: the tutorial shows its scene", book::the_tutorial_shows_its_scene),
        Trial::test("book: pages of commands are those of the command", book::pages_are_those_of_the_command),
        Trial::test("book: the catalogue of effects is current", book::the_catalogue_of_effects_is_that_of_the_command),
        Trial::test("book: the schemas of outputs are current", book::schemas_are_those_of_the_command),
    ];
    for name in documents() {
        let text = fs::read_to_string(workspace().join(&name)).expect("a document that can be read");
        let all = lines::command_lines(&text);
        if !name.starts_with(PAGES) {
            for line in all.iter().filter(|line| !line.is_run) {
                let not_run = Trial::test(format!("{name}:{} {}", line.number, line.text), || Ok(()));
                trials.push(not_run.with_ignored_flag(true));
            }
        }
        if all.iter().any(|line| line.is_run) {
            let (name, text) = (name.clone(), text.clone());
            trials.push(Trial::test(format!("{name}: consoles"), move || consoles::run(&name, &text)));
        }
        if !all.is_empty() {
            trials.push(Trial::test(format!("{name}: calls"), move || lines::are_calls(&text)));
        }
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

/// Whether `$MINDGAP_DOCS` has a word.
fn is_asked_for(word: &str) -> bool {
    std::env::var("MINDGAP_DOCS").is_ok_and(|words| words.split(',').any(|other| other == word))
}

/// Returns the paths of all documents, relative to the top of the workspace: those at the top and all below `docs`.
fn documents() -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from("docs")];
    let is_document = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "md");
    found.extend(entries(Path::new("")).into_iter().filter(is_document));
    while let Some(folder) = folders.pop() {
        for path in entries(&folder) {
            if workspace().join(&path).is_dir() {
                folders.push(path);
            } else if is_document(&path) {
                found.push(path);
            }
        }
    }
    found.sort();
    found.into_iter().map(|path| path.to_string_lossy().into_owned()).collect()
}

/// Returns the paths of everything in a folder, relative to the top of the workspace.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(workspace().join(folder)).expect("a folder of documents");
    entries.map(|entry| folder.join(entry.expect("an entry").file_name())).collect()
}
