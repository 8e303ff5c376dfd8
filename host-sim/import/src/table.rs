//! A table as text: any separator, a header of any form, numbers with a point or a comma.

use std::iter;
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord};

use mindgap_files::{self as files, Records};
use mindgap_foundations::error::{Error, Result};

/// A table with a header.
pub struct Table {
    /// Its file.
    pub file: PathBuf,
    /// The names of its columns, as they stand there.
    pub names: Vec<String>,
    /// What is below the header.
    body: String,
    /// Number of the header's line.
    header_line: u64,
    separator: u8,
}

/// A line of a table.
pub struct Line<'a> {
    table: &'a Table,
    /// Its number in the file.
    pub number: u64,
    record: StringRecord,
}

/// What parts cells, besides blanks.
const SEPARATORS: [u8; 4] = [b',', b';', b'\t', b'|'];
/// What lines of comments begin with.
const COMMENT: [char; 2] = ['#', '%'];

impl Table {
    /// Reads a file's header.
    ///
    /// # Errors
    /// When the file cannot be read, or no line names columns.
    pub fn read(file: &Path) -> Result<Self> {
        let text = files::read_text(file)?;
        let mut lines = text.split_inclusive('\n').enumerate();
        let (mut header, mut begin, mut at) = (None, 0, 0);
        let first = lines.find_map(|(i, line)| {
            begin = at;
            at += line.len();
            let is_comment = line.starts_with(COMMENT);
            if is_comment {
                header = Some((i, line));
            }
            (!is_comment && !line.trim().is_empty()).then_some((i, line))
        });
        let Some(first) = first else { return Err(Error::in_file(file, "has no line but comments")) };
        // A header may be a comment, the last one before the numbers.
        let is_named = |line: &str| !cells(line, separator(line)).iter().any(|cell| number(cell, false).is_some());
        let ((line, header), begin) = match header {
            _ if is_named(first.1) => (first, at),
            Some((i, comment)) if separator(comment) == separator(first.1) => {
                ((i, comment.trim_start_matches(COMMENT)), begin)
            }
            _ => {
                let what =
                    "has numbers and no header: name the columns in a first line, such as t_s,x_m,y_m,heading_rad";
                return Err(Error::at_line(file, first.0 as u64 + 1, what));
            }
        };
        let separator = separator(header);
        let body = match separator {
            b' ' => {
                text[begin..].lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ") + "\n").collect()
            }
            _ => text[begin..].to_owned(),
        };
        Ok(Table { file: file.into(), names: cells(header, separator), body, header_line: line as u64 + 1, separator })
    }

    /// The lines below the header, each with as many cells as it.
    pub fn lines(&self) -> impl Iterator<Item = Result<Line<'_>>> {
        let mut settings = ReaderBuilder::new();
        settings.has_headers(false).flexible(true).delimiter(self.separator).trim(csv::Trim::All);
        let mut records = Records::with(&self.file, self.body.as_bytes(), &settings);
        let next = move || {
            let mut record = StringRecord::new();
            records.read(&mut record).transpose().map(|line| line.map(|line| (line, record)))
        };
        iter::from_fn(next).map(|read| {
            let (line, record) = read?;
            let number = self.header_line + line;
            if record.len() < self.names.len() {
                let what =
                    format!("has {} cells where the header has {}: torn or wrong line", record.len(), self.names.len());
                return Err(Error::at_line(&self.file, number, what));
            }
            Ok(Line { table: self, number, record })
        })
    }
}

impl Line<'_> {
    /// A cell's text.
    pub fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default()
    }

    /// A cell's number; `None` where it is empty or `nan`, infinite where it says so.
    ///
    /// # Errors
    /// When it is anything else.
    pub fn number(&self, column: usize) -> Result<Option<f64>> {
        let cell = self.text(column);
        if cell.is_empty() || ["nan", "na", "null", "none", "-"].contains(&cell.to_lowercase().as_str()) {
            return Ok(None);
        }
        let is_comma_decimal = self.table.separator != b',';
        number(cell, is_comma_decimal)
            .map(Some)
            .ok_or_else(|| self.error(format!("{} = {cell:?} is no number", self.table.names[column])))
    }

    /// What is wrong with this line.
    pub fn error(&self, what: String) -> Error {
        Error::at_line(&self.table.file, self.number, what)
    }
}

fn number(cell: &str, is_comma_decimal: bool) -> Option<f64> {
    let value = cell.parse::<f64>();
    let value = if is_comma_decimal { value.or_else(|_| cell.replacen(',', ".", 1).parse()) } else { value };
    value.ok().filter(|v| !v.is_nan())
}

/// The separator of which a header has most; blanks where it has none.
fn separator(header: &str) -> u8 {
    let count = |separator: &u8| header.bytes().filter(|b| b == separator).count();
    SEPARATORS.into_iter().rev().max_by_key(count).filter(|s| count(s) > 0).unwrap_or(b' ')
}

fn cells(line: &str, separator: u8) -> Vec<String> {
    let bare = |cell: &str| cell.trim().trim_matches('"').trim().to_owned();
    match separator {
        b' ' => line.split_whitespace().map(bare).collect(),
        _ => line.trim_end_matches(['\r', '\n']).split(char::from(separator)).map(bare).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Rows = Vec<Vec<Option<f64>>>;

    fn read(text: &str) -> Result<(Vec<String>, Rows)> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("t.csv");
        files::write(&file, text)?;
        let table = Table::read(&file)?;
        let rows = table.lines().map(|line| {
            let line = line?;
            (0..table.names.len()).map(|column| line.number(column)).collect()
        });
        Ok((table.names.clone(), rows.collect::<Result<_>>()?))
    }

    #[test]
    fn every_separator_and_header_is_read() {
        let expected =
            (vec!["t".to_owned(), "x m".to_owned()], vec![vec![Some(0.0), Some(1.5)], vec![Some(1.0), None]]);
        for text in [
            "t,x m\n0,1.5\n1,\n",
            "\u{feff}t;x m\r\n0;1,5\r\n1;\r\n",
            "# made by hand\n\nt\tx m\n0\t1.5\n1\tNaN\n",
            "\"t\" | \"x m\"\n0 | 1.5\n1 | nan\n",
            "# made by hand\n# t,x m\n0,1.5\n1,null\n",
        ] {
            assert_eq!(read(text).expect(text), expected, "{text:?}");
        }
        let blanks = read("% t   x\n  0   1.5\n1 -\n").expect("blanks");
        assert_eq!(blanks, (vec!["t".to_owned(), "x".to_owned()], expected.1));
    }

    #[test]
    fn what_is_no_table_is_refused_with_its_line() {
        for (text, what) in [
            ("", "has no line but comments"),
            ("# only words\n", "has no line but comments"),
            ("0,1.5\n1,2\n", ":1: has numbers and no header"),
            ("t,x\n0,1\n1\n", ":3: has 1 cells where the header has 2"),
            ("t,x\n0,1\n1,far\n", ":3: x = \"far\" is no number"),
            ("#c\nt,x\n0,1\n1,far\n", ":4: x = \"far\" is no number"),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(what), "{text:?} gave {error}");
        }
    }
}
