//! How programs that measure end.

use std::process::ExitCode;

use mindgap_foundations::error::Result;

/// Success, or failure after one line of why in the name of this program.
pub fn exit_code(program: &str, done: Result<()>) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{program}: {error}");
            ExitCode::FAILURE
        }
    }
}
