//! Reads text tables as loggers, spreadsheets and boards write them: with any separator, lines before the header, decimal points
//! or commas, a header that is repeated after a restart, and a torn last line.

mod cell;
mod foreign;
mod header;
mod source;

use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord};

use super::left_out::LeftOut;
use super::quantities::Unit;
use mindgap_files::Records;
use mindgap_foundations::error::{Error, Result};

pub use self::cell::shortened;
pub use self::header::{Header, cells, lines};
pub use self::source::read as read_source;

/// A table with a header.
pub struct Table {
    /// File of the table.
    pub file: PathBuf,
    /// The header.
    pub header: Header,
    text: String,
}

/// A line of a table.
pub struct Line<'a> {
    table: &'a Table,
    /// Line number in the file.
    pub number: u64,
    /// How many times the header was repeated above this line.
    pub part: usize,
    record: &'a StringRecord,
}

/// Maximum length of the name of a column, bytes: messages show names.
const MAX_NAME: usize = 1000;
/// Maximum number of lines that a board may print between a reset and its header.
const MAX_BOOT_LINES: usize = 200;

impl Table {
    /// Finds the header of a text.
    ///
    /// # Errors
    /// When the text is empty, is another format or has no header.
    pub fn find(file: &Path, text: String) -> Result<Self> {
        let header = Header::find(&text).map_err(|(line, what)| match line {
            Some(line) => Error::at_line(file, line, what),
            None => Error::in_file(file, what),
        })?;
        match header.names.iter().find(|name| name.len() > MAX_NAME) {
            Some(name) => {
                let what = format!("the name of a column has {} characters: not a table", name.len());
                Err(Error::at_line(file, header.line, what))
            }
            None => Ok(Table { file: file.into(), header, text }),
        }
    }

    /// Makes a table of a text whose header is known.
    pub fn with(file: &Path, text: String, header: Header) -> Self {
        Table { file: file.into(), header, text }
    }

    /// Returns the names of the columns, as written.
    pub fn names(&self) -> &[String] {
        &self.header.names
    }

    /// Returns the unit in a row below the header, if there is one.
    pub fn unit(&self, column: usize) -> Option<Unit> {
        self.header.units.get(column).copied().flatten()
    }

    /// Calls `each` with the lines below the header, each with at least as many cells, and returns what was left out. Lines between
    /// a reset and the repeated header are left out, and so is the last line if it is torn.
    ///
    /// # Errors
    /// When a line is malformed, or `each` fails.
    pub fn for_each(&self, mut each: impl FnMut(&Line) -> Result<()>) -> Result<Vec<LeftOut>> {
        let mut left_out = self.header.left_out.clone();
        let Header { names, separator, body, lines_before, .. } = &self.header;
        let settings = settings(*separator);
        let normalised;
        let body = match separator {
            b' ' => {
                let line = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ") + "\n";
                normalised = self.text[body.clone()].lines().map(line).collect::<String>();
                &normalised
            }
            _ => &self.text[body.clone()],
        };
        let mut records = Records::with(&self.file, body.as_bytes(), &settings);
        let (mut record, mut part) = (StringRecord::new(), 0);
        // Malformed lines are fine only before a repeated header or at the end.
        let mut malformed: Vec<(u64, Error)> = Vec::new();
        let mut failed: Option<(u64, Error)> = None;
        while let Some(line) = records.read(&mut record)? {
            let number = lines_before + line;
            if let Some(torn) = header::repeats(names, &record) {
                part += 1;
                // The line before a restart may be torn within a number.
                malformed.extend(failed.take());
                let reason = match malformed.len() + usize::from(torn) {
                    0 => format!("line {number} has the header again"),
                    lines => format!("line {number} has the header again, after {lines} lines of a restart"),
                };
                left_out.push(LeftOut::rows("repeated header", 1 + malformed.len(), reason));
                malformed.clear();
                continue;
            }
            if let Some((_, error)) = failed.take() {
                return Err(error);
            }
            if is_comment(&record, names.len()) {
                continue;
            }
            if record.iter().any(|cell| cell.contains('\n')) {
                let what = "a quotation mark before this line is not closed";
                return Err(Error::at_line(&self.file, number, what));
            }
            if let Some(what) = self.malformed(&record) {
                if malformed.len() == MAX_BOOT_LINES {
                    break;
                }
                malformed.push((number, Error::at_line(&self.file, number, what)));
                continue;
            }
            if let Some((_, error)) = malformed.into_iter().next() {
                return Err(error);
            }
            malformed = Vec::new();
            let line = Line { table: self, number, part, record: &record };
            failed = each(&line).err().map(|error| (number, error));
        }
        let is_cut = !self.text.ends_with(['\n', '\r']);
        match (malformed.len(), failed) {
            (0, None) => {}
            (0, Some((line, _))) if is_cut => left_out.push(torn(line)),
            (1, None) => left_out.push(torn(malformed[0].0)),
            (0, Some((_, error))) => return Err(error),
            _ => return malformed.into_iter().next().map_or(Ok(left_out), |(_, error)| Err(error)),
        }
        Ok(left_out)
    }

