//! Tables of motion capture and of ROS whose columns are known from the lines above them, or from their number.

mod headerless;
mod motive;
mod qualisys;
mod vicon;

use std::path::Path;

use super::column::Column;
use super::columns::Columns;
use super::quantities::{Dimension, Unit};
use super::table::{Header, Table, read_source};
use mindgap_foundations::error::{Error, Result};

/// A table, with its columns if their layout is known.
pub struct Opened {
    /// The table.
    pub table: Table,
    /// The known columns.
    pub columns: Option<Columns>,
    /// Name of the format.
    pub format: &'static str,
}

/// Header and columns of a known format.
type Layout = (Header, Columns);
/// Recognises a format; `None` if it is another one, an error message with its line if it cannot be read.
type Recognise = fn(&str) -> Option<std::result::Result<Layout, (u64, String)>>;

const FORMATS: [(&str, Recognise); 4] = [
    ("motion capture by Motive", motive::layout),
    ("motion capture by Vicon", vicon::layout),
    ("motion capture by Qualisys", qualisys::layout),
    ("rows without a header", headerless::layout),
];

/// Opens a table.
///
/// # Errors
/// When it cannot be read, is another format or has no header.
pub fn open(file: &Path) -> Result<Opened> {
    let text = read_source(file)?;
    for (format, recognise) in FORMATS {
        if let Some(layout) = recognise(&text) {
            let (header, columns) = layout.map_err(|(line, what)| Error::at_line(file, line, what))?;
            return Ok(Opened { table: Table::with(file, text, header), columns: Some(columns), format });
        }
    }
    Ok(Opened { table: Table::find(file, text)?, columns: None, format: "a table" })
}

/// Returns a unit of time, of this many ms.
fn ms(factor: f64) -> Option<Unit> {
    Some(Unit { dimension: Dimension::Time, factor })
}

/// Returns a unit of length, of this many cm.
fn cm(factor: f64) -> Option<Unit> {
    Some(Unit { dimension: Dimension::Length, factor })
}

/// Returns a plain number's column.
fn plain(index: usize, name: &str) -> Option<Column> {
    Some(Column::of(index, name, None))
}

#[cfg(test)]
mod tests;
