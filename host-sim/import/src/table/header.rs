//! Finds the header of a table: the first line of names with a line of numbers of the same length below it.

use std::ops::Range;

use csv::StringRecord;

use super::cell::{is_missing, number, shortened};
use super::foreign;
use crate::left_out::LeftOut;
use crate::quantities::Unit;
use crate::timestamps::Stamp;

/// The header of a table.
pub struct Header {
    /// Names of the columns, as written.
    pub names: Vec<String>,
    /// Units in a row below the names; empty if there is none.
    pub units: Vec<Option<Unit>>,
    /// Line number of the names.
    pub line: u64,
    /// Separator of cells; a space stands for any whitespace.
    pub separator: u8,
    /// The rows, as bytes of the text.
    pub body: Range<usize>,
    /// Number of lines before the rows.
    pub lines_before: u64,
    /// What was skipped.
    pub left_out: Vec<LeftOut>,
}

/// Separators of cells, besides whitespace.
const SEPARATORS: [u8; 4] = [b',', b';', b'\t', b'|'];
/// First characters of comment lines.
pub const COMMENT: [char; 2] = ['#', '%'];
/// Number of lines among which the header is.
const MAX_LINES: usize = 1000;

/// A line of a text.
pub struct TextLine<'a> {
    /// Its number, from 1.
    pub number: u64,
    /// The byte at which it starts.
    pub start: usize,
    /// Its text, without the line end.
    pub text: &'a str,
}

/// Returns the first lines of a text that are not blank.
pub fn lines(text: &str) -> Vec<TextLine<'_>> {
    let mut start = 0;
    let lines = text.split_inclusive('\n').take(MAX_LINES).zip(1..).map(|(line, number)| {
        let trimmed = TextLine { number, start, text: line.trim_end_matches(['\n', '\r']) };
        start += line.len();
        trimmed
    });
    lines.filter(|line| !line.text.trim().is_empty()).collect()
}

impl Header {
    /// Finds the header of a text.
    ///
    /// # Errors
    /// When there is none: the line, if there is one, and a message.
    pub fn find(text: &str) -> Result<Self, (Option<u64>, String)> {
        let lines = lines(text);
        let Some(first) = lines.first() else { return Err((None, "is empty".into())) };
        if let Some(what) = foreign::refusal(text) {
            return Err((None, what));
        }
        let stated = stated_separator(first.text);
        let skipped = usize::from(stated.is_some());
        let rest = &lines[skipped..];
        let found = (0..rest.len()).find_map(|i| header_at(text, &rest[i..], stated));
        let header = found.or_else(|| rest.iter().find_map(|line| without_rows(text, line, stated)));
        let Some(mut header) = header else {
            let is_comment = |line: &TextLine| line.text.starts_with(COMMENT);
            return Err(match rest.iter().find(|line| !is_comment(line)) {
                None => (None, "contains only comments".into()),
                Some(line) if cells(line.text, separator(line.text)).iter().any(|cell| is_value(cell)) => {
                    let what = "has numbers but no header: name the columns in the first line, such as t_s,x_m,y_m,heading_rad";
                    (Some(line.number), what.into())
                }
                Some(line) => (Some(line.number), format!("is not a table: it says {:?}", shortened(line.text))),
            });
        };
        let before = rest.iter().filter(|line| line.number < header.line);
        let skipped: Vec<&TextLine> = before.filter(|line| !line.text.starts_with(COMMENT)).collect();
        if let Some(first) = skipped.first() {
            let reason =
                format!("before its header, which is line {}; the first is {:?}", header.line, shortened(first.text));
            header.left_out.push(LeftOut::rows("skipped lines", skipped.len(), reason));
        }
        Ok(header)
    }

    /// Returns the header of rows that have none, from line `lines_before + 1` on.
    pub fn given(names: Vec<String>, separator: u8, body: Range<usize>, lines_before: u64) -> Self {
        Header { names, units: Vec::new(), line: lines_before, separator, body, lines_before, left_out: Vec::new() }
    }
}

/// Returns whether a record repeats the header; if so, whether it begins with a torn line.
pub fn repeats(names: &[String], record: &StringRecord) -> Option<bool> {
    let extra = record.len().checked_sub(names.len())?;
    let bare = |cell: &str| cell.trim_start_matches(COMMENT).trim().trim_matches('"').to_owned();
    let matches = record.iter().skip(extra).zip(names).skip(1).all(|(cell, name)| bare(cell) == *name);
    let first = record.get(extra)?;
    let is_whole = bare(first) == names[0] && (extra == 0 || record.iter().skip(names.len()).all(str::is_empty));
    let is_glued = first.len() > names[0].len() && first.ends_with(&names[0]);
    (names.len() > 1 && matches && (is_whole || is_glued)).then_some(!is_whole)
}

