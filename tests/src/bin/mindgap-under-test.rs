//! The command `mindgap` for the tests of this package: cargo builds no binary of another one for them.

use std::process::ExitCode;

fn main() -> ExitCode {
    mindgap_command::run()
}
