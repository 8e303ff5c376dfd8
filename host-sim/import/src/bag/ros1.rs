//! Reads ROS 1 bags.

use std::collections::HashMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use rosbag::record_types::Connection;
use rosbag::{ChunkRecord, IndexRecord, MessageRecord, RosBag};

use super::item::{Ending, Item, Wire, type_name};
use super::messages::Encoding;
use mindgap_files::unreadable;
use mindgap_foundations::error::{Error, Result};

/// A file's header lies within its first bytes.
const HEADER_BYTES: u64 = 8192;
/// Length of the line with the version, bytes.
const VERSION_BYTES: usize = 13;
/// A field of the header: the position of the index, eight bytes.
const INDEX: &[u8] = b"index_pos=";

/// Reads the file stored at `stored`, of `size` bytes, and passes every message to `take`; messages name `path`.
///
/// # Errors
/// When the file is corrupt or has no index, or the first error of `take`.
pub fn read(path: &Path, stored: &Path, size: u64, mut take: impl FnMut(Item) -> Result<()>) -> Result<Ending> {
    let corrupt = |why: &dyn std::fmt::Display| Error::in_file(path, format!("is a corrupt bag of ROS 1: {why}"));
    if !has_index(stored, size).map_err(|e| unreadable(path, &e))? {
        let what = "is a bag of ROS 1 without an index, as after a crash or a cut: run `rosbag reindex` on it, or convert it with \
                    `rosbags-convert --dst-storage mcap`";
        return Err(Error::in_file(path, what));
    }
    let bag = RosBag::new(stored).map_err(|e| corrupt(&e))?;
    let mut topics: HashMap<u32, (String, String)> = HashMap::new();
    for record in bag.index_records() {
        if let IndexRecord::Connection(Connection { id, storage_topic, tp, .. }) = record.map_err(|e| corrupt(&e))? {
            topics.insert(id, (storage_topic.to_owned(), type_name(tp).0));
        }
    }
    for record in bag.chunk_records() {
        let ChunkRecord::Chunk(chunk) = record.map_err(|e| corrupt(&e))? else { continue };
        for message in chunk.messages() {
            let MessageRecord::MessageData(message) = message.map_err(|e| corrupt(&e))? else { continue };
            if let Some((topic, schema)) = topics.get(&message.conn_id) {
                let (wire, log_ms) = (Wire::Known(Encoding::Ros1), message.time as f64 / 1e6);
                take(Item { topic, schema, wire, log_ms, data: message.data })?;
            }
        }
    }
    Ok(Ending::Whole)
}

/// Returns whether the index that the header promises lies within the file, after the header; the reader relies on it.
fn has_index(stored: &Path, size: u64) -> std::io::Result<bool> {
    let mut start = Vec::new();
    File::open(stored)?.take(HEADER_BYTES).read_to_end(&mut start)?;
    let length = |at: usize| Some(u32::from_le_bytes(*start.get(at..)?.first_chunk()?) as usize);
    let header_ends = || {
        let fields_end = VERSION_BYTES + 4 + length(VERSION_BYTES)?;
        Some((fields_end + 4 + length(fields_end)?) as u64)
    };
    let field = start.windows(INDEX.len()).position(|bytes| bytes == INDEX);
    let position = field.and_then(|at| start.get(at + INDEX.len()..)?.first_chunk().copied()).map(u64::from_le_bytes);
    Ok(position.zip(header_ends()).is_some_and(|(at, header_ends)| header_ends <= at && at < size))
}
