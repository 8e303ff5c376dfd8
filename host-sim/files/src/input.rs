//! Opens files for reading: regular files, and streams that the user has opened. Pipes and devices would be read for ever.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::source::{self, File};
use super::write::is_open_file;
use mindgap_foundations::error::{Error, Result};

/// Opens a regular file, or a stream such as `/dev/stdin`.
///
/// # Errors
/// When it is missing, a named pipe, a socket or a device, or cannot be opened.
pub fn open(path: &Path) -> Result<File> {
    if fs::metadata(path).is_ok_and(|about| !about.is_file() && !about.is_dir()) && !is_open_file(path) {
        return Err(Error::in_file(path, "is a pipe, a socket or a device: only regular files are read"));
    }
    source::open(path).map_err(|e| unreadable(path, &e))
}

/// Reads a file of at most `max_bytes`.
///
/// # Errors
/// As [`open`], or when the file is larger.
pub fn read_bytes(path: &Path, max_bytes: u64) -> Result<Vec<u8>> {
    read_at_most(path, open(path)?, max_bytes)
}

/// Reads what is left of a file, at most `max_bytes`; `path` is for messages.
pub(super) fn read_at_most(path: &Path, file: impl Read, max_bytes: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(max_bytes + 1).read_to_end(&mut bytes).map_err(|e| unreadable(path, &e))?;
    if bytes.len() as u64 > max_bytes {
        return Err(Error::in_file(path, format!("is larger than {} MB", max_bytes >> 20)));
    }
    Ok(bytes)
}

/// Returns the absolute path of a file, which need not exist: programs that are called have folders of their own.
///
/// # Errors
/// When the path is empty, or the current folder is not known.
pub fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).map_err(|e| Error::in_file(path, format!("has no absolute path: {e}")))
}

/// Returns the path of a file in a folder, which must not be a link out of it.
///
/// # Errors
/// When the name has a folder in it, or the file is a link.
pub fn in_folder(folder: &Path, name: &str) -> Result<PathBuf> {
    let is_plain = Path::new(name).file_name().is_some_and(|file| file == name) && !name.contains(['/', '\\', ':']);
    if !is_plain {
        return Err(Error::in_file(folder, format!("{name:?} is not the name of a file in this folder")));
    }
    let path = folder.join(name);
    match path.is_symlink() {
        true => Err(Error::in_file(&path, "is a link: files of this folder must lie in it")),
        false => Ok(path),
    }
}

/// Returns the error of a file or folder that cannot be read.
pub fn unreadable(path: &Path, why: &io::Error) -> Error {
    Error::in_file(path, format!("cannot be read: {why}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_their_folder() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let is_in = |name: &str| in_folder(folder.path(), name).is_ok();
        assert!(is_in("trial-1.csv") && is_in("..a"));
        for name in ["", ".", "..", "/etc/passwd", "../a", "a/b", "a/", "a\\b", "c:a"] {
            assert!(!is_in(name), "{name}");
        }
    }

    #[test]
    fn large_files_are_refused_before_they_fill_memory() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a");
        fs::File::create(&path).and_then(|file| file.set_len(1 << 40)).expect("a sparse file");
        let why = read_bytes(&path, 1 << 20).expect_err("too large").to_string();
        assert!(why.ends_with("is larger than 1 MB"), "{why}");
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [pipe, link] = ["pipe", "link"].map(|name| folder.path().join(name));
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
        std::os::unix::fs::symlink("/dev/zero", &link).expect("a link");
        for path in [&pipe, &link] {
            let why = open(path).expect_err("not a file").to_string();
            assert!(why.contains("only regular files are read"), "{why}");
            assert!(in_folder(folder.path(), "link").is_err());
        }
    }
}
