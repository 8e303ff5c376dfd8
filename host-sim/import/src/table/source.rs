//! Reads the text of a table, gzipped or not.

use std::io::{BufReader, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::foreign;
use crate::expansion::{self, MOST_TIMES};
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// First bytes of a gzipped file.
const GZIP: [u8; 2] = [0x1F, 0x8B];

/// Reads a text that may be gzipped. Zero bytes at its end, which power failures leave, are dropped.
///
/// # Errors
/// When the file is missing, unreadable, another format or not UTF-8, or too long when unpacked.
pub fn read(file: &Path) -> Result<String> {
    let mut start = Vec::new();
    let begun = files::open(file)?.take(foreign::SIGNATURE as u64).read_to_end(&mut start);
    begun.map_err(|e| files::unreadable(file, &e))?;
    if let Some(what) = foreign::signature(&start) {
        return Err(Error::in_file(file, what));
    }
    let mut text = if start.starts_with(&GZIP) { unpacked(file)? } else { files::read_text(file)? };
    text.truncate(text.trim_end_matches('\0').len());
    Ok(text)
}

fn unpacked(file: &Path) -> Result<String> {
    let failed = |e: std::io::Error| Error::in_file(file, format!("cannot be unpacked: {e}"));
    let packed = files::open(file)?;
    let limit = expansion::most_bytes(packed.size().map_err(failed)?);
    let mut bytes = Vec::new();
    MultiGzDecoder::new(BufReader::new(packed)).take(limit + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > limit {
        let what = format!(
            "unpacks to more than {MOST_TIMES} times its size: if you expect that, unpack it with gunzip and import the text"
        );
        return Err(Error::in_file(file, what));
    }
    files::decoded(file, bytes)
}
