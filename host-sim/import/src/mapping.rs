//! `map.toml`: which columns hold what, where their names do not say it.
//!
//! A table a file, by its name, with a quantity a line: the name of a column, or a table of `column`, `unit` and `negate`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use super::quantities::{QUANTITIES, Quantity, Unit};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// What a file says about the columns of others.
#[derive(Clone, Debug, Default)]
pub struct Mapping {
    files: BTreeMap<String, Vec<Mapped>>,
    path: PathBuf,
}

/// A column and what it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapped {
    /// What it holds.
    pub quantity: Quantity,
    /// Its name.
    pub column: String,
    /// Its unit, if that is stated here.
    pub unit: Option<Unit>,
    /// Whether the other sign is meant.
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
    /// Reads a file.
    ///
    /// # Errors
    /// When it cannot be read or parsed, or names a quantity or unit that there is not.
    pub fn read(path: &Path) -> Result<Self> {
        let text = files::read_text(path)?;
        let tables: BTreeMap<String, BTreeMap<String, Spanned<Entry>>> = files::from_toml(path, &text)?;
        let columns = |table: BTreeMap<String, Spanned<Entry>>| {
            let mapped = table.into_iter().map(|(name, entry)| {
                let line = files::line_at(&text, entry.span().start);
                mapped(&name, entry.into_inner()).map_err(|what| Error::at_line(path, line, what))
            });
            mapped.collect::<Result<Vec<_>>>()
        };
        let files = tables.into_iter().map(|(file, table)| Ok((file, columns(table)?))).collect::<Result<_>>()?;
        Ok(Mapping { files, path: path.into() })
    }

    /// The columns of a file that it names, if it names the file.
    pub fn of(&self, file: &Path) -> Option<&[Mapped]> {
        self.files.get(file.file_name()?.to_str()?).map(Vec::as_slice)
    }

    /// Checks that every file that it names is among `read`.
    ///
    /// # Errors
    /// Names the first one that is not.
    pub fn check(&self, read: &[PathBuf]) -> Result<()> {
        let is_read = |name: &str| read.iter().any(|file| file.file_name().is_some_and(|file| file == name));
        match self.files.keys().find(|name| !is_read(name)) {
            Some(name) => {
                Err(Error::in_file(&self.path, format!("has a table for {name:?}, which is not among the files")))
            }
            None => Ok(()),
        }
    }
}

fn mapped(name: &str, entry: Entry) -> std::result::Result<Mapped, String> {
    let quantity = Quantity::of_name(name).ok_or_else(|| {
        let names: Vec<&str> = QUANTITIES.iter().map(|(_, name, _)| *name).collect();
        format!("{name:?} is nothing that a column can hold: write one of {}", names.join(", "))
    })?;
    let FullEntry { column, unit, negate } = match entry {
        Entry::Column(column) => FullEntry { column, unit: None, negate: false },
        Entry::Full(full) => full,
    };
    let unit = unit.map(|name| match Unit::of_name(&name) {
        Some(unit) if quantity.dimensions().contains(&unit.dimension) => Ok(unit),
        _ => Err(format!(
            "{name:?} is no unit of {}: write s, ms, us, ns, m, cm, mm, rad, deg, m/s, cm/s, mm/s, rad/s, deg/s, rpm or, for \
             motors, what they get at full command, such as 1 or 255",
            quantity.name()
        )),
    });
    Ok(Mapped { quantity, column, unit: unit.transpose()?, negate })
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
    fn columns_are_named_with_unit_and_sign() {
        let mapping = read("[\"a.csv\"]\ntime = \"T\"\nturn = { column = \"w\", unit = \"deg/s\", negate = true }\n")
            .expect("fine");
        let columns = mapping.of(Path::new("folder/a.csv")).expect("named");
        assert_eq!((columns[0].quantity, columns[0].column.as_str()), (Quantity::Time, "T"));
        assert!(columns[1].negate && columns[1].unit == Unit::of_name("deg/s"));
        assert!(mapping.check(&[PathBuf::from("b.csv")]).is_err());
    }

    #[test]
    fn what_is_no_mapping_is_refused_with_its_line() {
        for (text, what) in [
            ("[\"a.csv\"]\nspeed = \"v\"\n", "map.toml:2: \"speed\" is nothing that a column can hold"),
            ("[\"a.csv\"]\nx = { column = \"x\", unit = \"deg\" }\n", "map.toml:2: \"deg\" is no unit of x"),
            ("time = 3\n", "map.toml:1"),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(what), "{error}");
        }
    }
}
