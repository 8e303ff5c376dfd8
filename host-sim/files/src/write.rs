//! Writes files and folders atomically, keeping permissions, links and unrelated files.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use super::staging::StagingFolder;
use super::stale_temp;
use super::temporary::{TemporaryFile, is_temporary};
use mindgap_foundations::error::{Error, Result};

/// Paths that mean standard output.
const STANDARD_OUTPUT: [&str; 2] = ["-", "/dev/stdout"];
/// Folders of a process's open files: files there are written in place.
const OPEN_FILES: [&str; 5] = ["/dev/stdin", "/dev/stdout", "/dev/stderr", "/dev/fd", "/proc/self/fd"];
/// Maximum number of links to follow, as on Linux.
const MOST_LINKS: usize = 40;

/// Whether another process writes the outputs.
static IS_DISABLED: AtomicBool = AtomicBool::new(false);

/// Disables all writing in this process, for ranks other than the first.
pub fn disable_writing() {
    IS_DISABLED.store(true, Ordering::Relaxed);
}

/// Returns whether this process writes outputs.
pub fn is_writing() -> bool {
    !IS_DISABLED.load(Ordering::Relaxed)
}

/// Returns whether a path means standard output.
pub fn is_standard_output(path: &Path) -> bool {
    STANDARD_OUTPUT.iter().any(|name| path.as_os_str() == *name)
}

/// Returns whether a path is a stream: a pipe, a terminal, a device, a file that is already open.
pub fn is_stream(path: &Path) -> bool {
    is_standard_output(path) || is_open_file(path) || fs::metadata(path).is_ok_and(|it| !it.is_file() && !it.is_dir())
}

/// Returns whether a path is a file that this process has open.
pub fn is_open_file(path: &Path) -> bool {
    OPEN_FILES.iter().any(|open| path.starts_with(open))
}

/// Writes a file under a temporary name next to `path`, then renames it. An existing file keeps its permissions, and a link to
/// it stays; a stream is written directly. If several processes write one file, the last one wins.
///
/// # Errors
/// When the folder is missing or not writable; `path` then stays as it was.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    let content = content.as_ref();
    let written = if !is_writing() {
        Ok(())
    } else if is_standard_output(path) {
        to_standard_output(content)
    } else if is_stream(path) {
        OpenOptions::new().append(true).open(path).and_then(|mut stream| stream.write_all(content))
    } else if is_staged(path) {
        // Nobody reads it before its folder is moved into place.
        fs::write(path, content)
    } else {
        replace(&behind_links(path), content)
            .inspect(|()| log::info!("{}: {} bytes written", path.display(), content.len()))
    };
    written.map_err(|e| {
        let folder = folder_of(path);
        let why = if folder.is_dir() { reason(&e) } else { missing_folder(folder) };
        Error::in_file(path, format!("cannot be written: {why}"))
    })
}

/// Returns the system's error message without the temporary path that the tempfile crate adds.
pub fn reason(e: &io::Error) -> String {
    let message = e.to_string();
    message.split_once(" at path \"").map_or(message.clone(), |(why, _)| why.to_owned())
}

/// Writes to standard output. A closed pipe is not an error.
pub fn to_standard_output(content: &[u8]) -> io::Result<()> {
    if !is_writing() {
        return Ok(());
    }
    let mut out = io::stdout().lock();
    match out.write_all(content).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(e),
        _ => Ok(()),
    }
}

/// Creates a folder unless it exists, and removes what killed processes left in it.
///
/// # Errors
/// When it cannot be created.
pub fn make_folder(path: &Path) -> Result<()> {
    if !is_writing() {
        return Ok(());
    }
    fs::create_dir_all(path).map_err(|e| Error::in_file(path, format!("cannot be created: {e}")))?;
    stale_temp::clear(path);
    Ok(())
}

/// Fills a folder under a temporary name, then moves its content to `path`: all of it or nothing. In an existing folder, files
/// for which `is_own` holds are removed and all others stay. If several processes fill one existing folder, the last one wins;
/// a new folder is not replaced once it is there. Returns what `fill` returns.
///
/// # Errors
/// What `fill` returns, or when the folder cannot be written.
pub fn write_folder<T>(path: &Path, is_own: impl Fn(&str) -> bool, fill: impl FnOnce(&Path) -> Result<T>) -> Result<T> {
    if !is_writing() {
        return fill(path);
    }
    let failed = |e: io::Error| Error::in_file(path, format!("cannot be written: {}", reason(&e)));
    if is_staged(path) {
        fs::create_dir_all(path).map_err(failed)?;
        return fill(path);
    }
    let exists = path.is_dir();
    // A folder may be a mount point, so that files next to it cannot be renamed into it.
    let staged_in = if exists { path } else { folder_of(path) };
    fs::create_dir_all(staged_in).map_err(failed)?;
    let staging = StagingFolder::in_folder(staged_in).map_err(failed)?;
    let new_folder = staging.new_folder();
    let filled = fill(&new_folder).map_err(|e| e.moved(&new_folder, path))?;
    if exists { staging.exchange(is_own) } else { fs::rename(&new_folder, path) }.map_err(failed)?;
    Ok(filled)
}

/// Returns whether a path lies in a staging folder.
fn is_staged(path: &Path) -> bool {
    path.ancestors().any(is_temporary)
}

/// Returns the folder that contains a path.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Returns the message for a missing folder.
pub fn missing_folder(folder: &Path) -> String {
    format!("there is no folder {}", folder.display())
}

/// Follows a chain of links to its end, where there need not be a file yet.
pub fn behind_links(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(target) = fs::read_link(&path) else { break };
        path = folder_of(&path).join(target);
    }
    path
}

fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut file = TemporaryFile::in_folder(folder_of(path))?;
    file.write(content)?;
    file.copy_mode_from(path)?;
    file.rename_to(path)
}

/// Checks that a file can be created in a folder.
///
/// # Errors
/// When it cannot.
pub fn try_folder(folder: &Path) -> io::Result<()> {
    tempfile::tempfile_in(folder).map(|_: File| ())
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    #[test]
    fn links_and_permissions_are_kept() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").expect("a file");
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).expect("a mode");
        symlink("file", &link).expect("a link");
        write(&link, "new").expect("written");
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&file).expect("a file"), "new");
        assert_eq!(fs::metadata(&file).expect("a file").permissions().mode() & 0o777, 0o640);
    }

    #[test]
    fn dangling_link_is_written_through() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let link = folder.path().join("link");
        symlink("later", &link).expect("a link");
        write(&link, "new").expect("written");
        assert!(link.is_symlink() && folder.path().join("later").is_file());
    }

    #[test]
    fn unrelated_files_in_a_folder_stay() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in ["ours-1", "theirs"] {
            fs::write(folder.path().join(name), "old").expect("a file");
        }
        let fill = |new_folder: &Path| write(&new_folder.join("ours-2"), "new");
        write_folder(folder.path(), |name| name.starts_with("ours"), fill).expect("written");
        let mut names: Vec<_> =
            fs::read_dir(folder.path()).expect("a folder").flatten().map(|e| e.file_name()).collect();
        names.sort();
        assert_eq!(names, ["ours-2", "theirs"]);
    }
}