/// Returns the header in the first of these lines, if the next one holds numbers.
fn header_at(text: &str, lines: &[TextLine], stated: Option<u8>) -> Option<Header> {
    let line = &lines[0];
    let bare = line.text.trim_start_matches(COMMENT);
    let separator = stated.unwrap_or_else(|| separator(bare));
    let names = cells(bare, separator);
    if names.len() < 2 || names.iter().any(|name| is_value(name)) {
        return None;
    }
    let mut below =
        lines[1..].iter().filter(|line| !line.text.starts_with(COMMENT) || line.text.starts_with("#N")).peekable();
    let in_cells = |line: &TextLine| cells(line.text, separator);
    let units: Vec<Option<Unit>> = match below.peek().map(|line| units(&in_cells(line))) {
        Some(units) if units.iter().any(Option::is_some) => {
            below.next();
            units
        }
        _ => Vec::new(),
    };
    let is_row = |line: &TextLine| {
        let cells = in_cells(line);
        let has_as_many = cells.len() >= names.len() && cells[names.len()..].iter().all(String::is_empty);
        has_as_many && cells.iter().any(|cell| is_value(cell))
    };
    let (first, second) = (below.next()?, below.next());
    // Most of a row are numbers, or the next line is one too: a line of text may hold a number.
    if !is_row(first) || second.is_some_and(|line| !is_row(line)) && !is_row_like(&in_cells(first)) {
        return None;
    }
    let lines_before = first.number - 1;
    Some(Header {
        names,
        units,
        line: line.number,
        separator,
        body: first.start..text.len(),
        lines_before,
        left_out: Vec::new(),
    })
}

/// Returns whether at least half of the cells of a row are numbers.
fn is_row_like(cells: &[String]) -> bool {
    2 * cells.iter().filter(|cell| is_missing(cell) || is_value(cell)).count() >= cells.len()
}

/// Returns the header in a line of names, whatever follows.
fn without_rows(text: &str, line: &TextLine, stated: Option<u8>) -> Option<Header> {
    if line.text.starts_with(COMMENT) {
        return None;
    }
    let separator = stated.unwrap_or_else(|| separator(line.text));
    let names = cells(line.text, separator);
    let end = text[line.start..].find('\n').map_or(text.len(), |end| line.start + end + 1);
    (names.len() > 1 && separator != b' ' && !names.iter().any(|name| is_value(name)))
        .then(|| Header { line: line.number, ..Header::given(names, separator, end..text.len(), line.number) })
}

/// Returns the separator that a spreadsheet states in the first line, as in `sep=;`.
fn stated_separator(line: &str) -> Option<u8> {
    let line = line.trim().trim_matches('"').to_ascii_lowercase();
    let stated = line.strip_prefix("sep=")?;
    match stated.as_bytes() {
        [] => Some(b'\t'),
        [separator] => Some(*separator),
        _ => (stated == "\\t").then_some(b'\t'),
    }
}

/// Returns the units in a row; empty if any cell is something else.
fn units(cells: &[String]) -> Vec<Option<Unit>> {
    let unit = |cell: &String| {
        let bare = cell.trim_matches(['(', ')', '[', ']']).trim();
        match bare {
            "" | "-" => Some(None),
            _ if number(bare).is_some() => None,
            _ => Unit::from_name(bare).map(Some),
        }
    };
    cells.iter().map(unit).collect::<Option<Vec<_>>>().unwrap_or_default()
}

fn is_value(cell: &str) -> bool {
    !is_missing(cell) && (number(cell).is_some() || Stamp::parse(cell).is_some())
}

/// Returns the most frequent separator of a header outside quotes, or a space if it has none.
fn separator(header: &str) -> u8 {
    let outside = outside_quotes(header);
    let count = |separator: &u8| outside.iter().filter(|b| *b == separator).count();
    SEPARATORS.into_iter().rev().max_by_key(count).filter(|s| count(s) > 0).unwrap_or(b' ')
}

fn outside_quotes(line: &str) -> Vec<u8> {
    let mut is_quoted = false;
    let outside = line.bytes().filter(|b| {
        is_quoted ^= *b == b'"';
        !is_quoted
    });
    outside.collect()
}

/// Splits a line into cells without quotes.
pub fn cells(line: &str, separator: u8) -> Vec<String> {
    let bare = |cell: &str| cell.trim().trim_matches('"').trim().to_owned();
    if separator == b' ' {
        return line.split_whitespace().map(bare).collect();
    }
    let mut is_quoted = false;
    let split = line.split(|c: char| {
        is_quoted ^= c == '"';
        !is_quoted && c == char::from(separator)
    });
    split.map(bare).collect()
}
