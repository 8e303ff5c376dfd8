//! The brick's file system. Names are case-insensitive, and a file's size is reserved when it is created. The running
//! program is an open file itself and has the first handle.
//!
//! Source: `d_loader.c` of the firmware.

use std::collections::BTreeMap;

/// Status codes of the file calls.
pub(super) mod status {
    pub(in crate::brick) const OK: u16 = 0;
    pub(in crate::brick) const NO_MORE_HANDLES: u16 = 0x8100;
    pub(in crate::brick) const NO_SPACE: u16 = 0x8200;
    pub(in crate::brick) const NO_MORE_FILES: u16 = 0x8300;
    pub(in crate::brick) const END_EXPECTED: u16 = 0x8400;
    pub(in crate::brick) const END_OF_FILE: u16 = 0x8500;
    pub(in crate::brick) const NOT_FOUND: u16 = 0x8700;
    pub(in crate::brick) const CLOSED_HANDLE: u16 = 0x8800;
    pub(in crate::brick) const BUSY: u16 = 0x8B00;
    pub(in crate::brick) const NO_WRITE_BUFFERS: u16 = 0x8C00;
    pub(in crate::brick) const EXISTS: u16 = 0x8F00;
    pub(in crate::brick) const ILLEGAL_NAME: u16 = 0x9200;
}

const HANDLES: usize = 16;
const PROGRAM_HANDLE: usize = 0;
/// Number of files that can be open for writing at once.
const WRITE_BUFFERS: usize = 4;
const MAX_FILES: usize = 127;
const MAX_NAME: usize = 19;
const MAX_STEM: usize = 15;
const PAGE_BYTES: u32 = 256;

/// The files of a brick.
#[derive(Clone, Debug)]
pub(super) struct Flash {
    files: BTreeMap<String, File>,
    handles: [Option<Handle>; HANDLES],
    bytes: u32,
}

#[derive(Clone, Debug)]
struct File {
    name: String,
    content: Vec<u8>,
    reserved: u32,
}

#[derive(Clone, Debug)]
struct Handle {
    file: String,
    /// The name as the program wrote it.
    opened_as: String,
    /// Position of the next read; `None` if the file is open for writing.
    read_at: Option<usize>,
}

impl Flash {
    /// Returns a flash of `bytes` bytes that holds these files.
    pub(super) fn new(bytes: u32, files: &BTreeMap<String, Vec<u8>>) -> Self {
        let file = |(name, content): (&String, &Vec<u8>)| {
            let file = File { name: name.clone(), content: content.clone(), reserved: content.len() as u32 };
            (name.to_ascii_lowercase(), file)
        };
        Flash { files: files.iter().map(file).collect(), handles: Default::default(), bytes }
    }

    pub(super) fn create(&mut self, name: &str, reserved: u32) -> Result<u8, u16> {
        check_name(name)?;
        let key = name.to_ascii_lowercase();
        if self.files.contains_key(&key) {
            return Err(status::EXISTS);
        }
        if self.files.len() >= MAX_FILES {
            return Err(status::NO_MORE_FILES);
        }
        if pages(reserved) > self.free_pages() {
            return Err(status::NO_SPACE);
        }
        let handle = self.open(Handle { file: key.clone(), opened_as: name.to_owned(), read_at: None })?;
        self.files.insert(key, File { name: name.to_owned(), content: Vec::new(), reserved });
        Ok(handle)
    }

    /// Opens a file at its end. Returns the handle and the number of bytes still reserved.
    pub(super) fn append(&mut self, name: &str) -> Result<(u8, u32), u16> {
        let key = self.find(name)?;
        let file = &self.files[&key];
        let left = file.reserved - file.content.len() as u32;
        Ok((self.open(Handle { file: key, opened_as: name.to_owned(), read_at: None })?, left))
    }

    /// Opens a file at its start. Returns the handle and its length.
    pub(super) fn open_read(&mut self, name: &str) -> Result<(u8, u32), u16> {
        let key = self.find(name)?;
        let length = self.files[&key].content.len() as u32;
        Ok((self.open(Handle { file: key, opened_as: name.to_owned(), read_at: Some(0) })?, length))
    }

    /// Writes as much as fits. Returns the status and the number of bytes written.
    pub(super) fn write(&mut self, handle: u8, bytes: &[u8]) -> (u16, u32) {
        let slot = self.handles.get(usize::from(handle)).and_then(Option::as_ref);
        let Some(Handle { file, read_at: None, .. }) = slot else { return (status::CLOSED_HANDLE, 0) };
        let Some(file) = self.files.get_mut(file) else { return (status::CLOSED_HANDLE, 0) };
        let room = (file.reserved as usize).saturating_sub(file.content.len());
        let fits = &bytes[..bytes.len().min(room)];
        file.content.extend_from_slice(fits);
        let status = if fits.len() < bytes.len() { status::END_EXPECTED } else { status::OK };
        (status, fits.len() as u32)
    }

