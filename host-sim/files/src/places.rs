//! The inputs and outputs of a command, checked before it starts: it never overwrites its inputs or files that mindgap did
//! not write.

use std::fs;
use std::path::{Path, PathBuf};

use super::input::read_bytes;
use super::stale_temp;
use super::text::MAX_BYTES;
use super::write::{behind_links, folder_of, is_standard_output, is_stream, missing_folder, reason, try_folder};
use mindgap_foundations::error::{Error, Result};

/// The kind of a file that a command writes.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Name for messages, with its article.
    pub name: &'static str,
    /// Whether content is of this kind and was written by mindgap, so that it may be overwritten.
    pub is_own: fn(&[u8]) -> bool,
}

/// The inputs and outputs of one call of a command.
#[derive(Default)]
pub struct Places {
    inputs: Vec<PathBuf>,
    outputs: Vec<Output>,
}

struct Output {
    path: PathBuf,
    form: Form,
}

#[derive(Clone, Copy)]
enum Form {
    File(Kind),
    Folder,
}

impl Places {
    /// Adds files or folders that are read.
    pub fn reading<'a>(mut self, paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        self.inputs.extend(paths.into_iter().cloned());
        self
    }

    /// Adds files of a kind that are written.
    pub fn writing<'a>(mut self, paths: impl IntoIterator<Item = &'a PathBuf>, kind: Kind) -> Self {
        self.outputs.extend(paths.into_iter().map(|path| Output { path: path.clone(), form: Form::File(kind) }));
        self
    }

    /// Adds folders that are filled.
    pub fn filling<'a>(mut self, paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        self.outputs.extend(paths.into_iter().map(|path| Output { path: path.clone(), form: Form::Folder }));
        self
    }

    /// Returns the inputs.
    pub fn inputs(&self) -> &[PathBuf] {
        &self.inputs
    }

    /// Returns the outputs.
    pub fn outputs(&self) -> impl Iterator<Item = PathBuf> {
        self.outputs.iter().map(|output| output.path.clone())
    }

    /// Returns whether a path, as given, is an input or output.
    pub fn contains(&self, path: &Path) -> bool {
        self.inputs.iter().any(|input| input == path) || self.outputs.iter().any(|output| output.path == path)
    }

    /// Checks that all outputs can be written. With `force`, existing files may be overwritten; when `resuming`, an earlier run
    /// may already have filled output folders.
    ///
    /// # Errors
    /// When an output cannot be written, is named twice, or would overwrite something without `force`.
    pub fn check(&self, force: bool, resuming: bool) -> Result<()> {
        for (i, output) in self.outputs.iter().enumerate() {
            output.check_writable()?;
            let is_same = |other: &&Output| !is_sink(&output.path) && resolved(&other.path) == resolved(&output.path);
            if self.outputs[..i].iter().any(|other| is_same(&other)) {
                return Err(Error::in_file(&output.path, "is given for two outputs: give each its own path"));
            }
            let is_ours = resuming && matches!(output.form, Form::Folder);
            if !force && !is_ours {
                output.check_overwrite(&self.inputs)?;
            }
        }
        Ok(())
    }

    /// Returns whether an output goes to standard output, so that nothing else may be printed there.
    pub fn use_standard_output(&self) -> bool {
        self.outputs.iter().any(|output| is_standard_output(&output.path))
    }
}

impl Output {
    fn check_writable(&self) -> Result<()> {
        let path = &behind_links(&self.path);
        let failed = |why: String| Err(Error::in_file(&self.path, format!("cannot be written: {why}")));
        match self.form {
            _ if is_stream(&self.path) => match self.form {
                Form::File(_) => return Ok(()),
                Form::Folder => return failed("must be a folder".into()),
            },
            Form::File(_) if path.is_dir() => return failed("a folder of that name exists".into()),
            Form::Folder if path.exists() && !path.is_dir() => return failed("a file of that name exists".into()),
            _ => (),
        }
        let home = match self.form {
            Form::File(_) => folder_of(path),
            // Missing parent folders will be created.
            Form::Folder => path.ancestors().find(|above| above.is_dir()).unwrap_or(Path::new(".")),
        };
        if !home.is_dir() {
            return failed(missing_folder(home));
        }
        stale_temp::clear(home);
        try_folder(home).or_else(|e| failed(reason(&e)))
    }

