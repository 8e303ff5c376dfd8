//! ARCHITECTURE.md is short and true.

use std::collections::BTreeSet;
use std::fs;

use mindgap_tests::command::workspace;
use mindgap_tests::modules::{Modules, in_circles, out_of_order};

fn text() -> String {
    fs::read_to_string(workspace().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md is there")
}

/// The words in backticks.
fn quoted(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn host_sim() -> Modules {
    Modules::read(&workspace().join("host-sim/src"))
}

/// The lines of the list that orders modules: the names of each, and who alone may know them, where that is said.
fn order() -> Vec<(Vec<String>, Option<Vec<String>>)> {
    let text = text();
    let (_, section) = text.split_once("\n## Which module may know which\n").expect("the section on order");
    let lines = section.lines().take_while(|line| !line.starts_with("## ")).filter(|line| line.starts_with("- "));
    lines
        .map(|line| {
            let (names, meaning) = line.split_once(':').expect("names, a colon, and what they are");
            (quoted(names), meaning.split_once("known only to").map(|(_, those)| quoted(those)))
        })
        .collect()
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

#[test]
fn the_order_names_every_module_once() {
    let listed: Vec<String> = order().into_iter().flat_map(|(names, _)| names).collect();
    let once: BTreeSet<&str> = listed.iter().map(String::as_str).collect();
    assert_eq!(once.len(), listed.len(), "a module is listed twice: {listed:?}");
    assert_eq!(once, host_sim().children(&[]), "left: listed, right: in host-sim/src");
}

#[test]
fn modules_know_only_those_that_come_before_them() {
    let edges = host_sim().edges(&[]);
    assert!(edges.len() > 30, "imports are found: {edges:?}");
    let order = order();
    let names: Vec<String> = order.iter().flat_map(|(names, _)| names.clone()).collect();
    let wrong = out_of_order(&edges, &names);
    assert!(wrong.is_empty(), "these know what comes after them:\n{wrong:#?}");
    for (names, those) in &order {
        let Some(those) = those else { continue };
        let others = edges.iter().filter(|edge| names.contains(&edge.to) && !names.contains(&edge.from));
        let wrong: Vec<_> = others.filter(|edge| !those.contains(&edge.from)).collect();
        assert!(wrong.is_empty(), "only {those:?} may know {names:?}:\n{wrong:#?}");
    }
}

#[test]
fn children_of_one_parent_know_each_other_without_circles() {
    let modules = host_sim();
    // The children of the root have their order above.
    let circles: Vec<_> = modules
        .parents()
        .filter(|parent| !parent.is_empty())
        .flat_map(|parent| in_circles(&modules.edges(parent)))
        .collect();
    assert!(circles.is_empty(), "these lead back to where they begin:\n{circles:#?}");
}