    pub(super) fn read(&mut self, handle: u8, limit: u32) -> (u16, Vec<u8>) {
        let slot = self.handles.get_mut(usize::from(handle)).and_then(Option::as_mut);
        let Some(Handle { file, read_at: Some(at), .. }) = slot else { return (status::CLOSED_HANDLE, Vec::new()) };
        let Some(file) = self.files.get(file) else { return (status::CLOSED_HANDLE, Vec::new()) };
        let rest = &file.content[(*at).min(file.content.len())..];
        let taken = &rest[..rest.len().min(limit as usize)];
        *at += taken.len();
        let status = if (taken.len() as u32) < limit { status::END_OF_FILE } else { status::OK };
        (status, taken.to_vec())
    }

    pub(super) fn close(&mut self, handle: u8) -> u16 {
        match self.handles.get_mut(usize::from(handle)).and_then(Option::take) {
            Some(_) => status::OK,
            None => status::CLOSED_HANDLE,
        }
    }

    /// Returns the handle of the file that was opened by exactly this name, and whether it is open for writing.
    pub(super) fn resolve(&self, name: &str) -> Option<(u8, bool)> {
        let mut open = self.handles.iter().enumerate().filter_map(|(i, handle)| Some((i, handle.as_ref()?)));
        open.find(|(_, handle)| handle.opened_as == name).map(|(i, handle)| (i as u8, handle.read_at.is_none()))
    }

    /// Returns the free flash in bytes, in whole pages.
    pub(super) fn free_bytes(&self) -> u32 {
        self.free_pages() * PAGE_BYTES
    }

    /// Returns the names that match a pattern, either part of which may be a star.
    pub(super) fn list(&self, pattern: &str) -> Vec<&str> {
        let parts = |name: &str| {
            let name = name.to_ascii_lowercase();
            let (stem, extension) = name.split_once('.').unwrap_or((&name, ""));
            [stem.to_owned(), extension.to_owned()]
        };
        let wanted = parts(pattern);
        let fits = |name: &str| parts(name).iter().zip(&wanted).all(|(part, wanted)| wanted == "*" || part == wanted);
        self.files.values().map(|file| file.name.as_str()).filter(|name| fits(name)).collect()
    }

    fn free_pages(&self) -> u32 {
        let used: u32 = self.files.values().map(|file| pages(file.reserved)).sum();
        (self.bytes / PAGE_BYTES).saturating_sub(used)
    }

    pub(super) fn rename(&mut self, old: &str, new: &str) -> u16 {
        let key = match check_name(new).and_then(|()| self.find(old)) {
            Ok(_) if self.files.contains_key(&new.to_ascii_lowercase()) => return status::EXISTS,
            Ok(key) => key,
            Err(status) => return status,
        };
        if let Some(file) = self.files.remove(&key) {
            self.files.insert(new.to_ascii_lowercase(), File { name: new.to_owned(), ..file });
        }
        status::OK
    }

    pub(super) fn delete(&mut self, name: &str) -> u16 {
        match self.find(name) {
            Ok(key) => {
                self.files.remove(&key);
                status::OK
            }
            Err(status) => status,
        }
    }

    /// Returns all files by name, with the bytes written.
    pub(super) fn into_files(self) -> BTreeMap<String, Vec<u8>> {
        self.files.into_values().map(|file| (file.name, file.content)).collect()
    }

    /// Returns the key of an existing file that is not open.
    fn find(&self, name: &str) -> Result<String, u16> {
        let key = name.to_ascii_lowercase();
        if !self.files.contains_key(&key) {
            return Err(status::NOT_FOUND);
        }
        if self.handles.iter().flatten().any(|handle| handle.file == key) {
            return Err(status::BUSY);
        }
        Ok(key)
    }

    fn open(&mut self, handle: Handle) -> Result<u8, u16> {
        let writing = self.handles.iter().flatten().filter(|open| open.read_at.is_none()).count();
        if handle.read_at.is_none() && writing >= WRITE_BUFFERS {
            return Err(status::NO_WRITE_BUFFERS);
        }
        let is_free = |at: &usize| *at != PROGRAM_HANDLE && self.handles[*at].is_none();
        let free = (0..HANDLES).find(is_free).ok_or(status::NO_MORE_HANDLES)?;
        self.handles[free] = Some(handle);
        Ok(free as u8)
    }
}

fn pages(bytes: u32) -> u32 {
    bytes.div_ceil(PAGE_BYTES)
}

fn check_name(name: &str) -> Result<(), u16> {
    let stem = name.split_once('.').map_or(0, |(stem, _)| stem.len());
    if name.is_empty() || name.len() > MAX_NAME || stem > MAX_STEM {
        return Err(status::ILLEGAL_NAME);
    }
    Ok(())
}
