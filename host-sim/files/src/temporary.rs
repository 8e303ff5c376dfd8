//! Temporary files: recognisable by name, locked while their process runs, and registered in it, so that none is left behind.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

/// Temporary names have random letters and digits between prefix and suffix.
const PREFIX: &str = ".mindgap-";
const SUFFIX: &str = ".tmp";
const RANDOM: usize = 6;

/// The temporary paths of this process.
pub type Names = BTreeSet<PathBuf>;
static IN_USE: Mutex<Names> = Mutex::new(Names::new());

/// Locks the temporary paths of this process. While they are locked, none is added and no signal ends the process.
pub fn in_use() -> MutexGuard<'static, Names> {
    IN_USE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Registers a temporary path of this process until it is dropped.
pub struct InUse(pub PathBuf);

impl Drop for InUse {
    fn drop(&mut self) {
        in_use().remove(&self.0);
    }
}

/// A file that gets its final name once it is complete.
pub struct TemporaryFile {
    file: NamedTempFile,
    _in_use: InUse,
}

impl TemporaryFile {
    /// Creates a file in a folder, with the permissions of any new file there.
    ///
    /// # Errors
    /// When it cannot be created.
    pub fn in_folder(folder: &Path) -> io::Result<Self> {
        let mut names = in_use();
        loop {
            let mut builder = builder();
            permit(&mut builder);
            let file = builder.tempfile_in(folder)?;
            if lock_new(file.as_file(), file.path()) {
                names.insert(file.path().to_owned());
                let in_use = InUse(file.path().to_owned());
                return Ok(TemporaryFile { file, _in_use: in_use });
            }
        }
    }

    /// Writes and synchronises the content, so that a full disk is reported before the file gets its final name.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&mut self, content: &[u8]) -> io::Result<()> {
        self.file.write_all(content)?;
        self.file.as_file().sync_all()
    }

    /// Copies the permissions of another file, if that exists.
    ///
    /// # Errors
    /// When they cannot be set.
    pub fn copy_mode_from(&self, path: &Path) -> io::Result<()> {
        fs::metadata(path).map_or(Ok(()), |before| self.file.as_file().set_permissions(before.permissions()))
    }

    /// Renames it to `path`, replacing what is there.
    ///
    /// # Errors
    /// When it cannot be renamed.
    pub fn rename_to(self, path: &Path) -> io::Result<()> {
        self.file.persist(path)?;
        Ok(())
    }
}

/// Returns a builder of temporary names.
pub fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM);
    builder
}

/// Gives a file the permissions of any new file.
#[cfg(unix)]
fn permit(builder: &mut Builder) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn permit(_: &mut Builder) {}

/// Returns whether a path has a temporary name.
pub fn is_temporary(path: &Path) -> bool {
    let between = |name: &str| Some(name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?.len());
    path.file_name().and_then(|name| name.to_str()).and_then(between) == Some(RANDOM)
}

/// Locks a file just created at `path` until it is closed. Returns `false` if another process removed it as stale in between.
pub fn lock_new(lock: &File, path: &Path) -> bool {
    // Without locks in the file system, no process removes stale files.
    !matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) && path.exists()
}
