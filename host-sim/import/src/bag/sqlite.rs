//! Reads SQLite files of ROS 2 bags (.db3).

use std::collections::HashMap;
use std::path::Path;

use rusqlite::{Connection, OpenFlags, Row};

use super::item::{Ending, Item, Wire, type_name};
use mindgap_foundations::error::{Error, Result};

/// A topic as the file describes it.
struct Topic {
    name: String,
    schema: String,
    wire: Wire,
    is_needed: bool,
}

/// Reads the file stored at `stored` and passes every message to `take`; messages name `path`.
///
/// # Errors
/// When the file is not a bag or is corrupt, or the first error of `take`.
pub fn read(path: &Path, stored: &Path, mut take: impl FnMut(Item) -> Result<()>) -> Result<Ending> {
    let corrupt =
        |e: rusqlite::Error| Error::in_file(path, format!("is corrupt: {}", e.to_string().replace('\n', " ")));
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let database = Connection::open_with_flags(uri(stored), flags).map_err(corrupt)?;
    let topics = topics(&database).map_err(|e| match e {
        rusqlite::Error::SqliteFailure(_, Some(why)) if why.contains("no such") => {
            Error::in_file(path, "is an SQLite file without the tables of a ROS 2 bag")
        }
        e => corrupt(e),
    })?;
    let mut statement = database.prepare("SELECT topic_id, timestamp, data FROM messages").map_err(corrupt)?;
    let mut rows = statement.query([]).map_err(corrupt)?;
    let mut count = 0_u64;
    loop {
        let row = match rows.next() {
            Ok(Some(row)) => row,
            Ok(None) => return Ok(Ending::Whole),
            // The pages of a file that was cut off end somewhere.
            Err(_) if count > 0 => return Ok(Ending::Truncated),
            Err(e) => return Err(corrupt(e)),
        };
        count += 1;
        let (id, time_ns) = (row.get::<_, i64>(0).map_err(corrupt)?, row.get::<_, i64>(1).map_err(corrupt)?);
        let Some(Topic { name, schema, wire, is_needed }) = topics.get(&id) else { continue };
        let data = if *is_needed { row.get_ref(2).map_err(corrupt)?.as_blob().unwrap_or_default() } else { &[] };
        take(Item { topic: name, schema, wire: *wire, log_ms: time_ns as f64 / 1e6, data })?;
    }
}

fn topics(database: &Connection) -> rusqlite::Result<HashMap<i64, Topic>> {
    let mut statement = database.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let topic = |row: &Row| {
        let (schema, is_needed) = type_name(&row.get::<_, String>(2)?);
        let wire = Wire::named(&row.get::<_, String>(3)?);
        Ok((row.get(0)?, Topic { name: row.get(1)?, schema, wire, is_needed }))
    };
    statement.query_map([], topic)?.collect()
}

/// Returns the address of a file that is not changed, not even by SQLite's own files beside it. Changes that a recorder has
/// not yet merged are in a file beside it, and need those.
fn uri(path: &Path) -> String {
    let escaped = |byte: &u8| match byte {
        b'/' | b'-' | b'_' | b'.' | b'~' => char::from(*byte).to_string(),
        byte if byte.is_ascii_alphanumeric() => char::from(*byte).to_string(),
        byte => format!("%{byte:02X}"),
    };
    let text: String = path.to_string_lossy().replace('\\', "/").as_bytes().iter().map(escaped).collect();
    let mut beside = path.as_os_str().to_owned();
    beside.push("-wal");
    let is_merged = std::fs::metadata(beside).map_or(true, |log| log.len() == 0);
    format!("file:{text}{}", if is_merged { "?immutable=1" } else { "" })
}
