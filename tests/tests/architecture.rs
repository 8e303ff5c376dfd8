//! ARCHITECTURE.md is short and true.

use std::collections::BTreeSet;
use std::fs;

use mindgap_tests::command::workspace;
use mindgap_tests::module_order::{Order, quoted};
use mindgap_tests::modules::{Edge, Modules, in_circles};

fn text() -> String {
    fs::read_to_string(workspace().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md is there")
}

fn order() -> Order {
    Order::parse(&text(), "## Allowed dependencies between crates")
}

fn read(path: &str) -> String {
    fs::read_to_string(workspace().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The crates of the host, by the names of their folders.
fn crates() -> BTreeSet<String> {
    let folder = fs::read_dir(workspace().join("host-sim")).expect("the host's crates");
    folder.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8")).collect()
}

/// What a crate of the host depends on, its tests apart.
fn dependencies(name: &str) -> Vec<String> {
    let manifest: toml::Table = read(&format!("host-sim/{name}/Cargo.toml")).parse().expect("TOML");
    manifest["dependencies"].as_table().expect("a table").keys().cloned().collect()
}

#[test]
fn it_stays_under_a_hundred_lines() {
    assert!(text().lines().count() < 100);
}

#[test]
fn every_path_that_it_names_exists() {
    let paths: Vec<String> = quoted(&text()).into_iter().filter(|word| word.contains(['/', '.'])).collect();
    assert!(paths.len() > 20, "the map names its paths in backticks");
    for path in paths {
        assert!(workspace().join(&path).exists(), "{path} does not exist");
    }
}

/// A crate inherits what the workspace forbids, such as `unsafe`, only if its manifest says so. The module in a browser shares
/// memory with JavaScript: it denies `unsafe`, and one file expects it.
#[test]
fn every_crate_has_the_lints_of_the_workspace() {
    assert!(read("Cargo.toml").contains("unsafe_code = \"forbid\""));
    let others = ["core", "controller-export", "fuzz", "python", "tests"].map(str::to_owned);
    let ours = crates().into_iter().filter(|name| name != "browser").map(|name| format!("host-sim/{name}"));
    for folder in ours.chain(others) {
        assert!(read(&format!("{folder}/Cargo.toml")).contains("[lints]\nworkspace = true"), "{folder}");
    }
    assert!(read("host-sim/browser/Cargo.toml").contains("unsafe_code = \"deny\""));
    let sources = fs::read_dir(workspace().join("host-sim/browser/src")).expect("the sources of the module");
    let files = sources.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"));
    let with_unsafe: Vec<String> =
        files.filter(|file| read(&format!("host-sim/browser/src/{file}")).contains("unsafe")).collect();
    assert_eq!(with_unsafe, ["exports.rs"]);
}

#[test]
fn the_order_names_every_crate_once() {
    let order = order();
    let once: BTreeSet<String> = order.modules().into_iter().map(str::to_owned).collect();
    assert_eq!(once.len(), order.modules().len(), "a crate is listed twice: {:?}", order.modules());
    assert_eq!(once, crates(), "left: listed, right: in host-sim");
}

#[test]
fn crates_know_only_those_that_come_before_them() {
    let edges: Vec<Edge> = crates()
        .iter()
        .flat_map(|from| {
            let known =
                dependencies(from).into_iter().filter_map(|name| name.strip_prefix("mindgap-").map(str::to_owned));
            let known: Vec<String> = known.filter(|to| crates().contains(to)).collect();
            known.into_iter().map(move |to| Edge { from: from.clone(), witness: format!("{from} -> {to}"), to })
        })
        .collect();
    assert!(edges.len() > 30, "dependencies are found: {edges:?}");
    let broken = order().broken_by(&edges);
    assert!(broken.is_empty(), "these depend on a later or a private crate:\n{broken:#?}");
}

/// Python and a browser use the diagnosis without the command: data in, data out.
#[test]
fn models_and_diagnosis_know_neither_arguments_nor_threads_nor_clocks() {
    for name in ["models", "diagnosis"] {
        for unwanted in ["clap", "mindgap-workers", "indicatif", "jiff"] {
            assert!(!dependencies(name).contains(&unwanted.to_owned()), "{name} depends on {unwanted}");
        }
    }
    assert!(!dependencies("diagnosis").contains(&"mindgap-files".to_owned()));
}

#[test]
fn sibling_modules_know_each_other_without_circles() {
    let others = ["core", "controller-export"].map(str::to_owned);
    for name in crates().into_iter().map(|name| format!("host-sim/{name}")).chain(others) {
        let modules = Modules::read(&workspace().join(format!("{name}/src")));
        let circles: Vec<Edge> = modules.parents().flat_map(|parent| in_circles(&modules.edges(parent))).collect();
        assert!(circles.is_empty(), "{name}: these modules depend on each other in a circle:\n{circles:#?}");
    }
}

/// Pages name sources by their paths from the root; a word in capitals stands for any name.
#[test]
fn every_source_that_a_page_names_exists() {
    let roots = ["host-sim/", "core/", "controller-export/", "tests/", "python/", "fuzz/", "findings/"];
    let summary = read("docs/SUMMARY.md");
    let chapters = summary.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let pages: Vec<String> = chapters.map(|page| format!("docs/{page}")).chain(["README.md".into()]).collect();
    assert!(pages.len() > 20, "the book has many pages");
    for page in pages {
        let is_path =
            |word: &String| roots.iter().any(|root| word.starts_with(root)) && !word.contains(char::is_whitespace);
        let is_pattern = |word: &String| word.contains(['*', '<']) || word.contains(char::is_uppercase);
        for path in quoted(&read(&page)).into_iter().filter(|word| is_path(word) && !is_pattern(word)) {
            assert!(workspace().join(&path).exists(), "{page}: {path} does not exist");
        }
    }
}
