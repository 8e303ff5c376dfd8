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
    Order::parse(&text(), "## Which module may know which")
}

fn host_sim() -> Modules {
    Modules::read(&workspace().join("host-sim/src"))
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

/// What the workspace forbids, as `unsafe`, is forbidden in a crate that says so.
#[test]
fn every_crate_has_the_lints_of_the_workspace() {
    let read = |path: &str| fs::read_to_string(workspace().join(path)).expect("a manifest");
    let root = read("Cargo.toml");
    assert!(root.contains("unsafe_code = \"forbid\""));
    let members = root.lines().find_map(|line| line.strip_prefix("members = [")).expect("the members");
    for name in members.trim_end_matches(']').split(", ").map(|name| name.trim_matches('"')) {
        assert!(read(&format!("{name}/Cargo.toml")).contains("[lints]\nworkspace = true"), "{name}");
    }
}

#[test]
fn the_order_names_every_module_once() {
    let order = order();
    let once: BTreeSet<&str> = order.modules().into_iter().collect();
    assert_eq!(once.len(), order.modules().len(), "a module is listed twice: {:?}", order.modules());
    assert_eq!(once, host_sim().children(&[]), "left: listed, right: in host-sim/src");
}

#[test]
fn modules_know_only_those_that_come_before_them() {
    let edges = host_sim().edges(&[]);
    assert!(edges.len() > 30, "imports are found: {edges:?}");
    let broken = order().broken_by(&edges);
    assert!(broken.is_empty(), "these know what comes after them, or what is not for them to know:\n{broken:#?}");
}

#[test]
fn children_of_one_parent_know_each_other_without_circles() {
    let modules = host_sim();
    // The children of the root have their order above.
    let parents = modules.parents().filter(|parent| !parent.is_empty());
    let circles: Vec<Edge> = parents.flat_map(|parent| in_circles(&modules.edges(parent))).collect();
    assert!(circles.is_empty(), "these lead back to where they begin:\n{circles:#?}");
}

#[test]
fn core_and_export_have_no_import_circles() {
    for source in ["core/src", "controller-export/src"] {
        let modules = Modules::read(&workspace().join(source));
        let circles: Vec<Edge> = modules.parents().flat_map(|parent| in_circles(&modules.edges(parent))).collect();
        assert!(circles.is_empty(), "{source}: {circles:#?}");
    }
}
