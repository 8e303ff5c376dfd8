//! CSV files record by record, each with the line on which it stands.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord};

use super::NO_UTF8;
use mindgap_foundations::error::{Error, Result};

/// Records of a CSV file.
pub struct Records<R> {
    path: PathBuf,
    reader: csv::Reader<LineEnds<R>>,
}

impl<R: Read> Records<R> {
    /// Of the text of a table: a header and below it as many cells a line, without the blanks about them. `path` is for messages.
    pub fn new(path: &Path, text: R) -> Self {
        Self::with(path, text, ReaderBuilder::new().trim(csv::Trim::All))
    }

    /// The same by other settings.
    pub fn with(path: &Path, text: R, settings: &ReaderBuilder) -> Self {
        Records { path: path.into(), reader: settings.from_reader(LineEnds { text, last: None }) }
    }

    /// The first record, where the settings have a header.
    ///
    /// # Errors
    /// When it is no text.
    pub fn header(&mut self) -> Result<StringRecord> {
        match self.reader.headers() {
            Ok(header) => Ok(header.clone()),
            Err(e) => Err(self.wrong(&e)),
        }
    }

    /// Reads the next record and gives its line, from 1; none after the last record.
    ///
    /// # Errors
    /// When it is no text, or has more or fewer cells than it should; the message names its line.
    pub fn read(&mut self, record: &mut StringRecord) -> Result<Option<u64>> {
        match self.reader.read_record(record) {
            Ok(is_there) => Ok(is_there.then(|| self.line())),
            Err(e) => Err(self.wrong(&e)),
        }
    }

    /// The line of the record that was read last: the reader stands at the beginning of the next. The position of a record
    /// itself is before the blank lines above it (rust-csv, issue 208).
    fn line(&self) -> u64 {
        self.reader.position().line() - 1
    }

    fn wrong(&self, e: &csv::Error) -> Error {
        let what = match e.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                let comma = if len > expected_len { " (numbers have a decimal point)" } else { "" };
                format!("has {len} cells where the header has {expected_len}: torn or wrong line{comma}")
            }
            csv::ErrorKind::Utf8 { .. } => NO_UTF8.into(),
            _ => e.to_string().replace('\n', " "),
        };
        Error::at_line(&self.path, self.line(), what)
    }
}

/// A text whose lines all end with a line feed and nothing else, so that the lines that were read can be counted: of two
/// characters the csv crate leaves the second unread (rust-csv, issue 395).
struct LineEnds<R> {
    text: R,
    last: Option<u8>,
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
                let has_ended = byte == b'\n' && self.last == Some(b'\r');
                self.last = Some(byte);
                if !has_ended {
                    buffer[kept] = if byte == b'\r' { b'\n' } else { byte };
                    kept += 1;
                }
            }
            if kept > 0 {
                return Ok(kept);
            }
        }
    }
}

impl<R> LineEnds<R> {
    /// The end of the last line, if it has none.
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

    /// The records of a text with their lines; what is wrong ends them.
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
    fn a_record_has_its_line_whatever_ends_lines_and_stands_between() {
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
    fn what_is_wrong_has_its_line_too() {
        for end in ["\n", "\r\n"] {
            let torn = format!("a,b{end}1,2{end}{end}3{end}");
            let (found, why) = read(torn.as_bytes());
            assert_eq!(found.len(), 1);
            assert!(why.as_deref().is_some_and(|why| why.starts_with("a.csv:4: has 1 cells")), "{torn:?} gave {why:?}");
            let no_text = [&torn.as_bytes()[..torn.len() - 1 - end.len()], b"\xE9,1", end.as_bytes()].concat();
            assert_eq!(read(&no_text).1.as_deref(), Some("a.csv:4: is no UTF-8: save it as UTF-8"));
        }
    }

    #[test]
    fn a_line_end_may_be_cut_anywhere() {
        /// Gives one byte at a time.
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
        let mut ends = LineEnds { text: Drip(b"a\r\n\r\nb\rc\n\n\rd"), last: None };
        ends.read_to_string(&mut text).expect("text");
        assert_eq!(text, "a\n\nb\nc\n\n\nd\n");
    }
}