    fn check_overwrite(&self, inputs: &[PathBuf]) -> Result<()> {
        let refused = |why: &str| Err(Error::in_file(&self.path, format!("{why}; --force replaces it")));
        let path = &self.path;
        if is_stream(path) || !path.exists() {
            return Ok(());
        }
        let target = resolved(path);
        if inputs.iter().any(|input| input.exists() && resolved(input).starts_with(&target)) {
            return refused("is read by the same command: write elsewhere");
        }
        match self.form {
            Form::Folder => {
                let mut entries =
                    fs::read_dir(path).map_err(|e| Error::in_file(path, format!("cannot be read: {e}")))?;
                match entries.next() {
                    None => Ok(()),
                    Some(first) => {
                        let name = first.map(|entry| entry.file_name()).unwrap_or_default();
                        refused(&format!("already contains {name:?}: give an empty or new folder"))
                    }
                }
            }
            Form::File(kind) => {
                let read = |e: std::io::Error| Error::in_file(path, format!("cannot be read: {e}"));
                if fs::metadata(path).map_err(read)?.permissions().readonly() {
                    return refused("already exists and is read-only");
                }
                let content = read_bytes(path, MAX_BYTES)?;
                // An empty file holds nothing to lose.
                if content.is_empty() || (kind.is_own)(&content) {
                    return Ok(());
                }
                refused(&format!("already exists and is not {} that mindgap wrote", kind.name))
            }
        }
    }
}

/// Returns whether several outputs may go there, since nothing is kept.
fn is_sink(path: &Path) -> bool {
    path == Path::new("/dev/null")
}

/// Resolves a path, so that two names of one file compare equal.
pub fn resolved(path: &Path) -> PathBuf {
    if is_standard_output(path) {
        return "-".into();
    }
    let path = behind_links(path);
    let whole = fs::canonicalize(&path);
    whole.unwrap_or_else(|_| {
        let folder = fs::canonicalize(folder_of(&path)).unwrap_or_else(|_| folder_of(&path).to_owned());
        folder.join(path.file_name().unwrap_or_default())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: Kind = Kind { name: "a text", is_own: |content| content.starts_with(b"mindgap") };

    fn refusal(places: &Places, force: bool) -> String {
        places.check(force, false).map_err(|e| e.to_string()).err().unwrap_or_default()
    }

    #[test]
    fn foreign_files_are_kept_unless_forced() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a");
        let places = Places::default().writing([&path], TEXT);
        assert_eq!(refusal(&places, false), "");
        for (content, is_kept) in [("", false), ("mindgap 1", false), ("my own", true)] {
            fs::write(&path, content).expect("a file");
            assert_eq!(refusal(&places, false).contains("--force"), is_kept, "{content}");
            assert_eq!(refusal(&places, true), "", "{content}");
        }
    }

    #[test]
    fn output_must_differ_from_inputs_and_other_outputs() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (path, again) = (folder.path().join("a"), folder.path().join(".").join("a"));
        let twice = Places::default().writing([&path, &again], TEXT);
        assert!(refusal(&twice, true).contains("two outputs"));
        fs::write(&path, "mindgap 1").expect("a file");
        let inside = Places::default().reading([&path]).filling([&folder.path().to_path_buf()]);
        let itself = Places::default().reading([&again]).writing([&path], TEXT);
        for places in [inside, itself] {
            assert!(refusal(&places, false).contains("read by the same command"));
            assert_eq!(refusal(&places, true), "");
        }
    }

    #[test]
    fn unwritable_outputs_are_rejected_up_front() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("nowhere").join("a");
        assert!(refusal(&Places::default().writing([&path], TEXT), true).contains("there is no folder"));
        assert_eq!(refusal(&Places::default().filling([&path]), true), "", "parent folders are created");
        let here = folder.path().to_owned();
        assert!(refusal(&Places::default().writing([&here], TEXT), true).contains("a folder of that name exists"));
    }
}
