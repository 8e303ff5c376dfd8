//! File names that an NXT accepts: at most 15 characters, a dot, and at most 3 more.

use std::fmt;
use std::str::FromStr;

use crate::error::ExportError;

const LONGEST_STEM: usize = 15;
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
    fn the_error_names_the_name_and_the_rule() {
        let message = BrickName::program("avoid-obstacles-1").unwrap_err().to_string();
        assert_eq!(
            message,
            "\"avoid-obstacles-1.rxe\" cannot be a file name on the brick: before the dot it needs 1 to 15 characters"
        );
    }
}
