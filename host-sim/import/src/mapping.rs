//! `map.toml`: assigns quantities to columns whose names are not recognised.
//!
//! It has one table per file, named after it, and one quantity per line: the name of a column, or a table of `column`, `unit`
//! and `negate`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::quantities::{QUANTITIES, Quantity, Unit};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// A parsed mapping file.
#[derive(Clone, Debug, Default)]
pub struct Mapping {
    files: BTreeMap<String, Vec<Mapped>>,
    path: PathBuf,
}

/// A column with its assigned quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapped {
    /// Quantity in the column.
    pub quantity: Quantity,
    /// Name of the range sensor, unless it is the first.
    pub sensor: Option<String>,
    /// Name of the column.
    pub column: String,
    /// Unit, if stated.
    pub unit: Option<Unit>,
    /// Whether the sign must be inverted.
    pub negate: bool,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Column(String),
    Full(FullEntry),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FullEntry {
    column: String,
    unit: Option<String>,
    #[serde(default)]
    negate: bool,
}

impl Mapping {
    /// Reads a mapping file.
    ///
    /// # Errors
    /// When it cannot be read or parsed, or names an unknown quantity or unit.
    pub fn read(path: &Path) -> Result<Self> {
        Mapping::parse(path, &files::read_text(path)?)
    }

    /// Parses the text of a mapping file; `path` is for messages.
    ///
    /// # Errors
    /// As [`Mapping::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let tables: BTreeMap<String, BTreeMap<String, Spanned<Entry>>> = files::from_toml(path, text)?;
        let columns = |table: BTreeMap<String, Spanned<Entry>>| {
            let mapped = table.into_iter().map(|(name, entry)| {
                let line = files::line_at(text, entry.span().start);
                mapped(&name, entry.into_inner()).map_err(|what| Error::at_line(path, line, what))
            });
            mapped.collect::<Result<Vec<_>>>()
        };
        let files = tables.into_iter().map(|(file, table)| Ok((file, columns(table)?))).collect::<Result<_>>()?;
        Ok(Mapping { files, path: path.into() })
    }

    /// Returns the columns assigned for a file, if the mapping names it.
    pub fn of(&self, file: &Path) -> Option<&[Mapped]> {
        self.files.get(file.file_name()?.to_str()?).map(Vec::as_slice)
    }

    /// Checks that all files named in the mapping are among the input files.
    ///
    /// # Errors
    /// When one is not.
    pub fn check(&self, inputs: &[PathBuf]) -> Result<()> {
        let is_input = |name: &str| inputs.iter().any(|file| file.file_name().is_some_and(|file| file == name));
        match self.files.keys().find(|name| !is_input(name)) {
            Some(name) => {
                Err(Error::in_file(&self.path, format!("has a table for {name:?}, which is not among the input files")))
            }
            None => Ok(()),
        }
    }
}

fn mapped(name: &str, entry: Entry) -> std::result::Result<Mapped, String> {
    let sensor = name.strip_prefix("range_").map(str::to_owned);
    let quantity = Quantity::from_name(if sensor.is_some() { "range" } else { name }).ok_or_else(|| {
        let names: Vec<&str> = QUANTITIES.iter().map(|(_, name, _)| *name).collect();
        format!("unknown quantity {name:?}; expected one of {}", names.join(", "))
    })?;
    let FullEntry { column, unit, negate } = match entry {
        Entry::Column(column) => FullEntry { column, unit: None, negate: false },
        Entry::Full(full) => full,
    };
    let unit = unit.map(|name| match Unit::from_name(&name) {
        Some(unit) if quantity.dimensions().contains(&unit.dimension) => Ok(unit),
        _ => Err(format!(
            "{name:?} is not a unit of {}: use s, ms, us, ns, m, cm, mm, rad, deg, m/s, cm/s, mm/s, rad/s, deg/s, rpm or, for \
             motors, the value of full command, such as 1 or 255",
            quantity.name()
        )),
    });
    Ok(Mapped { quantity, sensor, column, unit: unit.transpose()?, negate })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Mapping> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("map.toml");
        files::write(&path, text)?;
        Mapping::read(&path)
    }

    #[test]
    fn columns_are_assigned_with_unit_and_sign() {
        let mapping = read("[\"a.csv\"]\ntime = \"T\"\nturn = { column = \"w\", unit = \"deg/s\", negate = true }\n")
            .expect("fine");
        let columns = mapping.of(Path::new("folder/a.csv")).expect("named");
        assert_eq!((columns[0].quantity, columns[0].column.as_str()), (Quantity::Time, "T"));
        assert!(columns[1].negate && columns[1].unit == Unit::from_name("deg/s"));
        assert!(mapping.check(&[PathBuf::from("b.csv")]).is_err());
    }

    #[test]
    fn invalid_mapping_is_rejected_with_line_number() {
        for (text, what) in [
            ("[\"a.csv\"]\nspeed = \"v\"\n", "map.toml:2: unknown quantity \"speed\""),
            ("[\"a.csv\"]\nx = { column = \"x\", unit = \"deg\" }\n", "map.toml:2: \"deg\" is not a unit of x"),
            ("time = 3\n", "map.toml:1"),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(what), "{error}");
        }
    }
}
