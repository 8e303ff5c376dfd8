//! Writing so that nothing is ever left half-written, and what is there keeps its mode, its links and its neighbours.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use tempfile::TempDir;

use crate::error::{Error, Result};

/// What stands for standard output, as a path.
const STANDARD_OUTPUT: [&str; 2] = ["-", "/dev/stdout"];
/// Folders of a process's open files: what lies there is written where it stands, whatever it is.
const OPEN_FILES: [&str; 4] = ["/dev/stdout", "/dev/stderr", "/dev/fd", "/proc/self/fd"];
/// Chains of links are followed so far, as by the system.
const MOST_LINKS: usize = 40;

/// Whether another process writes what this one would.
static IS_LEFT: AtomicBool = AtomicBool::new(false);

/// From now on nothing is written: another process does the same and writes it.
pub fn leave_writing() {
    IS_LEFT.store(true, Ordering::Relaxed);
}

/// Whether a path is that of standard output.
pub fn is_standard_output(path: &Path) -> bool {
    STANDARD_OUTPUT.iter().any(|name| path.as_os_str() == *name)
}

/// Whether what is there takes bytes as they come: a pipe, a terminal, a device, a file that is open already.
pub fn is_stream(path: &Path) -> bool {
    let is_open = OPEN_FILES.iter().any(|open| path.starts_with(open));
    is_standard_output(path) || is_open || fs::metadata(path).is_ok_and(|it| !it.is_file() && !it.is_dir())
}

/// Writes a file under a temporary name beside `path`, then renames it. A file that is there already keeps its mode, and
/// a link to it stays; a stream is written as it stands.
///
/// # Errors
/// When the folder is missing or not writable; `path` is then as it was.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    let content = content.as_ref();
    let written = if IS_LEFT.load(Ordering::Relaxed) {
        Ok(())
    } else if is_standard_output(path) {
        to_standard_output(content)
    } else if is_stream(path) {
        OpenOptions::new().append(true).open(path).and_then(|mut stream| stream.write_all(content))
    } else {
        replace(&behind_links(path), content)
            .inspect(|()| log::info!("{}: {} bytes written", path.display(), content.len()))
    };
    written.map_err(|e| {
        // The error's own text would name the temporary file.
        let folder = folder_of(path);
        let why = if folder.is_dir() { e.kind().to_string() } else { no_folder(folder) };
        Error::in_file(path, format!("cannot be written: {why}"))
    })
}

/// Writes to standard output. That nobody reads on is no error.
pub fn to_standard_output(content: &[u8]) -> io::Result<()> {
    if IS_LEFT.load(Ordering::Relaxed) {
        return Ok(());
    }
    let mut out = io::stdout().lock();
    match out.write_all(content).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(e),
        _ => Ok(()),
    }
}

/// Fills a folder under a temporary name, then moves what is in it to `path`. Of a folder that is there already, what
/// `ours` holds for goes, and everything else stays.
///
/// # Errors
/// What `fill` returns, or when the folder cannot be written.
pub fn write_folder(path: &Path, ours: impl Fn(&str) -> bool, fill: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    if IS_LEFT.load(Ordering::Relaxed) {
        return fill(path);
    }
    let failed = |e: io::Error| Error::in_file(path, format!("cannot be written: {e}"));
    let is_there = path.is_dir();
    // A folder may be a file system of its own, so that nothing can be renamed into it from beside it.
    let home = if is_there { path } else { folder_of(path) };
    fs::create_dir_all(home).map_err(failed)?;
    let workshop = tempfile::tempdir_in(home).map_err(failed)?;
    let fresh = workshop.path().join("new");
    fs::create_dir(&fresh).map_err(failed)?;
    fill(&fresh)?;
    if is_there { exchange(path, &workshop, &fresh, ours) } else { fs::rename(&fresh, path) }.map_err(failed)
}

/// The folder in which a path lies.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What there is to say of a folder that is not there.
pub fn no_folder(folder: &Path) -> String {
    format!("there is no folder {}", folder.display())
}

/// The path at the end of a chain of links, which need not lead to a file yet.
pub fn behind_links(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(target) = fs::read_link(&path) else { break };
        path = folder_of(&path).join(target);
    }
    path
}

fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut file = fresh_file().tempfile_in(folder_of(path))?;
    file.write_all(content)?;
    if let Ok(before) = fs::metadata(path) {
        file.as_file().set_permissions(before.permissions())?;
    }
    file.persist(path)?;
    Ok(())
}

/// A temporary file, which becomes the one that is written, is as readable as any new file.
fn fresh_file() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder
}

/// Puts what is in `fresh` in place of what is ours in a folder.
fn exchange(path: &Path, workshop: &TempDir, fresh: &Path, ours: impl Fn(&str) -> bool) -> io::Result<()> {
    let old = workshop.path().join("old");
    fs::create_dir(&old)?;
    for entry in fs::read_dir(path)? {
        let name = entry?.file_name();
        if path.join(&name) != workshop.path() && name.to_str().is_some_and(&ours) {
            fs::rename(path.join(&name), old.join(&name))?;
        }
    }
    for entry in fs::read_dir(fresh)? {
        let name = entry?.file_name();
        fs::rename(fresh.join(&name), path.join(&name))?;
    }
    Ok(())
}

/// Whether a file can be made in a folder.
///
/// # Errors
/// Why not.
pub fn try_folder(folder: &Path) -> io::Result<()> {
    tempfile::tempfile_in(folder).map(|_: File| ())
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    #[test]
    fn a_link_stays_and_a_mode_too() {
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
    fn a_link_to_nothing_yet_leads_to_the_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let link = folder.path().join("link");
        symlink("later", &link).expect("a link");
        write(&link, "new").expect("written");
        assert!(link.is_symlink() && folder.path().join("later").is_file());
    }

    #[test]
    fn what_others_keep_in_a_folder_stays() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in ["ours-1", "theirs"] {
            fs::write(folder.path().join(name), "old").expect("a file");
        }
        let fill = |fresh: &Path| write(&fresh.join("ours-2"), "new");
        write_folder(folder.path(), |name| name.starts_with("ours"), fill).expect("written");
        let mut names: Vec<_> =
            fs::read_dir(folder.path()).expect("a folder").flatten().map(|e| e.file_name()).collect();
        names.sort();
        assert_eq!(names, ["ours-2", "theirs"]);
    }
}
