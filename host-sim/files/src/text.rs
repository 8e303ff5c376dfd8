//! Text as editors and spreadsheets leave it: what is no UTF-8 is named, and a byte order mark is no part of it.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use mindgap_foundations::error::{Error, Result};

const UTF8_MARK: &[u8] = b"\xEF\xBB\xBF";
/// The marks of UTF-16, lower byte first and last.
const UTF16_MARKS: [&[u8]; 2] = [b"\xFF\xFE", b"\xFE\xFF"];

/// A text file that is read bit by bit.
pub struct TextFile {
    reader: BufReader<File>,
    /// It began with a byte order mark, which is passed over.
    pub had_mark: bool,
    /// The last byte that was read, if there was one.
    pub last: Option<u8>,
}

impl TextFile {
    /// Opens a text file.
    ///
    /// # Errors
    /// When it cannot be opened, or is UTF-16.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |e: std::io::Error| Error::in_file(path, format!("cannot be read: {e}"));
        let mut reader = BufReader::with_capacity(1 << 16, File::open(path).map_err(failed)?);
        let begin = reader.fill_buf().map_err(failed)?;
        if is_utf16(begin) {
            return Err(Error::in_file(
                path,
                "is UTF-16, in which Windows programs save \"Unicode\": save it as UTF-8",
            ));
        }
        let had_mark = begin.starts_with(UTF8_MARK);
        if had_mark {
            reader.consume(UTF8_MARK.len());
        }
        Ok(TextFile { reader, had_mark, last: None })
    }
}

impl Read for TextFile {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.last = buffer[..count].last().copied().or(self.last);
        Ok(count)
    }
}

/// The text of a file.
///
/// # Errors
/// When the file is missing, unreadable or no UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let mut bytes = Vec::new();
    let read = TextFile::open(path)?.read_to_end(&mut bytes);
    read.map_err(|e| Error::in_file(path, format!("cannot be read: {e}")))?;
    String::from_utf8(bytes).map_err(|e| {
        let valid = e.utf8_error().valid_up_to();
        Error::at_line(path, line_at(e.as_bytes(), valid), NO_UTF8)
    })
}

/// What there is to say of bytes that are no text.
pub const NO_UTF8: &str = "is no UTF-8: save it as UTF-8";

/// The line, from 1, of a byte in a text.
pub fn line_at(text: impl AsRef<[u8]>, byte: usize) -> u64 {
    1 + text.as_ref().iter().take(byte).filter(|b| **b == b'\n').count() as u64
}

/// By its mark, or since every other byte of plain letters is zero.
fn is_utf16(begin: &[u8]) -> bool {
    let is_halved = |offset: usize| begin.len() >= 4 && begin[..4].iter().skip(offset).step_by(2).all(|b| *b == 0);
    UTF16_MARKS.iter().any(|mark| begin.starts_with(mark)) || is_halved(0) != is_halved(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> std::result::Result<String, String> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.txt");
        std::fs::write(&path, bytes).expect("a file");
        read_text(&path).map_err(|e| e.to_string().replace(&format!("{}", path.display()), "a.txt"))
    }

    #[test]
    fn a_mark_is_no_part_of_the_text() {
        assert_eq!(read(b"\xEF\xBB\xBFt_ms\n"), Ok("t_ms\n".into()));
        assert_eq!(read(b""), Ok(String::new()));
    }

    #[test]
    fn what_is_no_utf8_is_named() {
        for bytes in [b"\xFF\xFEt\0_\0".as_slice(), b"\xFE\xFF\0t\0_", b"t\0_\0m\0", b"\0t\0_\0m"] {
            let why = read(bytes).expect_err("UTF-16");
            assert!(why.starts_with("a.txt: is UTF-16") && why.ends_with("save it as UTF-8"), "{why}");
        }
        assert_eq!(read(b"one\ntwo \xE9\n"), Err("a.txt:2: is no UTF-8: save it as UTF-8".into()));
    }
}
