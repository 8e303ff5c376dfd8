//! Golden files: what the program once wrote, with the seed that made it.

use std::fs;

use crate::command::workspace;

/// Compares with `tests/tests/golden/NAME`. With `MINDGAP_BLESS=1` in the environment writes that file instead.
#[track_caller]
pub fn assert_golden(name: &str, text: &str) {
    let path = workspace().join("tests/tests/golden").join(name);
    if std::env::var_os("MINDGAP_BLESS").is_some_and(|value| value == "1") {
        fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    }
    let golden = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert!(text == golden, "{} differs; if that is meant, MINDGAP_BLESS=1 renews it. Now:\n{text}", path.display());
}
