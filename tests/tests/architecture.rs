//! ARCHITECTURE.md is short and true.

use std::fs;

use mindgap_tests::command::workspace;

fn text() -> String {
    fs::read_to_string(workspace().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md is there")
}

#[test]
fn it_stays_under_a_hundred_lines() {
    assert!(text().lines().count() < 100);
}

#[test]
fn every_path_that_it_names_exists() {
    let text = text();
    let paths: Vec<&str> = text.split('`').skip(1).step_by(2).filter(|word| word.contains(['/', '.'])).collect();
    assert!(paths.len() > 20, "the map names its paths in backticks");
    for path in paths {
        assert!(workspace().join(path).exists(), "{path} does not exist");
    }
}
