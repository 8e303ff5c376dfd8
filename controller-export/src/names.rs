//! File names that an NXT accepts: at most 15 characters, a dot, and at most 3 more.

use std::fmt;
use std::str::FromStr;

use crate::error::ExportError;

const LONGEST_STEM: usize = 15;
/// Length of the run number that is appended to a stem, as in `_000`.
const RUN_NUMBER: usize = 4;
const LONGEST_EXTENSION: usize = 3;

/// The name of a file on the brick.
///
/// ```
/// use mindgap_controller_export::names::BrickName;
///
/// let name = BrickName::program("avoid")?;
/// assert_eq!((name.to_string().as_str(), name.stem()), ("avoid.rxe", "avoid"));
/// assert!("sixteen-letters-.rxe".parse::<BrickName>().is_err());
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BrickName(String);

impl BrickName {
    /// Returns the name of a compiled program, `STEM.rxe`.
    ///
    /// # Errors
    /// Returns [`ExportError::Name`] when the brick would refuse the name.
    pub fn program(stem: &str) -> Result<Self, ExportError> {
        format!("{stem}.rxe").parse()
    }

    /// Returns the part before the dot.
    pub fn stem(&self) -> &str {
        self.0.split_once('.').map_or(&self.0, |(stem, _)| stem)
    }
}

/// The names of a program's logs. Every start of the program writes a new one: `avoid_000.csv`, `avoid_001.csv` and so on.
///
/// Programs that collect data name theirs `run-000.csv`; the hyphen keeps these names apart from those of other programs.
///
/// ```
/// use mindgap_controller_export::names::RunLogs;
///
/// let logs = RunLogs::named_after(&"avoid.csv".parse()?)?;
/// assert_eq!(logs.name(7), "avoid_007.csv");
/// # Ok::<(), mindgap_controller_export::ExportError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunLogs {
    stem: String,
    extension: String,
}

impl RunLogs {
    /// Returns logs that are named after a file.
    ///
    /// # Errors
    /// Returns [`ExportError::Name`] when the name leaves no room for the run number.
    pub fn named_after(name: &BrickName) -> Result<Self, ExportError> {
        let (stem, extension) = name.0.split_once('.').unwrap_or((&name.0, ""));
        if stem.len() > LONGEST_STEM - RUN_NUMBER {
            let why = "the run number is appended to it, so it needs 1 to 11 characters before the dot";
            return Err(ExportError::Name { name: name.0.clone(), why });
        }
        Ok(RunLogs { stem: format!("{stem}_"), extension: extension.to_owned() })
    }

    /// Returns the logs of programs that collect data.
    pub fn for_collection() -> Self {
        RunLogs { stem: "run-".to_owned(), extension: "csv".to_owned() }
    }

    /// Returns the part of the names before the run number.
    pub fn stem(&self) -> &str {
        &self.stem
    }

    /// Returns the part of the names after the dot.
    pub fn extension(&self) -> &str {
        &self.extension
    }

    /// Returns the name of a run's log.
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
            return refused("only letters, digits, _ and - are allowed, and one dot");
        }
        if !fits(stem, LONGEST_STEM) {
            return refused("it needs 1 to 15 characters before the dot");
        }
        if !fits(extension, LONGEST_EXTENSION) {
            return refused("it needs 1 to 3 characters after the dot");
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
    fn name_has_at_most_fifteen_and_three_characters() {
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
    fn log_names_end_with_the_run_number() {
        let logs = |name: &str| RunLogs::named_after(&name.parse().unwrap());
        assert_eq!(logs("elevenchars.csv").map(|logs| logs.name(7)), Ok("elevenchars_007.csv".to_owned()));
        assert!(logs("twelve-chars.csv").is_err());
        assert!(logs("run-000.csv").unwrap().name(0) != RunLogs::for_collection().name(0));
    }

    #[test]
    fn error_states_the_name_and_the_rule() {
        let message = BrickName::program("avoid-obstacles-1").unwrap_err().to_string();
        assert_eq!(
            message,
            "\"avoid-obstacles-1.rxe\" cannot be a file name on the brick: it needs 1 to 15 characters before the dot"
        );
    }
}
