//! Runs the given cases: each has inputs like those of practitioners, and a script that ends with 0 where the answers are right.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use libtest_mimic::{Failed, Trial};
use mindgap_tests::command::{Sandbox, program};

/// Returns one test per case; a single ignored one without the folder of cases.
pub fn trials(cases: &Path) -> Vec<Trial> {
    let name = |case: &str| format!("given_cases::{case}");
    let Ok(listing) = fs::read_dir(cases) else {
        return vec![Trial::test(name("all"), || Ok(())).with_ignored_flag(true)];
    };
    let folders = listing.map(|entry| entry.expect("a case").path()).filter(|path| path.join("check.sh").exists());
    let mut names: Vec<String> =
        folders.map(|path| path.file_name().expect("a name").to_string_lossy().into_owned()).collect();
    names.sort();
    let trial = |case: String| {
        let cases = cases.to_owned();
        Trial::test(name(&case), move || answer_is_right(&cases, &case))
    };
    names.into_iter().map(trial).collect()
}

/// Runs a case in a copy of its folder; a wrong answer is the last line of its script.
fn answer_is_right(cases: &Path, case: &str) -> Result<(), Failed> {
    let (copy, programs) = (Sandbox::copy_of(&cases.join(case)), Sandbox::new());
    symlink(program(), programs.path().join("mindgap"))?;
    let path = format!("{}:{}", programs.path().display(), std::env::var("PATH").unwrap_or_default());
    let mut script = Command::new("sh");
    script.arg("check.sh").current_dir(copy.path()).env("CHECKING", cases.canonicalize()?).env("PATH", path);
    // Python must not write next to the cases.
    let output = script.env("PYTHONDONTWRITEBYTECODE", "1").output()?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    Err(said.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no output").into())
}
