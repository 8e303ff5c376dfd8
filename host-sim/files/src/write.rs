//! Writing so that nothing is ever left half-written, and what is there keeps its mode, its links and its neighbours.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use super::leftovers;
use super::temporary::{TemporaryFile, is_temporary};
use super::workshop::Workshop;
use mindgap_foundations::error::{Error, Result};

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
/// a link to it stays; a stream is written as it stands. Of several processes that write one file, the last stays.
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
    } else if is_in_workshop(path) {
        // It has no name yet that anybody looks for.
        fs::write(path, content)
    } else {
        replace(&behind_links(path), content)
            .inspect(|()| log::info!("{}: {} bytes written", path.display(), content.len()))
    };
    written.map_err(|e| {
        let folder = folder_of(path);
        let why = if folder.is_dir() { reason(&e) } else { no_folder(folder) };
        Error::in_file(path, format!("cannot be written: {why}"))
    })
}

/// What the system says, without the temporary path that is named by what makes those.
pub fn reason(e: &io::Error) -> String {
    let said = e.to_string();
    said.split_once(" at path \"").map_or(said.clone(), |(why, _)| why.to_owned())
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

/// Makes a folder unless it is there, and clears it of what killed processes left.
///
/// # Errors
/// When it cannot be made.
pub fn make_folder(path: &Path) -> Result<()> {
    if IS_LEFT.load(Ordering::Relaxed) {
        return Ok(());
    }
    fs::create_dir_all(path).map_err(|e| Error::in_file(path, format!("cannot be made: {e}")))?;
    leftovers::clear(path);
    Ok(())
}

/// Fills a folder under a temporary name, then puts what is in it into `path`: all of it or nothing. Of a folder that is
/// there already, what `ours` holds for goes, and everything else stays. Of several processes that fill a folder that was
/// there, the last stays; one that is there only when it is complete is not replaced. Returns what `fill` does.
///
/// # Errors
/// What `fill` returns, or when the folder cannot be written.
pub fn write_folder<T>(path: &Path, ours: impl Fn(&str) -> bool, fill: impl FnOnce(&Path) -> Result<T>) -> Result<T> {
    if IS_LEFT.load(Ordering::Relaxed) {
        return fill(path);
    }
    let failed = |e: io::Error| Error::in_file(path, format!("cannot be written: {}", reason(&e)));
    if is_in_workshop(path) {
        fs::create_dir_all(path).map_err(failed)?;
        return fill(path);
    }
    let is_there = path.is_dir();
    // A folder may be a file system of its own, so that nothing can be renamed into it from beside it.
    let home = if is_there { path } else { folder_of(path) };
    fs::create_dir_all(home).map_err(failed)?;
    let workshop = Workshop::in_folder(home).map_err(failed)?;
    let fresh = workshop.new_folder();
    let filled = fill(&fresh).map_err(|e| e.moved(&fresh, path))?;
    if is_there { workshop.exchange(ours) } else { fs::rename(&fresh, path) }.map_err(failed)?;
    Ok(filled)
}

/// Whether a path lies in a folder that is being made and is put in its place as a whole.
fn is_in_workshop(path: &Path) -> bool {
    path.ancestors().any(is_temporary)
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
    let mut file = TemporaryFile::in_folder(folder_of(path))?;
    file.write(content)?;
    file.take_mode_of(path)?;
    file.become_file(path)
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
