//! Calls of the command `mindgap` in temporary folders.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use mindgap_logs::Logs;
use tempfile::TempDir;

/// A temporary folder in which tests call the command. Dropping it removes the folder.
pub struct Sandbox(TempDir);

/// Result of a call of the command.
#[derive(Debug)]
pub struct Outcome {
    /// Exit code.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Sandbox {
    /// Makes an empty folder.
    ///
    /// # Panics
    /// If the folder cannot be made.
    pub fn new() -> Self {
        Sandbox(tempfile::tempdir().expect("a temporary folder"))
    }

    /// Makes a folder with the logs of six short runs in `logs`, written by `mindgap record`.
    pub fn with_logs() -> Self {
        let sandbox = Sandbox::new();
        sandbox.run("record --out logs --runs 6 --steps 25");
        sandbox
    }

    /// Returns a copy of the folder.
    ///
    /// # Panics
    /// If the folder cannot be copied.
    pub fn copy(&self) -> Self {
        Sandbox::copy_of(self.path())
    }

    /// Returns a copy of what is in a folder, but not of its permissions: the originals may be read-only.
    ///
    /// # Panics
    /// If the folder cannot be copied.
    pub fn copy_of(folder: &Path) -> Self {
        let copy = Sandbox::new();
        for (path, bytes) in listing(folder) {
            let to = copy.path().join(path.strip_prefix(folder).expect("a path below this folder"));
            if path.is_dir() { fs::create_dir(to) } else { fs::write(to, bytes) }
                .expect("a folder that can be written");
        }
        copy
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Calls the command in this folder with arguments separated by spaces, on the default number of threads.
    pub fn call(&self, arguments: &str) -> Outcome {
        self.execute(self.command(arguments))
    }

    /// Calls the command on a given number of threads.
    pub fn call_on_threads(&self, threads: usize, arguments: &str) -> Outcome {
        let mut command = self.command(arguments);
        command.env("RAYON_NUM_THREADS", threads.to_string());
        self.execute(command)
    }

    /// Calls the command, expects success and returns its standard output.
    ///
    /// # Panics
    /// If the command fails.
    #[track_caller]
    pub fn run(&self, arguments: &str) -> String {
        let outcome = self.call(arguments);
        assert_eq!(outcome.code, 0, "mindgap {arguments}: {}", outcome.err);
        outcome.out
    }

    /// Calls the command, expects it to refuse, and returns its message: exit code 1, one line on standard error, nothing on
    /// standard output, and an unchanged folder.
    ///
    /// # Panics
    /// If the command does otherwise.
    #[track_caller]
    pub fn refused(&self, arguments: &str) -> String {
        let before = self.listing();
        let outcome = self.call(arguments);
        assert_eq!(outcome.code, 1, "mindgap {arguments}: {outcome:?}");
        assert_eq!(outcome.out, "", "mindgap {arguments}");
        assert_eq!(outcome.err.lines().count(), 1, "mindgap {arguments}: {}", outcome.err);
        assert_eq!(self.listing(), before, "mindgap {arguments}: what is left behind");
        outcome.err.trim_end().strip_prefix("mindgap: ").expect("a line that begins with the command's name").to_owned()
    }

    /// Returns a process that runs the command in this folder, to be started by the caller.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(&*MINDGAP);
        command.current_dir(self.path()).args(arguments.split_whitespace());
        command
    }

    /// Returns the bytes of a file.
    ///
    /// # Panics
    /// If the file cannot be read.
    #[track_caller]
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Returns the text of a file.
    ///
    /// # Panics
    /// If the file cannot be read.
    #[track_caller]
    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Returns the content of a JSON file.
    ///
    /// # Panics
    /// If the file cannot be read.
    #[track_caller]
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.bytes(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Reads a folder of logs.
    ///
    /// # Panics
    /// If it cannot be read, or has an oddity.
    #[track_caller]
    pub fn logs(&self, folder: &str) -> Logs {
        Logs::read(&self.0.path().join(folder), |warning| panic!("{warning}")).expect("logs")
    }

    /// Writes a file.
    ///
    /// # Panics
    /// If the file cannot be written.
    #[track_caller]
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path().join(name), content).unwrap_or_else(|e| panic!("{name}: {e}"));
    }

    /// Changes the cells of every row below the header of a CSV file.
    ///
    /// # Panics
    /// If the file cannot be read or written, or does not change.
    pub fn edit_cells(&self, path: &str, change: impl Fn(&mut [&str])) {
        self.edit(path, |text| {
            let (header, rows) = text.split_once('\n').expect("a header");
            let changed = rows.lines().map(|row| {
                let mut cells: Vec<&str> = row.split(',').collect();
                change(&mut cells);
                cells.join(",") + "\n"
            });
            format!("{header}\n{}", changed.collect::<String>())
        });
    }

    /// Changes a text file.
    ///
    /// # Panics
    /// If the file cannot be read or written, or does not change.
    #[track_caller]
    pub fn edit(&self, name: &str, change: impl FnOnce(String) -> String) {
        let before = self.text(name);
        let after = change(before.clone());
        assert_ne!(before, after, "{name} was meant to change");
        self.write(name, after);
    }

    /// Returns the bytes of every file below a folder in this one (`""` for this one) by its path in that folder.
    pub fn files(&self, folder: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        let root = self.path().join(folder);
        let files = self.listing().into_iter().filter(|(path, _)| path.is_file());
        files.filter_map(|(path, bytes)| Some((path.strip_prefix(&root).ok()?.to_owned(), bytes))).collect()
    }

    /// Returns every file and folder below this folder, in order, with the bytes of the files.
    pub fn listing(&self) -> Vec<(PathBuf, Vec<u8>)> {
        listing(self.path())
    }

    /// Runs a process and returns its result.
    ///
    /// # Panics
    /// If the process does not start, is ended by a signal, or writes text that is not UTF-8.
    pub fn execute(&self, mut command: Command) -> Outcome {
        let Output { status, stdout, stderr } = command.output().expect("the command starts");
        let text = |bytes| String::from_utf8(bytes).expect("the command writes UTF-8");
        Outcome { code: status.code().expect("the command ends by itself"), out: text(stdout), err: text(stderr) }
    }
}

impl Default for Sandbox {
    fn default() -> Self {
        Self::new()
    }
}

fn listing(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    collect(folder, &mut files);
    files.sort();
    files
}

fn collect(folder: &Path, files: &mut Vec<(PathBuf, Vec<u8>)>) {
    for entry in fs::read_dir(folder).expect("a folder that can be read") {
        let path = entry.expect("an entry that can be read").path();
        if path.is_dir() {
            // An empty folder counts as left behind too.
            files.push((path.clone(), Vec::new()));
            collect(&path, files);
        } else {
            let bytes = fs::read(&path).expect("a file that can be read");
            files.push((path, bytes));
        }
    }
}

/// The command under test. Cargo builds it two levels above this package's tests, which are in `target/PROFILE/deps`.
static MINDGAP: LazyLock<PathBuf> = LazyLock::new(|| {
    let test = std::env::current_exe().expect("a test knows its own path");
    let profile = test.ancestors().nth(2).expect("a test lies in deps below its profile's folder");
    let path = profile.join("mindgap-under-test").with_extension(std::env::consts::EXE_EXTENSION);
    assert!(path.is_file(), "{} is not there: run the tests by cargo test", path.display());
    path
});

/// Returns the path of the command's executable.
pub fn program() -> &'static Path {
    &MINDGAP
}

/// Returns the folder of the workspace.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in the workspace")
}
