//! The command `mindgap` as a black box, in a folder of its own.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use tempfile::TempDir;

/// A folder to work in, gone when it is dropped.
pub struct Workshop(TempDir);

/// What a call of the command came to.
#[derive(Debug)]
pub struct Done {
    /// What it exited with.
    pub code: i32,
    /// What it said on standard output.
    pub out: String,
    /// What it said on standard error.
    pub err: String,
}

impl Workshop {
    /// An empty folder.
    pub fn new() -> Self {
        Workshop(tempfile::tempdir().expect("a temporary folder"))
    }

    /// A folder with small logs in `logs`, as `mindgap record` makes them.
    pub fn with_logs() -> Self {
        let workshop = Workshop::new();
        workshop.done("record --out logs --runs 6 --steps 25");
        workshop
    }

    /// A folder with the same in it.
    pub fn copy(&self) -> Self {
        let copy = Workshop::new();
        for (path, bytes) in self.listing() {
            let to = copy.path().join(path.strip_prefix(self.path()).expect("a path below this folder"));
            if path.is_dir() { fs::create_dir(to) } else { fs::write(to, bytes) }
                .expect("a folder that can be written");
        }
        copy
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Calls the command in this folder with arguments that blanks part, on so many threads as the machine likes.
    pub fn call(&self, arguments: &str) -> Done {
        self.run(self.command(arguments))
    }

    /// The same on so many threads.
    pub fn call_on_threads(&self, threads: usize, arguments: &str) -> Done {
        let mut command = self.command(arguments);
        command.env("RAYON_NUM_THREADS", threads.to_string());
        self.run(command)
    }

    /// Calls the command and expects success; returns what it said.
    #[track_caller]
    pub fn done(&self, arguments: &str) -> String {
        let done = self.call(arguments);
        assert_eq!(done.code, 0, "mindgap {arguments}: {}", done.err);
        done.out
    }

    /// Calls the command and expects that it refuses: one line on standard error, which is returned, nothing on
    /// standard output, and a folder that is as it was.
    #[track_caller]
    pub fn refused(&self, arguments: &str) -> String {
        let before = self.listing();
        let done = self.call(arguments);
        assert_eq!(done.code, 1, "mindgap {arguments}: {done:?}");
        assert_eq!(done.out, "", "mindgap {arguments}");
        assert_eq!(done.err.lines().count(), 1, "mindgap {arguments}: {}", done.err);
        assert_eq!(self.listing(), before, "mindgap {arguments}: what is left behind");
        done.err.trim_end().strip_prefix("mindgap: ").expect("a line that begins with the command's name").to_owned()
    }

    /// A process that runs the command in this folder.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(&*MINDGAP);
        command.current_dir(self.path()).args(arguments.split_whitespace());
        command
    }

    /// A file's bytes.
    #[track_caller]
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// A file's text.
    #[track_caller]
    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// A file's JSON.
    #[track_caller]
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.bytes(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Writes a file.
    #[track_caller]
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path().join(name), content).unwrap_or_else(|e| panic!("{name}: {e}"));
    }

    /// Changes the cells of every row below the header of a CSV file.
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

    /// Rewrites a text file.
    #[track_caller]
    pub fn edit(&self, name: &str, change: impl FnOnce(String) -> String) {
        let before = self.text(name);
        let after = change(before.clone());
        assert_ne!(before, after, "{name} was meant to change");
        self.write(name, after);
    }

    /// Every file below a folder in this one (`""` for this one) by its path in it, with its bytes. Folders count for
    /// nothing.
    pub fn files(&self, folder: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        let root = self.path().join(folder);
        let files = self.listing().into_iter().filter(|(path, _)| path.is_file());
        files.filter_map(|(path, bytes)| Some((path.strip_prefix(&root).ok()?.to_owned(), bytes))).collect()
    }

    /// Every file and folder below this folder with its bytes, in order.
    pub fn listing(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut files = Vec::new();
        collect(self.path(), &mut files);
        files.sort();
        files
    }
}

impl Workshop {
    /// Runs a prepared process.
    pub fn run(&self, mut command: Command) -> Done {
        let Output { status, stdout, stderr } = command.output().expect("the command starts");
        let text = |bytes| String::from_utf8(bytes).expect("the command writes UTF-8");
        Done { code: status.code().expect("the command ends by itself"), out: text(stdout), err: text(stderr) }
    }
}

impl Default for Workshop {
    fn default() -> Self {
        Self::new()
    }
}

fn collect(folder: &Path, files: &mut Vec<(PathBuf, Vec<u8>)>) {
    for entry in fs::read_dir(folder).expect("a folder that can be read") {
        let path = entry.expect("an entry that can be read").path();
        if path.is_dir() {
            // The folder itself counts too: an empty one is something left behind.
            files.push((path.clone(), Vec::new()));
            collect(&path, files);
        } else {
            let bytes = fs::read(&path).expect("a file that can be read");
            files.push((path, bytes));
        }
    }
}

/// The command under test, which cargo builds beside this package's tests: `target/PROFILE/deps/TEST` has it two up.
static MINDGAP: LazyLock<PathBuf> = LazyLock::new(|| {
    let test = std::env::current_exe().expect("a test knows its own path");
    let profile = test.ancestors().nth(2).expect("a test lies in deps below its profile's folder");
    let path = profile.join("mindgap-under-test").with_extension(std::env::consts::EXE_EXTENSION);
    assert!(path.is_file(), "{} is not there: run the tests by cargo test", path.display());
    path
});

/// The command's own file.
pub fn program() -> &'static Path {
    &MINDGAP
}

/// The folder of the workspace.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in the workspace")
}