    /// Returns the cells of the first line below the header.
    pub fn first_row(&self) -> Vec<String> {
        let first = self.text[self.header.body.clone()].lines().find(|line| !line.trim().is_empty());
        let mut reader = settings(self.header.separator).from_reader(first.unwrap_or_default().as_bytes());
        let record = reader.records().next().and_then(std::result::Result::ok).unwrap_or_default();
        record.iter().map(str::to_owned).collect()
    }

    /// Returns why the number of cells is wrong, if it is.
    fn malformed(&self, record: &StringRecord) -> Option<String> {
        let expected = self.header.names.len();
        if record.len() < expected {
            let count = record.len();
            return Some(format!("has {count} cells where the header has {expected}: incomplete or malformed line"));
        }
        let has_more = record.iter().skip(expected).any(|cell| !cell.is_empty());
        has_more.then(|| {
            let hint = if record.len() == 2 * expected && self.header.separator == b',' {
                "are the decimals separated by commas too? write points, or separate cells by semicolons"
            } else {
                "malformed line"
            };
            format!("has {} cells where the header has {expected}: {hint}", record.len())
        })
    }
}

impl Line<'_> {
    /// Returns the text of a cell.
    pub fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default()
    }

    /// Returns the number in a cell; `None` if it is empty or says that there is none. Infinity is allowed.
    ///
    /// # Errors
    /// When the cell is anything else.
    pub fn number(&self, column: usize) -> Result<Option<f64>> {
        let text = self.text(column);
        // Most cells are numbers, and no word for a missing one is a number.
        if let Some(number) = cell::number(text) {
            return Ok(Some(number));
        }
        if cell::is_missing(text) {
            return Ok(None);
        }
        let name = self.table.names().get(column).map_or("a cell", String::as_str);
        Err(self.error(format!("{} = {:?} is not a number", shortened(name), shortened(text))))
    }

    /// Returns an error at this line.
    pub fn error(&self, what: String) -> Error {
        Error::at_line(&self.table.file, self.number, what)
    }
}

fn settings(separator: u8) -> ReaderBuilder {
    let mut settings = ReaderBuilder::new();
    settings.has_headers(false).flexible(true).delimiter(separator).trim(csv::Trim::All);
    settings
}

fn torn(line: u64) -> LeftOut {
    LeftOut::rows("torn line", 1, format!("line {line}, the last line, is incomplete"))
}

/// Returns whether a record is a comment among the rows.
fn is_comment(record: &StringRecord, columns: usize) -> bool {
    record.len() < columns
        && record.get(0).is_some_and(|cell| cell.starts_with(header::COMMENT) && !cell::is_missing(cell))
}

#[cfg(test)]
mod tests;
