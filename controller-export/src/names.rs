//! File names that an NXT accepts: at most 15 characters, a dot, and at most 3 more.

use std::fmt;
use std::str::FromStr;

use crate::error::ExportError;

const LONGEST_STEM: usize = 15;
/// What the number of a run adds to a stem, as `_000`.
const RUN_NUMBER: usize = 4;
const LONGEST_EXTENSION: usize = 3;

/// The name of a file on the brick.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BrickName(String);

impl BrickName {
    /// The name of a compiled program, `STEM.rxe`.
    ///
    /// # Errors
    /// [`ExportError::Name`].
    pub fn program(stem: &str) -> Result<Self, ExportError> {
        format!("{stem}.rxe").parse()
    }

    /// The part before the dot.
    pub fn stem(&self) -> &str {
        self.0.split_once('.').map_or(&self.0, |(stem, _)| stem)
    }
}

/// The names of a program's logs, a new one each start: `avoid_000.csv`, `avoid_001.csv` and so on. Programs that collect
/// data name theirs `run-000.csv`, and no other program names a file like either.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunLogs {
    stem: String,
    extension: String,
}

impl RunLogs {
    /// The logs named after a file.
    ///
    /// # Errors
    /// [`ExportError::Name`] when the number of the run does not fit behind it.
    pub fn of(name: &BrickName) -> Result<Self, ExportError> {
        let (stem, extension) = name.0.split_once('.').unwrap_or((&name.0, ""));
        if stem.len() > LONGEST_STEM - RUN_NUMBER {
            let why = "the number of the run comes behind it, so before the dot it needs 1 to 11 characters";
            return Err(ExportError::Name { name: name.0.clone(), why });
        }
        Ok(RunLogs { stem: format!("{stem}_"), extension: extension.to_owned() })
    }

    /// The logs of programs that collect data.
    pub fn of_collector() -> Self {
        RunLogs { stem: "run-".to_owned(), extension: "csv".to_owned() }
    }

    /// What comes before the number of the run.
    pub fn stem(&self) -> &str {
        &self.stem
    }

    /// What comes after the dot.
    pub fn extension(&self) -> &str {
        &self.extension
    }

    /// The name of a run's log.
    pub fn name(&self, run: u16) -> String {
        format!("{}{run:03}.{}", self.stem, self.extension)
    }
}

impl FromStr for BrickName {
    type Err = ExportError;

    fn from_str(name: &str) -> Result<Self, ExportError> {
        let refused = |why| Err(ExportError::Name { name: name.to_owned(), why });
        let Some((stem, extension)) = name.split_once('.') else {
            return refused("it has no extension");
        };
        let fits = |part: &str, longest| (1..=longest).contains(&part.len());
        let known = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if !stem.chars().chain(extension.chars()).all(known) {
            return refused("only letters, digits, _ and - are safe, and one dot");
        }
        if !fits(stem, LONGEST_STEM) {
            return refused("before the dot it needs 1 to 15 characters");
        }
        if !fits(extension, LONGEST_EXTENSION) {
            return refused("after the dot it needs 1 to 3 characters");
        }
        Ok(BrickName(name.to_owned()))
    }
}

impl fmt::Display for BrickName {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_is_fifteen_and_three() {
        assert!("exactly-fifteen.rxe".parse::<BrickName>().is_ok());
        assert_eq!(BrickName::program("exactly-fifteen").map(|n| n.stem().len()), Ok(15));
        for refused in [
            "sixteen-letters-.rxe",
            "a.rxef",
            ".rxe",
            "a.",
            "a",
            "",
            "a.b.c",
            "r\u{e9}sum\u{e9}.txt",
            "a/b.rxe",
            "a\"b.rxe",
        ] {
            assert!(refused.parse::<BrickName>().is_err(), "{refused}");
        }
    }

    #[test]
    fn logs_of_runs_have_a_number_behind_the_name() {
        let logs = |name: &str| RunLogs::of(&name.parse().unwrap());
        assert_eq!(logs("elevenchars.csv").map(|logs| logs.name(7)), Ok("elevenchars_007.csv".to_owned()));
        assert!(logs("twelve-chars.csv").is_err());
        assert!(logs("run-000.csv").unwrap().name(0) != RunLogs::of_collector().name(0));
    }

    #[test]
    fn the_error_names_the_name_and_the_rule() {
        let message = BrickName::program("avoid-obstacles-1").unwrap_err().to_string();
        assert_eq!(
            message,
            "\"avoid-obstacles-1.rxe\" cannot be a file name on the brick: before the dot it needs 1 to 15 characters"
        );
    }
}
