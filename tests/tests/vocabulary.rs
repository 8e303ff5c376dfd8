//! Words that the project does not use. CONTRIBUTING.md says more about its language.

use std::fs;
use std::path::{Path, PathBuf};

use mindgap_tests::command::workspace;

/// Words and phrases to avoid, each with what to write instead. A word that ends in `*` stands for all words that begin so.
/// Names count too: `left_out` and `LeftOut` are both "left out".
const AVOIDED: &[(&str, &str)] = &[
    ("anew", "again"),
    ("as good as", "almost"),
    ("askew", "misaligned"),
    ("aslant", "at an angle, obliquely"),
    ("bear* it out", "confirm it"),
    ("borne out", "confirmed"),
    ("broken off", "interrupted"),
    ("by whatever", "by any"),
    ("ever so many", "any number of"),
    ("feign*", "mimic"),
    ("foretell*", "predict"),
    ("foretold", "predicted"),
    ("gave way", "was overridden"),
    ("give* way", "is overridden, yields"),
    ("goes for nothing", "is ignored"),
    ("hereby", "with this"),
    ("herein", "here"),
    ("is no number", "is not a number"),
    ("kept back", "held out"),
    ("likelier", "more likely"),
    ("likeliest", "most likely"),
    ("mended", "fixed, with effects applied"),
    ("neither there nor absent", "untestable"),
    ("no half of", "no partial"),
    ("parted by", "separated by"),
    ("puts right", "corrects"),
    ("put right", "corrected"),
    ("put to right*", "corrected"),
    ("so many", "the number, or a name for it"),
    ("stand* beside", "is next to"),
    ("stand* once", "is defined once"),
    ("stand* twice", "is duplicated"),
    ("stood twice", "was duplicated"),
    ("the begin", "the beginning"),
    ("thereby", "so"),
    ("therein", "in it"),
    ("thereof", "of it"),
    ("told", "reported"),
    ("what is missing is told", "missing items are reported"),
    ("wherefrom", "from where"),
    ("wherein", "in which"),
    ("whereof", "of which"),
    ("whoever", "anyone who"),
];

/// Endings of the files that people read.
const READ_BY_PEOPLE: [&str; 7] = ["css", "js", "md", "mjs", "py", "rs", "sh"];
/// Folders without text of the project's own.
const NOT_OURS: [&str; 5] = [".git", "corpus", "node_modules", "target", "vendor"];
/// The files that list the words.
const LISTS: [&str; 2] = ["CONTRIBUTING.md", "tests/tests/vocabulary.rs"];

#[test]
fn no_file_uses_a_word_from_the_list() {
    let mut files = Vec::new();
    collect(workspace(), &mut files);
    assert!(files.len() > 100, "the project's files are found");
    let mut uses = Vec::new();
    for path in files {
        let name = path.strip_prefix(workspace()).expect("a file of the project").to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{name}: {e}"));
        if !LISTS.contains(&name.as_str()) {
            uses.extend(uses_in(&text).into_iter().map(|(line, advice)| format!("{name}:{line}: {advice}")));
        }
    }
    assert!(uses.is_empty(), "{} uses of words to avoid:\n{}", uses.len(), uses.join("\n"));
}

/// Collects the files below a folder that people read.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let is_named = |names: &[&str]| path.file_name().is_some_and(|name| names.iter().any(|other| name == *other));
        let ending = path.extension().and_then(|ending| ending.to_str());
        if path.is_dir() {
            if !is_named(&NOT_OURS) {
                collect(&path, files);
            }
        } else if ending.is_some_and(|ending| READ_BY_PEOPLE.contains(&ending)) {
            files.push(path);
        }
    }
}

/// Returns the line and the advice for each use of a word to avoid.
fn uses_in(text: &str) -> Vec<(usize, String)> {
    let words = words(text);
    let uses = AVOIDED.iter().flat_map(|(phrase, instead)| {
        let parts: Vec<&str> = phrase.split(' ').collect();
        let starts = words.windows(parts.len()).filter(move |window| {
            window.iter().zip(&parts).all(|((_, word), part)| match part.strip_suffix('*') {
                Some(stem) => word.starts_with(stem),
                None => word == part,
            })
        });
        let uses: Vec<_> = starts.map(|window| (window[0].0, format!("{phrase} -> {instead}"))).collect();
        uses
    });
    let mut uses: Vec<(usize, String)> = uses.collect();
    uses.sort();
    uses
}

/// Splits a text into its words in lower case, each with its line from 1. The parts of a name are words too.
fn words(text: &str) -> Vec<(usize, String)> {
    let mut words = Vec::new();
    for (line, text) in text.lines().enumerate() {
        let mut word = String::new();
        let mut before = ' ';
        // The blank ends the last word.
        for letter in text.chars().chain([' ']) {
            let begins_a_word = !letter.is_alphabetic() || letter.is_uppercase() && before.is_lowercase();
            if begins_a_word && !word.is_empty() {
                words.push((line + 1, std::mem::take(&mut word)));
            }
            if letter.is_alphabetic() {
                word.extend(letter.to_lowercase());
            }
            before = letter;
        }
    }
    words
}

#[test]
fn words_are_found_in_prose_in_names_and_across_lines() {
    let lines = |text| uses_in(text).into_iter().map(|(line, _)| line).collect::<Vec<_>>();
    assert_eq!(lines("It is told.\nfn told_once() {}\nstruct Told;\n// it is put\n// right\n"), [1, 2, 3, 4]);
    assert_eq!(lines("What it foretells was feigned"), [1, 1]);
    assert_eq!(lines("an untold story of many so-called numbers, put upright"), [0; 0]);
}
