//! Logs from elsewhere: other robots, other programs. They are not part of the project, so most machines lack them.

use std::io::{self, Write};
use std::path::PathBuf;

use crate::command::workspace;

/// A path among the logs from elsewhere, which lie in `$MINDGAP_SHARED` or in `shared` beside the workspace. Without
/// them says on standard output, past the test harness that would keep it back, that `test` is skipped.
pub fn logs_from_elsewhere(test: &str, path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("MINDGAP_SHARED").map_or_else(|| workspace().join("../shared"), PathBuf::from);
    if folder.is_dir() {
        let path = folder.join(path);
        assert!(path.exists(), "{} is missing among the logs from elsewhere", path.display());
        Some(path)
    } else {
        writeln!(io::stdout(), "SKIPPED {test}: logs from elsewhere are not here").expect("standard output is open");
        None
    }
}
