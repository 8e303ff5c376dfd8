//! Opens a file of a bag, whatever its container and compression, and passes on its messages.

#[cfg(not(target_family = "wasm"))]
mod disk;

use std::io::{BufReader, Read, Seek};
use std::path::Path;

use super::item::{Ending, Item, ZSTD};
use super::mcap;
use mindgap_files::{self as files, unreadable};
use mindgap_foundations::error::{Error, Result};

/// First bytes of an MCAP file.
const MCAP: &[u8] = b"\x89MCAP0\r\n";
/// First bytes of an SQLite file.
const SQLITE: &[u8] = b"SQLite format 3\0";
/// First bytes of a ROS 1 bag.
const ROS1: &[u8] = b"#ROSBAG V";
/// First bytes of files compressed by programs that no recorder calls, with the command that decompresses them.
const ARCHIVES: [(&[u8], &str); 4] =
    [(b"\x1f\x8b", "gunzip"), (b"BZh", "bunzip2"), (b"\xfd7zXZ\0", "unxz"), (b"PK\x03\x04", "unzip")];

/// Reads a file and passes every message to `take`.
///
/// # Errors
/// When the file cannot be read, is of no known kind or is corrupt, or the first error of `take`.
pub fn read(path: &Path, take: impl FnMut(Item) -> Result<()>) -> Result<Ending> {
    let mut file = files::open(path)?;
    let size = file.size().map_err(|e| unreadable(path, &e))?;
    let start = start_of(path, &mut file)?;
    file.rewind().map_err(|e| unreadable(path, &e))?;
    if start.starts_with(MCAP) {
        return mcap::read(path, BufReader::new(file), size, take);
    }
    #[cfg(not(target_family = "wasm"))]
    if is_bag(&start) {
        return disk::read(path, file, &start, size, take);
    }
    Err(unreadable_bag(path, &start))
}

/// Returns the error of a file that is not read.
fn unreadable_bag(path: &Path, start: &[u8]) -> Error {
    if start.len() < MCAP.len() {
        return Error::in_file(path, "ends before its first message: the bag is empty or cut off");
    }
    let archive = ARCHIVES.into_iter().find(|(magic, _)| start.starts_with(magic));
    let what = match archive {
        _ if is_bag(start) => {
            "cannot be read in a browser: convert it to MCAP, or import it with the command `mindgap`".into()
        }
        Some((_, command)) => format!("is compressed: decompress it with `{command}`"),
        None => "is not a bag: bags are MCAP or SQLite (.db3) files of ROS 2, or .bag files of ROS 1".into(),
    };
    Error::in_file(path, what)
}

/// Returns the first bytes of a file.
fn start_of(path: &Path, file: impl Read) -> Result<Vec<u8>> {
    let mut start = Vec::new();
    file.take(16).read_to_end(&mut start).map_err(|e| unreadable(path, &e))?;
    Ok(start)
}

/// Returns whether a file is, by its first bytes, a bag.
pub fn is_bag_file(path: &Path) -> bool {
    let start = files::open(path).and_then(|mut file| start_of(path, &mut file));
    start.is_ok_and(|start| is_bag(&start))
}

fn is_bag(start: &[u8]) -> bool {
    [MCAP, SQLITE, ROS1, ZSTD].iter().any(|magic| start.starts_with(magic))
}
