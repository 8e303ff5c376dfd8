//! Exit codes of the measurement programs.

use std::process::ExitCode;

use mindgap_foundations::error::Result;

/// Returns success, or prints the error after the name of the program and returns failure.
pub fn exit_code(program: &str, result: Result<()>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{program}: {error}");
            ExitCode::FAILURE
        }
    }
}
