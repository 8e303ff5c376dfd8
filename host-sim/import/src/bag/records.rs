//! The records of an MCAP file, within bounds: a small file may claim to hold much, and a broken one anything.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, parse_record};

use mindgap_foundations::error::{Error, Result};

/// A message as it lies in the file.
pub struct Item<'a> {
    /// Its topic.
    pub topic: &'a str,
    /// The name of its type.
    pub schema: &'a str,
    /// When it was logged, ms.
    pub log_ms: f64,
    /// Its bytes.
    pub data: &'a [u8],
}

/// How a file ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// As it should.
    Whole,
    /// In the middle, as when power was lost.
    Truncated,
}

/// No record, and no chunk of them, is larger: recorders write chunks of a few megabytes.
const LARGEST: usize = 1 << 26;
/// Chunks hold at most this many times the file's size, since what robots log shrinks by a factor of ten,
const MOST_EXPANDED: u64 = 256;
/// and this much more, of which a small file may be made.
const SMALL: u64 = 1 << 20;
/// So much of a file is read at once: room for a record is made as it comes, and not by the length that it claims to have.
const STEP: usize = 1 << 16;
/// Lengths of an opcode and of a record's length.
const OPCODE: usize = 1;
const LENGTH: usize = 8;

/// What is known of a file so far.
#[derive(Default)]
struct Known {
    schemas: HashMap<u16, String>,
    /// Topic and type of channels whose messages are CDR.
    channels: HashMap<u16, (String, String)>,
}

/// Reads a file and hands every message in CDR to `take`.
///
/// # Errors
/// When it cannot be read or is corrupt, or what `take` returns.
pub fn read(path: &Path, take: impl FnMut(Item) -> Result<()>) -> Result<Ending> {
    let file = File::open(path).map_err(|e| unreadable(path, &e))?;
    let size = file.metadata().map_err(|e| unreadable(path, &e))?.len();
    read_from(path, BufReader::new(file), size, take)
}

fn unreadable(path: &Path, why: &std::io::Error) -> Error {
    Error::in_file(path, format!("cannot be read: {why}"))
}

/// As [`read`], of a file's content and its size.
fn read_from(path: &Path, mut file: impl Read, size: u64, mut take: impl FnMut(Item) -> Result<()>) -> Result<Ending> {
    let most = MOST_EXPANDED * size + SMALL;
    let options = LinearReaderOptions::default().with_emit_chunks(true).with_record_length_limit(LARGEST);
    let mut reader = LinearReader::new_with_options(options);
    let mut known = Known::default();
    let mut expanded = 0;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(need)) => {
                let written = file.read(reader.insert(need.min(STEP)));
                let written = written.map_err(|e| unreadable(path, &e))?;
                reader.notify_read(written);
            }
            Ok(LinearReadEvent::Record { opcode: op::CHUNK, data }) => {
                let Record::Chunk { header, data } = parse_record(op::CHUNK, data).map_err(|e| corrupt(path, &e))?
                else {
                    continue;
                };
                expanded += header.uncompressed_size;
                if header.uncompressed_size > LARGEST as u64 || expanded > most {
                    let what =
                        format!("a chunk claims to hold {} bytes: no recorder writes that", header.uncompressed_size);
                    return Err(Error::in_file(path, what));
                }
                in_chunk(path, &header, &data, &mut |opcode, data| known.take(path, opcode, data, &mut take))?;
            }
            Ok(LinearReadEvent::Record { opcode, data }) => known.take(path, opcode, data, &mut take)?,
            Err(McapError::UnexpectedEof) if known.channels.is_empty() => {
                return Err(Error::in_file(path, "ends before its first message: the bag is empty or cut off"));
            }
            Err(McapError::UnexpectedEof) => return Ok(Ending::Truncated),
            Err(e) => return Err(corrupt(path, &e)),
        }
    }
    Ok(Ending::Whole)
}

fn corrupt(path: &Path, e: &McapError) -> Error {
    let what = match e {
        McapError::BadMagic => {
            "is no MCAP file (or its end is damaged): convert other bags by `ros2 bag convert`".into()
        }
        e => format!("is corrupt: {}", e.to_string().replace('\n', " ")),
    };
    Error::in_file(path, what)
}

/// Hands every record of a chunk to `take`.
fn in_chunk(
    path: &Path,
    header: &ChunkHeader,
    mut data: &[u8],
    take: &mut impl FnMut(u8, &[u8]) -> Result<()>,
) -> Result<()> {
    // The reader of mcap trusts the lengths within a chunk that is not compressed.
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
        .with_record_length_limit(usize::try_from(header.uncompressed_size).map_or(LARGEST, |size| size.min(LARGEST)));
    let mut reader = LinearReader::new_with_options(options);
    let mut left = chunk.as_slice();
    while let Some(event) = reader.next_event() {
        match event.map_err(|e| corrupt(path, &e))? {
            LinearReadEvent::ReadRequest(need) => {
                let (now, later) = left.split_at(need.min(left.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                left = later;
            }
            LinearReadEvent::Record { opcode, data } => take(opcode, data)?,
        }
    }
    Ok(())
}

/// A chunk as a record of a file: opcode, length, header, data.
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

/// The first of some records: its opcode, its content, and what comes after it.
fn first_record(data: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (head, rest) = data.split_at_checked(OPCODE + LENGTH)?;
    let length = u64::from_le_bytes(head[OPCODE..].try_into().ok()?);
    let (record, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    Some((head[0], record, rest))
}

impl Known {
    fn take(&mut self, path: &Path, opcode: u8, data: &[u8], take: &mut impl FnMut(Item) -> Result<()>) -> Result<()> {
        if ![op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&opcode) {
            return Ok(());
        }
        match parse_record(opcode, data).map_err(|e| corrupt(path, &e))? {
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) if channel.message_encoding == "cdr" => {
                let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                self.channels.insert(channel.id, (channel.topic, schema));
            }
            Record::Message { header, data } => {
                if let Some((topic, schema)) = self.channels.get(&header.channel_id) {
                    take(Item { topic, schema, log_ms: header.log_time as f64 / 1e6, data: &data })?;
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

    /// A file that remembers how much was asked of it at once.
    struct Asked<'a>(&'a [u8], &'a mut usize);

    impl Read for Asked<'_> {
        fn read(&mut self, room: &mut [u8]) -> std::io::Result<usize> {
            *self.1 = room.len().max(*self.1);
            self.0.read(room)
        }
    }

    fn record(opcode: u8, claimed: usize, data: &[u8]) -> Vec<u8> {
        [&[opcode][..], &(claimed as u64).to_le_bytes(), data].concat()
    }

    fn read_bytes(bytes: &[u8]) -> (String, usize) {
        let mut most = 0;
        let file = Asked(bytes, &mut most);
        let read = read_from(Path::new("a.mcap"), file, bytes.len() as u64, |_| Ok(()));
        (read.expect_err("nothing is whole").to_string(), most)
    }

    #[test]
    fn no_room_is_made_for_what_is_only_claimed() {
        let bytes = [mcap::MAGIC, &record(op::HEADER, LARGEST, b"short")].concat();
        let (told, most) = read_bytes(&bytes);
        assert!(told.contains("ends before its first message"), "{told}");
        assert!(most <= STEP, "{most}");
    }

    #[test]
    fn a_small_file_holds_no_large_chunk() {
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
        assert!(chunk(2 * SMALL).contains("no recorder writes that"));
        assert!(!chunk(SMALL).contains("no recorder writes that"));
    }
}
