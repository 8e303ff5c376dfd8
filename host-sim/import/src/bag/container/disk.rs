//! Opens bags whose readers need a file on disk: SQLite, ROS 1, and whatever is compressed as a whole.

use std::io::{BufReader, ErrorKind, Read, copy};
use std::path::Path;

use super::super::item::{Ending, Item, ZSTD};
use super::super::{mcap, ros1, sqlite};
use super::{MCAP, ROS1, SQLITE, start_of, unreadable_bag};
use crate::expansion::{self, MOST_TIMES};
use mindgap_files::source::File;
use mindgap_files::unreadable;
use mindgap_foundations::error::{Error, Result};

/// Reads a file with its first bytes and size, and passes every message to `take`.
///
/// # Errors
/// When the content is of no known kind or is corrupt, or the first error of `take`.
pub fn read(path: &Path, file: File, start: &[u8], size: u64, take: impl FnMut(Item) -> Result<()>) -> Result<Ending> {
    if !start.starts_with(ZSTD) {
        return read_plain(path, path, file, start, size, take);
    }
    // SQLite and ROS 1 need a file to seek in, so the content is decompressed to one.
    let max_bytes = expansion::most_bytes(size);
    let mut plain = tempfile::NamedTempFile::new().map_err(|e| unreadable(path, &e))?;
    let decoder = zstd::Decoder::new(file).map_err(|e| unreadable(path, &e))?;
    let is_cut = match copy(&mut decoder.take(max_bytes), plain.as_file_mut()) {
        Ok(_) => false,
        Err(e) if e.kind() == ErrorKind::UnexpectedEof => true,
        Err(e) => return Err(Error::in_file(path, format!("cannot be decompressed: {e}"))),
    };
    let size = plain.as_file().metadata().map_err(|e| unreadable(path, &e))?.len();
    if size == max_bytes {
        let what = format!(
            "expands to more than {} MB, {MOST_TIMES} times its size, which no recording does: decompress it with `unzstd` \
             if it is sound",
            max_bytes >> 20
        );
        return Err(Error::in_file(path, what));
    }
    let start = start_of(path, &mut plain.reopen().map_err(|e| unreadable(path, &e))?)?;
    let content = plain.reopen().map_err(|e| unreadable(path, &e))?;
    let ending = read_plain(path, plain.path(), content, &start, size, take)?;
    Ok(if is_cut { Ending::Truncated } else { ending })
}

/// Reads uncompressed `content` that is stored at `stored`; messages name `path`.
fn read_plain(
    path: &Path,
    stored: &Path,
    content: impl Read,
    start: &[u8],
    size: u64,
    take: impl FnMut(Item) -> Result<()>,
) -> Result<Ending> {
    match start {
        _ if start.starts_with(MCAP) => mcap::read(path, BufReader::new(content), size, take),
        _ if start.starts_with(SQLITE) => sqlite::read(path, stored, take),
        _ if start.starts_with(ROS1) => ros1::read(path, stored, size, take),
        _ => Err(unreadable_bag(path, start)),
    }
}
