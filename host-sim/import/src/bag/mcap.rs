//! Reads the records of an MCAP file within memory bounds, since corrupt files may claim any size.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, parse_record};

use super::item::{Ending, Item, Wire};
use super::messages::full_name;
use crate::expansion;
use mindgap_files::unreadable;
use mindgap_foundations::error::{Error, Result};

/// Maximum size of a record or chunk, bytes: recorders write chunks of a few megabytes.
const MAX_RECORD_BYTES: usize = 1 << 26;
/// Bytes read at once: memory grows with the data that arrives, not with the length that a record claims.
const READ_BYTES: usize = 1 << 16;
/// Size of an opcode, bytes.
const OPCODE: usize = 1;
/// Size of a record's length field, bytes.
const LENGTH: usize = 8;

/// Schemas and channels of a file read so far.
#[derive(Default)]
struct Definitions {
    schemas: HashMap<u16, String>,
    /// Topic, type and encoding of channels.
    channels: HashMap<u16, (String, String, Wire)>,
}

/// Reads a file's content and passes every message to `take`; `size` is the size of the file, bytes.
///
/// # Errors
/// When the file cannot be read or is corrupt, or the first error of `take`.
pub fn read(path: &Path, mut file: impl Read, size: u64, mut take: impl FnMut(Item) -> Result<()>) -> Result<Ending> {
    let max_bytes = expansion::most_bytes(size);
    let options = LinearReaderOptions::default().with_emit_chunks(true).with_record_length_limit(MAX_RECORD_BYTES);
    let mut reader = LinearReader::new_with_options(options);
    let mut definitions = Definitions::default();
    let mut expanded = 0;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(need)) => {
                let written = file.read(reader.insert(need.min(READ_BYTES)));
                let written = written.map_err(|e| unreadable(path, &e))?;
                reader.notify_read(written);
            }
            Ok(LinearReadEvent::Record { opcode: op::CHUNK, data }) => {
                let Record::Chunk { header, data } = parse_record(op::CHUNK, data).map_err(|e| corrupt(path, &e))?
                else {
                    continue;
                };
                expanded += header.uncompressed_size;
                if header.uncompressed_size > MAX_RECORD_BYTES as u64 || expanded > max_bytes {
                    let what = format!(
                        "a chunk claims to contain {} bytes, which no recorder writes",
                        header.uncompressed_size
                    );
                    return Err(Error::in_file(path, what));
                }
                in_chunk(path, &header, &data, &mut |opcode, data| definitions.take(path, opcode, data, &mut take))?;
            }
            Ok(LinearReadEvent::Record { opcode, data }) => definitions.take(path, opcode, data, &mut take)?,
            Err(McapError::UnexpectedEof | McapError::BadMagic) if definitions.channels.is_empty() => {
                return Err(Error::in_file(path, "ends before its first message: the bag is empty or cut off"));
            }
            // Without its last bytes, a file was cut off as well.
            Err(McapError::UnexpectedEof | McapError::BadMagic) => return Ok(Ending::Truncated),
            Err(e) => return Err(corrupt(path, &e)),
        }
    }
    Ok(Ending::Whole)
}

fn corrupt(path: &Path, e: &McapError) -> Error {
    Error::in_file(path, format!("is corrupt: {}", e.to_string().replace('\n', " ")))
}

