//! Fuzzes one target with libFuzzer: `fuzz [OPTIONS] FOLDERS`, or `fuzz [OPTIONS] FILE` for one input.
//!
//! The name of the last folder, or of the folder of the file, selects the target.
#![no_main]

use std::env;
use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use mindgap_fuzz::{Target, targets};

static TARGET: LazyLock<&Target> = LazyLock::new(|| {
    let last = env::args().skip(1).rfind(|argument| !argument.starts_with('-')).expect("a folder of inputs");
    let last = Path::new(&last);
    let folder = if last.is_dir() { last } else { last.parent().expect("a file in a folder") };
    let name = folder.file_name().expect("a folder with a name").to_string_lossy();
    targets().find(|target| target.name == name).unwrap_or_else(|| panic!("there is no target {name}"))
});

// The first call prepares shared state, whose time and memory must not count against an input.
fuzz_target!(init: (TARGET.feed)(&[]), |bytes: &[u8]| (TARGET.feed)(bytes));
