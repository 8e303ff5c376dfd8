//! Runs the given cases: each has inputs like those of practitioners, and a script that ends with 0 where the answers are right.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use libtest_mimic::{Failed, Trial};
use mindgap_tests::command::program;

/// Beginnings of the names of cases whose answers are not right yet, with the reason. They are reported as ignored.
const NOT_YET: &[(&str, &str)] = &[];

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
        let is_ignored = NOT_YET.iter().any(|(name, _)| case.starts_with(name));
        let cases = cases.to_owned();
        Trial::test(name(&case), move || answer_is_right(&cases, &case)).with_ignored_flag(is_ignored)
    };
    names.into_iter().map(trial).collect()
}

/// Runs a case in a copy of its folder; a wrong answer is the last line of its script.
fn answer_is_right(cases: &Path, case: &str) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let [copy, programs] = ["case", "programs"].map(|name| folder.path().join(name));
    fs::create_dir(&copy)?;
    copy_files(&cases.join(case), &copy)?;
    fs::create_dir(&programs)?;
    symlink(program(), programs.join("mindgap"))?;
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    let mut script = Command::new("sh");
    script.arg("check.sh").current_dir(&copy).env("CHECKING", cases.canonicalize()?).env("PATH", path);
    // Python must not write next to the cases.
    let output = script.env("PYTHONDONTWRITEBYTECODE", "1").output()?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    Err(said.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no output").into())
}

/// Copies what is in a folder, but not its permissions: the originals may be read-only.
fn copy_files(from: &Path, to: &Path) -> std::io::Result<()> {
    for entry in fs::read_dir(from)? {
        let path = entry?.path();
        let copy = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            fs::create_dir(&copy)?;
            copy_files(&path, &copy)?;
        } else {
            fs::write(&copy, fs::read(&path)?)?;
        }
    }
    Ok(())
}