/// Passes every record of a chunk to `take`.
fn in_chunk(
    path: &Path,
    header: &ChunkHeader,
    mut data: &[u8],
    take: &mut impl FnMut(u8, &[u8]) -> Result<()>,
) -> Result<()> {
    // The mcap reader trusts the lengths inside an uncompressed chunk, so that is parsed here.
    if header.compression.is_empty() {
        while !data.is_empty() {
            let (opcode, record, rest) =
                first_record(data).ok_or_else(|| Error::in_file(path, "is corrupt: a chunk ends within a record"))?;
            take(opcode, record)?;
            data = rest;
        }
        return Ok(());
    }
    let chunk = chunk_record(header, data);
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(
            usize::try_from(header.uncompressed_size).map_or(MAX_RECORD_BYTES, |size| size.min(MAX_RECORD_BYTES)),
        );
    let mut reader = LinearReader::new_with_options(options);
    let mut remaining = chunk.as_slice();
    while let Some(event) = reader.next_event() {
        match event.map_err(|e| corrupt(path, &e))? {
            LinearReadEvent::ReadRequest(need) => {
                let (now, later) = remaining.split_at(need.min(remaining.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                remaining = later;
            }
            LinearReadEvent::Record { opcode, data } => take(opcode, data)?,
        }
    }
    Ok(())
}

/// Encodes a chunk as a record: opcode, length, header, data.
fn chunk_record(header: &ChunkHeader, data: &[u8]) -> Vec<u8> {
    let name = header.compression.as_bytes();
    let length = 8 + 8 + 8 + 4 + 4 + name.len() + 8 + data.len();
    let mut record = vec![op::CHUNK];
    record.extend((length as u64).to_le_bytes());
    record.extend(header.message_start_time.to_le_bytes());
    record.extend(header.message_end_time.to_le_bytes());
    record.extend(header.uncompressed_size.to_le_bytes());
    record.extend(header.uncompressed_crc.to_le_bytes());
    record.extend((name.len() as u32).to_le_bytes());
    record.extend(name);
    record.extend((data.len() as u64).to_le_bytes());
    record.extend(data);
    record
}

/// Splits off the first record: returns its opcode, its content, and the rest.
fn first_record(data: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (head, rest) = data.split_at_checked(OPCODE + LENGTH)?;
    let length = u64::from_le_bytes(head[OPCODE..].try_into().ok()?);
    let (record, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    Some((head[0], record, rest))
}

impl Definitions {
    fn take(&mut self, path: &Path, opcode: u8, data: &[u8], take: &mut impl FnMut(Item) -> Result<()>) -> Result<()> {
        if ![op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&opcode) {
            return Ok(());
        }
        match parse_record(opcode, data).map_err(|e| corrupt(path, &e))? {
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                let wire = Wire::named(&channel.message_encoding);
                self.channels.insert(channel.id, (channel.topic, full_name(&schema), wire));
            }
            Record::Message { header, data } => {
                if let Some((topic, schema, wire)) = self.channels.get(&header.channel_id) {
                    take(Item { topic, schema, wire: *wire, log_ms: header.log_time as f64 / 1e6, data: &data })?;
                }
            }
            _ => {}
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file that remembers the largest read request.
    struct MeasuredFile<'a>(&'a [u8], &'a mut usize);

    impl Read for MeasuredFile<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            *self.1 = buffer.len().max(*self.1);
            self.0.read(buffer)
        }
    }

    fn record(opcode: u8, claimed: usize, data: &[u8]) -> Vec<u8> {
        [&[opcode][..], &(claimed as u64).to_le_bytes(), data].concat()
    }

    fn read_bytes(bytes: &[u8]) -> (String, usize) {
        let mut largest = 0;
        let file = MeasuredFile(bytes, &mut largest);
        let read = read(Path::new("a.mcap"), file, bytes.len() as u64, |_| Ok(()));
        (read.expect_err("nothing is whole").to_string(), largest)
    }

    #[test]
    fn memory_is_not_allocated_for_claimed_lengths() {
        let bytes = [mcap::MAGIC, &record(op::HEADER, MAX_RECORD_BYTES, b"short")].concat();
        let (error, max_bytes) = read_bytes(&bytes);
        assert!(error.contains("ends before its first message"), "{error}");
        assert!(max_bytes <= READ_BYTES, "{max_bytes}");
    }

    #[test]
    fn small_file_with_a_huge_chunk_is_rejected() {
        let chunk = |size: u64| {
            let header = ChunkHeader {
                message_start_time: 0,
                message_end_time: 0,
                uncompressed_size: size,
                uncompressed_crc: 0,
                compression: "zstd".into(),
                compressed_size: 0,
            };
            read_bytes(&[mcap::MAGIC, &chunk_record(&header, &[])].concat()).0
        };
        assert!(chunk(2 * expansion::LEAST_BYTES).contains("which no recorder writes"));
        assert!(!chunk(expansion::LEAST_BYTES).contains("which no recorder writes"));
    }
}
