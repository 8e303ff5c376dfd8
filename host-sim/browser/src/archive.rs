//! The contents of a ZIP archive, which the page itself unpacks.

use std::fmt::Display;
use std::path::Path;

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use rawzip::{CompressionMethod, RECOMMENDED_BUFFER_SIZE, ZipArchive};
use serde::Serialize;

use crate::report::Answer;

/// A file in an archive.
#[derive(Serialize)]
struct Entry {
    path: String,
    /// Where its bytes begin and end in the archive.
    range: (u64, u64),
    /// Whether they are compressed, by the one method that browsers know.
    is_deflated: bool,
}

/// Returns the files of an archive as JSON.
///
/// # Errors
/// When it is not an archive, is encrypted or damaged, or is compressed in another way.
pub fn answer(path: &Path) -> Result<Answer> {
    let failed = |why: &dyn Display| Error::in_file(path, format!("cannot be unpacked: {why}"));
    let mut buffer = vec![0; RECOMMENDED_BUFFER_SIZE];
    let archive = ZipArchive::from_seekable(files::open(path)?, &mut buffer).map_err(|e| failed(&e))?;
    let mut listing = archive.entries(&mut buffer);
    let mut entries = Vec::new();
    while let Some(entry) = listing.next_entry().map_err(|e| failed(&e))? {
        let method = entry.compression_method();
        if entry.is_dir() {
            continue;
        }
        if entry.flags().is_encrypted() || ![CompressionMethod::STORE, CompressionMethod::DEFLATE].contains(&method) {
            return Err(failed(&"it is encrypted, or compressed in a way that browsers do not know"));
        }
        let name = entry.file_path().try_normalize().map_err(|e| failed(&e))?;
        let found = archive.get_entry(entry.wayfinder()).map_err(|e| failed(&e))?;
        entries.push(Entry {
            path: name.as_ref().to_owned(),
            range: found.compressed_data_range(),
            is_deflated: method == CompressionMethod::DEFLATE,
        });
    }
    Ok(Answer { json: Some(files::json(path, &entries)?), ..Answer::default() })
}
