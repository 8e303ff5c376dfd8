//! Reads CSV files record by record, with line numbers.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord};

use super::NOT_UTF8;
use mindgap_foundations::error::{Error, Result};

/// Longest line, so that a file without line ends is refused before it fills memory.
const MAX_LINE_BYTES: usize = 1 << 20;

/// The records of a CSV file.
pub struct Records<R> {
    path: PathBuf,
    reader: csv::Reader<LineEnds<R>>,
}

impl<R: Read> Records<R> {
    /// Reads a table with a header and as many cells in each line, with spaces around cells removed. `path` is for messages.
    pub fn new(path: &Path, text: R) -> Self {
        Self::with(path, text, ReaderBuilder::new().trim(csv::Trim::All))
    }

    /// Reads with other settings.
    pub fn with(path: &Path, text: R, settings: &ReaderBuilder) -> Self {
        Records { path: path.into(), reader: settings.from_reader(LineEnds { text, last: None, line_bytes: 0 }) }
    }

    /// Returns the header.
    ///
    /// # Errors
    /// When it is not UTF-8.
    pub fn header(&mut self) -> Result<StringRecord> {
        match self.reader.headers() {
            Ok(header) => Ok(header.clone()),
            Err(e) => Err(self.located(&e)),
        }
    }

    /// Reads the next record and returns its line, from 1, or `None` after the last record.
    ///
    /// # Errors
    /// When it is not UTF-8 or has more or fewer cells than the header; the error names its line.
    pub fn read(&mut self, record: &mut StringRecord) -> Result<Option<u64>> {
        match self.reader.read_record(record) {
            Ok(is_there) => Ok(is_there.then(|| self.line())),
            Err(e) => Err(self.located(&e)),
        }
    }

    /// Returns the line of the last record. The position of a record itself would be before the blank lines above it
    /// (rust-csv, issue 208), so this is derived from the reader, which is at the start of the next record.
    fn line(&self) -> u64 {
        self.reader.position().line() - 1
    }

    fn located(&self, e: &csv::Error) -> Error {
        let what = match e.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                let comma = if len > expected_len { " (numbers have a decimal point)" } else { "" };
                format!("has {len} cells where the header has {expected_len}: incomplete or malformed line{comma}")
            }
            csv::ErrorKind::Utf8 { .. } => NOT_UTF8.into(),
            _ => e.to_string().replace('\n', " "),
        };
        Error::at_line(&self.path, self.line().max(1), what)
    }
}

/// Converts all line ends to a single line feed, so that lines can be counted: of CR LF the csv crate leaves the second
/// character unread (rust-csv, issue 395).
struct LineEnds<R> {
    text: R,
    last: Option<u8>,
    /// Length of the present line so far.
    line_bytes: usize,
}

impl<R: Read> Read for LineEnds<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let count = self.text.read(buffer)?;
            if count == 0 {
                return Ok(self.end(buffer));
            }
            let mut kept = 0;
            for at in 0..count {
                let byte = buffer[at];
                self.line_bytes = if matches!(byte, b'\n' | b'\r') { 0 } else { self.line_bytes + 1 };
                let is_second_of_pair = byte == b'\n' && self.last == Some(b'\r');
                self.last = Some(byte);
                if !is_second_of_pair {
                    buffer[kept] = if byte == b'\r' { b'\n' } else { byte };
                    kept += 1;
                }
            }
            if self.line_bytes > MAX_LINE_BYTES {
                return Err(io::Error::other("a line of more than 1 MB: not a table"));
            }
            if kept > 0 {
                return Ok(kept);
            }
        }
    }
}

impl<R> LineEnds<R> {
    /// Adds a line end to the last line if it has none.
    fn end(&mut self, buffer: &mut [u8]) -> usize {
        match (self.last, buffer) {
            (None | Some(b'\n' | b'\r'), _) | (_, []) => 0,
            (_, [first, ..]) => {
                *first = b'\n';
                self.last = Some(b'\n');
                1
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The records of a text with their lines, up to the first error.
    fn read(text: &[u8]) -> (Vec<(u64, String)>, Option<String>) {
        let mut records = Records::new(Path::new("a.csv"), text);
        let (mut record, mut found) = (StringRecord::new(), Vec::new());
        loop {
            match records.read(&mut record) {
                Ok(Some(line)) => found.push((line, record.iter().collect::<Vec<_>>().join("|"))),
                Ok(None) => return (found, None),
                Err(e) => return (found, Some(e.to_string())),
            }
        }
    }

    #[test]
    fn records_have_line_numbers_for_all_line_ends_and_blank_lines() {
        let expected = vec![(2, "1|2".to_owned()), (5, "3|4".to_owned()), (6, "5|6".to_owned())];
        let text = "a,b\n1,2\n\n\n3,4\n5,6\n";
        for end in ["\n", "\r\n", "\r"] {
            let text = text.replace('\n', end);
            assert_eq!(read(text.as_bytes()), (expected.clone(), None), "{text:?}");
            assert_eq!(read(text.trim_end().as_bytes()), (expected.clone(), None), "{text:?} without the last end");
        }
        assert_eq!(read(b""), (vec![], None));
    }

    #[test]
    fn errors_have_line_numbers() {
        for end in ["\n", "\r\n"] {
            let torn = format!("a,b{end}1,2{end}{end}3{end}");
            let (found, why) = read(torn.as_bytes());
            assert_eq!(found.len(), 1);
            assert!(why.as_deref().is_some_and(|why| why.starts_with("a.csv:4: has 1 cells")), "{torn:?} gave {why:?}");
            let invalid = [&torn.as_bytes()[..torn.len() - 1 - end.len()], b"\xE9,1", end.as_bytes()].concat();
            assert_eq!(read(&invalid).1.as_deref(), Some("a.csv:4: is not UTF-8: save it as UTF-8"));
        }
    }

    #[test]
    fn a_line_without_end_is_refused() {
        let mut records = Records::new(Path::new("a.csv"), io::repeat(b'1'));
        let why = records.header().expect_err("no end").to_string();
        assert!(why.ends_with("a line of more than 1 MB: not a table"), "{why}");
    }

    #[test]
    fn line_ends_may_be_split_between_reads() {
        /// Returns one byte at a time.
        struct Drip<'a>(&'a [u8]);
        impl Read for Drip<'_> {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                let [first, rest @ ..] = self.0 else { return Ok(0) };
                self.0 = rest;
                buffer[0] = *first;
                Ok(1)
            }
        }
        let mut text = String::new();
        let mut ends = LineEnds { text: Drip(b"a\r\n\r\nb\rc\n\n\rd"), last: None, line_bytes: 0 };
        ends.read_to_string(&mut text).expect("text");
        assert_eq!(text, "a\n\nb\nc\n\n\nd\n");
    }
}
