//! Reads text as editors and spreadsheets save it: other encodings than UTF-8 are rejected, a byte-order mark is skipped.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::input;
use super::source::File;
use mindgap_foundations::error::{Error, Result};

const UTF8_BOM: &[u8] = b"\xEF\xBB\xBF";
/// Byte-order marks of UTF-16, little and big endian.
const UTF16_BOMS: [&[u8]; 2] = [b"\xFF\xFE", b"\xFE\xFF"];

/// Largest file that is read as a whole.
pub const MAX_BYTES: u64 = 256 << 20;

/// A text file that is read in pieces.
pub struct TextFile {
    reader: BufReader<File>,
    /// Whether it started with a byte-order mark, which is skipped.
    pub had_bom: bool,
    /// The last byte read so far, if any.
    pub last: Option<u8>,
}

impl TextFile {
    /// Opens a text file.
    ///
    /// # Errors
    /// When it cannot be opened, or is UTF-16.
    pub fn open(path: &Path) -> Result<Self> {
        let mut reader = BufReader::with_capacity(1 << 16, input::open(path)?);
        let start = reader.fill_buf().map_err(|e| input::unreadable(path, &e))?;
        if is_utf16(start) {
            return Err(Error::in_file(path, "is UTF-16, which Windows programs call \"Unicode\": save it as UTF-8"));
        }
        let had_bom = start.starts_with(UTF8_BOM);
        if had_bom {
            reader.consume(UTF8_BOM.len());
        }
        Ok(TextFile { reader, had_bom, last: None })
    }
}

impl Read for TextFile {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.last = buffer[..count].last().copied().or(self.last);
        Ok(count)
    }
}

/// Reads a text file with all its bytes, a byte-order mark included, so that it can be written back.
///
/// # Errors
/// As [`read_text`].
pub fn read_raw_text(path: &Path) -> Result<String> {
    let file = TextFile::open(path)?;
    let mark = if file.had_bom { "\u{feff}" } else { "" };
    Ok(mark.to_owned() + &decoded(path, input::read_at_most(path, file, MAX_BYTES)?)?)
}

/// Reads a text file of at most 256 MB.
///
/// # Errors
/// When the file is missing, unreadable, larger or not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    decoded(path, input::read_at_most(path, TextFile::open(path)?, MAX_BYTES)?)
}

/// Returns the text of a file's bytes without a byte-order mark.
///
/// # Errors
/// When they are not UTF-8.
pub fn decoded(path: &Path, mut bytes: Vec<u8>) -> Result<String> {
    if bytes.starts_with(UTF8_BOM) {
        bytes.drain(..UTF8_BOM.len());
    }
    String::from_utf8(bytes).map_err(|e| {
        let valid = e.utf8_error().valid_up_to();
        Error::at_line(path, line_at(e.as_bytes(), valid), NOT_UTF8)
    })
}

/// The error message for bytes that are not UTF-8.
pub const NOT_UTF8: &str = "is not UTF-8: save it as UTF-8";

/// Returns the line, from 1, of a byte offset in a text.
pub fn line_at(text: impl AsRef<[u8]>, byte: usize) -> u64 {
    1 + text.as_ref().iter().take(byte).filter(|b| **b == b'\n').count() as u64
}

/// Recognises UTF-16 by its byte-order mark, or since every other byte of ASCII letters is zero.
fn is_utf16(start: &[u8]) -> bool {
    let is_every_other_zero =
        |offset: usize| start.len() >= 4 && start[..4].iter().skip(offset).step_by(2).all(|b| *b == 0);
    UTF16_BOMS.iter().any(|mark| start.starts_with(mark)) || is_every_other_zero(0) != is_every_other_zero(1)
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
    fn byte_order_mark_is_skipped() {
        assert_eq!(read(b"\xEF\xBB\xBFt_ms\n"), Ok("t_ms\n".into()));
        assert_eq!(read(b""), Ok(String::new()));
    }

    #[test]
    fn other_encodings_are_rejected() {
        for bytes in [b"\xFF\xFEt\0_\0".as_slice(), b"\xFE\xFF\0t\0_", b"t\0_\0m\0", b"\0t\0_\0m"] {
            let why = read(bytes).expect_err("UTF-16");
            assert!(why.starts_with("a.txt: is UTF-16") && why.ends_with("save it as UTF-8"), "{why}");
        }
        assert_eq!(read(b"one\ntwo \xE9\n"), Err("a.txt:2: is not UTF-8: save it as UTF-8".into()));
    }
}
