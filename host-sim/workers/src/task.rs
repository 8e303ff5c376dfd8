//! What a run does, as far as it decides what comes of it: another run does the same if nothing of this differs.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use mindgap_files::places::at;

/// A call of a command.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Task {
    version: String,
    command: String,
    arguments: BTreeMap<String, String>,
    /// What is read, in the order in which the command names it.
    inputs: Vec<Input>,
}

/// A file or folder that is read. It counts by what it holds: the same one may be called by another path.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Input {
    path: String,
    sha256: String,
}

impl Task {
    /// A command with its arguments by name. Of what it reads, `outputs` and hidden files count for nothing, and what cannot
    /// be read is for the command to tell.
    pub fn new(command: String, arguments: BTreeMap<String, String>, inputs: &[PathBuf], outputs: &[PathBuf]) -> Self {
        let outputs: Vec<PathBuf> = outputs.iter().map(|output| at(output)).collect();
        let digested =
            |input: &PathBuf| Input { path: input.display().to_string(), sha256: digest(&at(input), &outputs) };
        let inputs = inputs.iter().map(digested).collect();
        Task { version: env!("CARGO_PKG_VERSION").into(), command, arguments, inputs }
    }

    /// The first thing in which this one differs from another, in words.
    pub fn difference_from(&self, other: &Task) -> Option<String> {
        if self.version != other.version {
            return Some(format!("version {}, not {}", self.version, other.version));
        }
        if self.command != other.command {
            return Some(format!("the command {}, not {}", self.command, other.command));
        }
        let value = |task: &Task, name: &str| task.arguments.get(name).cloned().unwrap_or_else(|| "left out".into());
        let names = self.arguments.keys().chain(other.arguments.keys());
        let differs = |name: &&String| self.arguments.get(*name) != other.arguments.get(*name);
        if let Some(name) = names.into_iter().find(differs) {
            return Some(format!("{name} {}, not {}", value(self, name), value(other, name)));
        }
        let mut theirs = other.inputs.iter();
        let is_changed = |input: &&Input| theirs.next().is_none_or(|other| other.sha256 != input.sha256);
        self.inputs.iter().find(is_changed).map(|input| format!("another content of {}", input.path))
    }
}

/// SHA-256 of a file, or of a folder's files and their names.
fn digest(path: &Path, except: &[PathBuf]) -> String {
    let mut digest = Sha256::new();
    add_readable(path, except, &mut digest);
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Adds what can be read, and of the rest why it cannot.
fn add_readable(path: &Path, except: &[PathBuf], digest: &mut Sha256) {
    add(path, except, digest).unwrap_or_else(|e| digest.update(e.kind().to_string()));
}

fn add(path: &Path, except: &[PathBuf], digest: &mut Sha256) -> std::io::Result<()> {
    if !path.is_dir() {
        digest.update(Sha256::digest(fs::read(path)?));
        return Ok(());
    }
    let mut entries = fs::read_dir(path)?.collect::<std::io::Result<Vec<_>>>()?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let (path, name) = (entry.path(), entry.file_name());
        if !name.as_encoded_bytes().starts_with(b".") && !except.contains(&path) {
            digest.update(Sha256::digest(name.as_encoded_bytes()));
            add_readable(&path, except, digest);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(seed: &str, input: &Path) -> Task {
        let arguments = BTreeMap::from([("--seed".into(), seed.into())]);
        Task::new("evolve".into(), arguments, &[input.to_owned()], &[input.join("answers")])
    }

    #[test]
    fn what_differs_is_named() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.csv"), "1").unwrap();
        let one = task("1", folder.path());
        assert_eq!(one.difference_from(&one), None);
        assert_eq!(one.difference_from(&task("2", folder.path())), Some("--seed 1, not 2".into()));
        let older = Task { version: "0.0.1".into(), ..one.clone() };
        assert_eq!(older.difference_from(&one), Some(format!("version 0.0.1, not {}", one.version)));
        let other = Task { command: "train".into(), ..one.clone() };
        assert_eq!(other.difference_from(&one), Some("the command train, not evolve".into()));
        let without = Task { arguments: BTreeMap::new(), ..one.clone() };
        assert_eq!(without.difference_from(&one), Some("--seed left out, not 1".into()));
        fs::write(folder.path().join("answers"), "an output").unwrap();
        fs::write(folder.path().join(".hidden"), "on the way").unwrap();
        assert_eq!(one, task("1", folder.path()));
        assert_eq!(one.difference_from(&task("1", &folder.path().join("."))), None, "another name of the same folder");
        fs::write(folder.path().join("a.csv"), "2").unwrap();
        let changed = format!("another content of {}", folder.path().display());
        assert_eq!(one.difference_from(&task("1", folder.path())), Some(changed));
    }
}
