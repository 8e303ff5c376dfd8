//! Golden files: expected outputs, made with a fixed seed.

use std::fs;

use crate::command::workspace;

/// Expects a text to equal `tests/tests/golden/NAME`. `MINDGAP_BLESS=1` in the environment writes that file first.
#[track_caller]
pub fn assert_golden(name: &str, text: &str) {
    let path = workspace().join("tests/tests/golden").join(name);
    if std::env::var_os("MINDGAP_BLESS").is_some_and(|value| value == "1") {
        fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    }
    let golden = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert!(
        text == golden,
        "{} differs; if the change is intended, MINDGAP_BLESS=1 writes it. Now:\n{text}",
        path.display()
    );
}
