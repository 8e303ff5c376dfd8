//! The command `mindgap`.

use std::process::ExitCode;

fn main() -> ExitCode {
    mindgap_command::run()
}
