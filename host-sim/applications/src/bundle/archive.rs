//! ZIP archives in memory; the same files give the same bytes.

use std::fmt::Display;
use std::io::Write;

use flate2::Compression;
use flate2::write::DeflateEncoder;
use rawzip::{CompressionMethod, ZipArchiveWriter};

use mindgap_foundations::error::{Error, Result};

/// What an archive begins with.
const SIGNATURE: &[u8] = b"PK\x03\x04";
/// Where the length of the first name is.
const NAME_LENGTH: usize = 26;
const NAME: usize = 30;
/// Permissions of unpacked files.
const MODE: u32 = 0o644;

/// Returns an archive of files, given as path and text, without times.
///
/// # Errors
/// When a path is too long for the format.
pub fn zipped<'a>(files: impl Iterator<Item = &'a (String, String)>) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut bytes);
    for (path, text) in files {
        let file = archive.new_file(path).compression_method(CompressionMethod::DEFLATE).unix_permissions(MODE);
        let (mut entry, config) = file.start().map_err(failed)?;
        let mut writer = config.wrap(DeflateEncoder::new(&mut entry, Compression::default()));
        writer.write_all(text.as_bytes()).map_err(failed)?;
        let (encoder, described) = writer.finish().map_err(failed)?;
        encoder.finish().map_err(failed)?;
        entry.finish(described).map_err(failed)?;
    }
    archive.finish().map_err(failed)?;
    Ok(bytes)
}

/// Returns the name of the first file of an archive; `None` if it is none.
pub fn first_name(bytes: &[u8]) -> Option<&[u8]> {
    let length = bytes.get(NAME_LENGTH..NAME_LENGTH + 2)?;
    let length = usize::from(u16::from_le_bytes([length[0], length[1]]));
    bytes.get(NAME..NAME + length).filter(|_| bytes.starts_with(SIGNATURE))
}

fn failed(why: impl Display) -> Error {
    Error::new(format!("the files cannot be packed: {why}"))
}
