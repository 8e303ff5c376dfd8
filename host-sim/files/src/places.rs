//! The places that a command reads and writes, checked before it begins: it replaces nothing that it did not make, and
//! nothing that it reads.

use std::fs;
use std::path::{Path, PathBuf};

use super::leftovers;
use super::write::{behind_links, folder_of, is_standard_output, is_stream, no_folder, reason, try_folder};
use mindgap_foundations::error::{Error, Result};

/// What a file is that a command writes.
#[derive(Clone, Copy)]
pub struct Kind {
    /// What people call it, with its article.
    pub name: &'static str,
    /// Whether content is of this kind and made by this program: it may be made again.
    pub is_one: fn(&[u8]) -> bool,
}

/// The places of one call of a command.
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
    /// With files or folders that are read.
    pub fn reading<'a>(mut self, paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        self.inputs.extend(paths.into_iter().cloned());
        self
    }

    /// With files of a kind that are written.
    pub fn writing<'a>(mut self, paths: impl IntoIterator<Item = &'a PathBuf>, kind: Kind) -> Self {
        self.outputs.extend(paths.into_iter().map(|path| Output { path: path.clone(), form: Form::File(kind) }));
        self
    }

    /// With folders that are filled.
    pub fn filling<'a>(mut self, paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        self.outputs.extend(paths.into_iter().map(|path| Output { path: path.clone(), form: Form::Folder }));
        self
    }

    /// What is read.
    pub fn inputs(&self) -> &[PathBuf] {
        &self.inputs
    }

    /// What is written.
    pub fn outputs(&self) -> impl Iterator<Item = PathBuf> {
        self.outputs.iter().map(|output| output.path.clone())
    }

    /// Whether a path is one of them, as it was given.
    pub fn contain(&self, path: &Path) -> bool {
        self.inputs.iter().any(|input| input == path) || self.outputs.iter().any(|output| output.path == path)
    }

    /// Checks them; `force` says that what is there may be replaced, whatever it is; `goes_on`, that a run before may have
    /// filled folders already.
    ///
    /// # Errors
    /// Names the first output that cannot be written, or that would replace what it must not.
    pub fn check(&self, force: bool, goes_on: bool) -> Result<()> {
        for (i, output) in self.outputs.iter().enumerate() {
            output.can_be_written()?;
            let is_same = |other: &&Output| !is_sink(&output.path) && at(&other.path) == at(&output.path);
            if self.outputs[..i].iter().any(|other| is_same(&other)) {
                return Err(Error::in_file(&output.path, "is named as two outputs: give each a place of its own"));
            }
            let is_ours = goes_on && matches!(output.form, Form::Folder);
            if !force && !is_ours {
                output.loses_nothing(&self.inputs)?;
            }
        }
        Ok(())
    }

    /// Whether an output goes to standard output, where it then stands alone.
    pub fn take_standard_output(&self) -> bool {
        self.outputs.iter().any(|output| is_standard_output(&output.path))
    }
}

impl Output {
    fn can_be_written(&self) -> Result<()> {
        let path = &behind_links(&self.path);
        let failed = |why: String| Err(Error::in_file(&self.path, format!("cannot be written: {why}")));
        match self.form {
            _ if is_stream(&self.path) => match self.form {
                Form::File(_) => return Ok(()),
                Form::Folder => return failed("a folder is needed here".into()),
            },
            Form::File(_) if path.is_dir() => return failed("there is a folder of that name".into()),
            Form::Folder if path.exists() && !path.is_dir() => return failed("there is a file of that name".into()),
            _ => (),
        }
        let home = match self.form {
            Form::File(_) => folder_of(path),
            // Folders above it are made.
            Form::Folder => path.ancestors().find(|above| above.is_dir()).unwrap_or(Path::new(".")),
        };
        if !home.is_dir() {
            return failed(no_folder(home));
        }
        leftovers::clear(home);
        try_folder(home).or_else(|e| failed(reason(&e)))
    }

    fn loses_nothing(&self, inputs: &[PathBuf]) -> Result<()> {
        let refused = |why: &str| Err(Error::in_file(&self.path, format!("{why}; --force replaces it")));
        let path = &self.path;
        if is_stream(path) || !path.exists() {
            return Ok(());
        }
        let here = at(path);
        if inputs.iter().any(|input| input.exists() && at(input).starts_with(&here)) {
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
                        refused(&format!("holds {name:?} already: give an empty or new folder"))
                    }
                }
            }
            Form::File(kind) => {
                let read = |e: std::io::Error| Error::in_file(path, format!("cannot be read: {e}"));
                if fs::metadata(path).map_err(read)?.permissions().readonly() {
                    return refused("is there already and must not be written");
                }
                let content = fs::read(path).map_err(read)?;
                // In an empty file nothing is lost.
                if content.is_empty() || (kind.is_one)(&content) {
                    return Ok(());
                }
                refused(&format!("is there already and is not {} that mindgap wrote", kind.name))
            }
        }
    }
}

/// Whether several outputs may go there: a device keeps nothing.
fn is_sink(path: &Path) -> bool {
    path == Path::new("/dev/null")
}

/// Where a path leads, whatever it is called.
pub fn at(path: &Path) -> PathBuf {
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

    const TEXT: Kind = Kind { name: "a text", is_one: |content| content.starts_with(b"mindgap") };

    fn refusal(places: &Places, force: bool) -> String {
        places.check(force, false).map_err(|e| e.to_string()).err().unwrap_or_default()
    }

    #[test]
    fn what_is_not_of_the_kind_is_kept_unless_forced() {
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
    fn an_output_is_no_input_and_no_other_output() {
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
    fn a_place_that_is_none_is_told_at_once() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("nowhere").join("a");
        assert!(refusal(&Places::default().writing([&path], TEXT), true).contains("there is no folder"));
        assert_eq!(refusal(&Places::default().filling([&path]), true), "", "folders above it are made");
        let here = folder.path().to_owned();
        assert!(refusal(&Places::default().writing([&here], TEXT), true).contains("there is a folder"));
    }
}
