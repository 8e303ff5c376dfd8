//! Where files are read: on disk, or in a program without a disk, such as a page in a browser, which holds them.
//!
//! Everything that reads the user's files asks this module. What writes files needs a disk.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::SystemTime;

/// Reads bytes of the held file with this index from this offset on, and returns their number; 0 at the end.
pub type ReadAt = fn(usize, u64, &mut [u8]) -> usize;

/// A file that the program holds.
pub struct Held {
    /// Its path; folders follow from the paths in them.
    pub path: PathBuf,
    /// Its size in bytes.
    pub size: u64,
    /// When it was last modified, if known.
    pub modified: Option<SystemTime>,
}

/// A file that is open for reading.
#[derive(Debug)]
pub enum File {
    /// On disk.
    OnDisk(fs::File),
    /// Held by the program: its index, its size and the current position.
    Held(usize, u64, u64),
}

/// All held files.
struct Library {
    files: Vec<Held>,
    read_at: ReadAt,
}

static LIBRARY: OnceLock<Library> = OnceLock::new();

/// Holds files from now on: this process then reads these alone, and nothing on disk.
///
/// # Panics
/// When files are held already.
pub fn hold(files: Vec<Held>, read_at: ReadAt) {
    assert!(LIBRARY.set(Library { files, read_at }).is_ok(), "files are held once");
}

/// Opens a file.
///
/// # Errors
/// When it is missing or cannot be opened.
pub(super) fn open(path: &Path) -> io::Result<File> {
    let Some(library) = LIBRARY.get() else { return fs::File::open(path).map(File::OnDisk) };
    let index = library.index(path).ok_or_else(|| io::Error::new(ErrorKind::NotFound, "no such file"))?;
    Ok(File::Held(index, library.files[index].size, 0))
}

/// Returns the names of everything in a folder, in the order of the alphabet; names that are not UTF-8 are left out.
///
/// # Errors
/// When the folder is missing or cannot be read.
pub fn names(folder: &Path) -> io::Result<Vec<String>> {
    let names: BTreeSet<String> = match LIBRARY.get() {
        Some(library) => {
            library.below(folder).filter_map(|below| below.iter().next()?.to_str()).map(str::to_owned).collect()
        }
        None => fs::read_dir(folder)?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect(),
    };
    Ok(names.into_iter().collect())
}

/// Returns whether a path is a folder.
pub fn is_folder(path: &Path) -> bool {
    LIBRARY.get().map_or_else(|| path.is_dir(), |library| library.below(path).next().is_some())
}

/// Returns whether a path is a file.
pub fn is_file(path: &Path) -> bool {
    LIBRARY.get().map_or_else(|| path.is_file(), |library| library.index(path).is_some())
}

/// Returns whether a path is a file, a folder or anything else.
pub fn exists(path: &Path) -> bool {
    LIBRARY.get().map_or_else(|| path.exists(), |_| is_file(path) || is_folder(path))
}

/// Returns when a file was last modified, if that is known.
pub(super) fn modified(path: &Path) -> Option<SystemTime> {
    match LIBRARY.get() {
        Some(library) => library.files[library.index(path)?].modified,
        None => fs::metadata(path).ok()?.modified().ok(),
    }
}

impl Library {
    fn index(&self, path: &Path) -> Option<usize> {
        self.files.iter().position(|file| file.path == path)
    }

    /// The paths of all files in a folder and its folders, from the folder on.
    fn below<'l>(&'l self, folder: &'l Path) -> impl Iterator<Item = &'l Path> {
        self.files
            .iter()
            .filter_map(move |file| file.path.strip_prefix(folder).ok())
            .filter(|below| below.iter().next().is_some())
    }
}

impl File {
    /// Returns the size in bytes.
    ///
    /// # Errors
    /// When the disk does not say.
    pub fn size(&self) -> io::Result<u64> {
        match self {
            File::OnDisk(file) => file.metadata().map(|about| about.len()),
            File::Held(_, size, _) => Ok(*size),
        }
    }
}

impl Read for File {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            File::OnDisk(file) => file.read(buffer),
            File::Held(index, _, at) => {
                let read_at = LIBRARY.get().ok_or(ErrorKind::NotFound)?.read_at;
                let count = read_at(*index, *at, buffer);
                *at += count as u64;
                Ok(count)
            }
        }
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            File::OnDisk(file) => file.seek(to),
            File::Held(_, size, at) => {
                let target = match to {
                    SeekFrom::Start(target) => Some(target),
                    SeekFrom::End(offset) => size.checked_add_signed(offset),
                    SeekFrom::Current(offset) => at.checked_add_signed(offset),
                };
                *at = target.ok_or(ErrorKind::InvalidInput)?;
                Ok(*at)
            }
        }
    }
}
