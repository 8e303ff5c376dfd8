//! Checkpoints: the results of all finished work items of a run, from which an interrupted run resumes.
//!
//! Nothing else is needed: between items a command is deterministic, so a resumed run repeats it and skips the items that are
//! in the file. An item is written when it is done. If a write was interrupted, that item and all after it are dropped and
//! done again.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::task::Task;
use mindgap_files as files;
use mindgap_files::reason;
use mindgap_foundations::error::{Error, Result};

/// The first bytes of the file.
pub const SIGNATURE: &[u8] = br#"{"mindgap_checkpoint":"#;
/// The version of this format.
const FORMAT: u32 = 3;
/// Results of short work are kept in memory for this long before the file is created.
const MAX_BUFFER_AGE: Duration = Duration::from_secs(60);
/// Maximum size of the results in memory, bytes.
const MAX_BUFFER_BYTES: usize = 16 << 20;
/// Bytes before each item: its part, index and length, and the first bytes of its SHA-256.
const HEAD: usize = 4 + 4 + 4 + 8;

/// Identifies a work item: the part of the run and the index within that part.
pub type ItemId = (u32, u32);

/// When the checkpoint file is created.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CreateFile {
    /// With the first work item.
    AtOnce,
    /// Once the work has taken a minute.
    AfterAMinute,
}

/// An open checkpoint.
pub struct Checkpoint {
    path: PathBuf,
    /// `None` until the file is created.
    file: Option<File>,
    /// What to write when the file is created.
    buffer: Vec<u8>,
    started: Instant,
    create: CreateFile,
    /// Offset and length of each item of the previous run in the file.
    saved: HashMap<ItemId, (u64, usize)>,
}

/// The first line of the file.
#[derive(Serialize, Deserialize)]
struct Header {
    mindgap_checkpoint: u32,
    #[serde(flatten)]
    task: Task,
}

impl Checkpoint {
    /// Opens the checkpoint of a task, or prepares a new one. `warn` receives a message if the end of the file is damaged.
    ///
    /// # Errors
    /// When the file cannot be read or written, or belongs to another task.
    pub fn open(path: &Path, task: &Task, create: CreateFile, mut warn: impl FnMut(String)) -> Result<Self> {
        let header = serde_json::to_string(&Header { mindgap_checkpoint: FORMAT, task: task.clone() });
        let header = header.map_err(|e| Error::in_file(path, e.to_string()))? + "\n";
        let mut checkpoint = Checkpoint {
            path: path.to_owned(),
            file: None,
            buffer: header.into_bytes(),
            started: Instant::now(),
            create,
            saved: HashMap::new(),
        };
        if path.exists() && checkpoint.resume(task)? {
            let count = checkpoint.count();
            warn(format!("{}: its end is damaged; resuming from {count} work item(s)", path.display()));
        }
        Ok(checkpoint)
    }

    /// Returns the number of items saved by the previous run.
    pub fn count(&self) -> usize {
        self.saved.len()
    }

    /// Returns whether the previous run saved an item.
    pub fn contains(&self, item: ItemId) -> bool {
        self.saved.contains_key(&item)
    }

    /// Returns the result of an item saved by the previous run, if any.
    ///
    /// # Errors
    /// When the file can no longer be read, or the item does not decode as a `T`.
    pub fn load<T: DeserializeOwned>(&mut self, item: ItemId) -> Result<Option<T>> {
        let (Some((at, length)), Some(file)) = (self.saved.get(&item), &mut self.file) else { return Ok(None) };
        let mut bytes = vec![0; *length];
        let read = file.seek(SeekFrom::Start(*at)).and_then(|_| file.read_exact(&mut bytes));
        read.map_err(|e| Error::in_file(&self.path, format!("cannot be read: {e}")))?;
        rmp_serde::from_slice(&bytes).map(Some).map_err(|e| Error::in_file(&self.path, e.to_string()))
    }

    /// Saves the result of an item.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn save(&mut self, item: ItemId, value: &impl Serialize) -> Result<()> {
        let bytes = rmp_serde::to_vec_named(value).map_err(|e| Error::in_file(&self.path, e.to_string()))?;
        let record = [&head(item, &bytes)[..], &bytes].concat();
        if let Some(file) = &mut self.file {
            return file.write_all(&record).map_err(|e| failed(&self.path, &e));
        }
        self.buffer.extend(record);
        let is_long = self.started.elapsed() >= MAX_BUFFER_AGE || self.buffer.len() >= MAX_BUFFER_BYTES;
        if is_long || self.create == CreateFile::AtOnce { self.create_file() } else { Ok(()) }
    }

    /// Removes the file after a successful run.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn remove(self) -> Result<()> {
        if self.file.is_none() {
            return Ok(());
        }
        fs::remove_file(&self.path).map_err(|e| Error::in_file(&self.path, format!("cannot be removed: {e}")))
    }

    fn create_file(&mut self) -> Result<()> {
        files::write(&self.path, std::mem::take(&mut self.buffer))?;
        self.file = Some(open(&self.path).map_err(|e| failed(&self.path, &e))?);
        Ok(())
    }

    /// Indexes the items of an existing file and cuts off a damaged end; returns whether there was one.
    fn resume(&mut self, task: &Task) -> Result<bool> {
        let unread = |e: io::Error| Error::in_file(&self.path, format!("cannot be read: {e}"));
        let file = open(&self.path).map_err(unread)?;
        let length = file.metadata().map_err(unread)?.len();
        let mut reader = BufReader::new(&file);
        let mut line = Vec::new();
        reader.read_until(b'\n', &mut line).map_err(unread)?;
        let header = serde_json::from_slice(&line).ok().filter(|header: &Header| header.mindgap_checkpoint == FORMAT);
        let Some(Header { task: theirs, .. }) = header else {
            return Err(Error::in_file(
                &self.path,
                "is not a checkpoint that this version can read: remove it to start again",
            ));
        };
        if let Some(difference) = theirs.difference_from(task) {
            let what = format!("is the checkpoint of a run with {difference}: repeat that call, or remove the file");
            return Err(Error::in_file(&self.path, what));
        }
        let mut at = line.len() as u64;
        while let Some((item, bytes)) = record(&mut reader, length - at) {
            self.saved.insert(item, (at + HEAD as u64, bytes));
            at += (HEAD + bytes) as u64;
        }
        drop(reader);
        file.set_len(at).map_err(|e| failed(&self.path, &e))?;
        self.file = Some(file);
        Ok(at < length)
    }
}

fn open(path: &Path) -> io::Result<File> {
    OpenOptions::new().read(true).append(true).open(path)
}

fn failed(path: &Path, e: &io::Error) -> Error {
    Error::in_file(path, format!("cannot be written: {}", reason(e)))
}

fn head((part, index): ItemId, bytes: &[u8]) -> [u8; HEAD] {
    let mut head = [0; HEAD];
    head[..4].copy_from_slice(&part.to_le_bytes());
    head[4..8].copy_from_slice(&index.to_le_bytes());
    head[8..12].copy_from_slice(&(bytes.len() as u32).to_le_bytes());
    let sum = Sha256::new().chain_update(&head[..12]).chain_update(bytes).finalize();
    head[12..].copy_from_slice(&sum[..HEAD - 12]);
    head
}

/// Reads the next item with `remaining` bytes left in the file and returns its length; `None` at the end or where it is damaged.
fn record(reader: &mut impl Read, remaining: u64) -> Option<(ItemId, usize)> {
    let mut read = [0; HEAD];
    reader.read_exact(&mut read).ok()?;
    let number = |at: usize| Some(u32::from_le_bytes(read[at..at + 4].try_into().ok()?));
    let (item, length) = ((number(0)?, number(4)?), number(8)? as usize);
    // A damaged length must not exhaust memory.
    if (HEAD + length) as u64 > remaining {
        return None;
    }
    let mut bytes = vec![0; length];
    reader.read_exact(&mut bytes).ok()?;
    (head(item, &bytes) == read).then_some((item, length))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn task(seed: u64) -> Task {
        Task::new("evolve".into(), BTreeMap::from([("--seed".into(), seed.to_string())]), &[], &[])
    }

    fn opened(path: &Path, warnings: &mut Vec<String>) -> Result<Checkpoint> {
        Checkpoint::open(path, &task(1), CreateFile::AtOnce, |line| warnings.push(line))
    }

    fn written(path: &Path) -> Vec<u8> {
        let mut checkpoint = opened(path, &mut Vec::new()).unwrap();
        for index in 0..5 {
            checkpoint.save((0, index), &vec![f64::from(index), f64::NAN, f64::INFINITY]).unwrap();
        }
        checkpoint.save((1, 0), &"text").unwrap();
        fs::read(path).unwrap()
    }

    #[test]
    fn items_round_trip() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        assert!(written(&path).starts_with(SIGNATURE));
        let mut warnings = Vec::new();
        let mut again = opened(&path, &mut warnings).unwrap();
        assert_eq!((again.count(), warnings.len()), (6, 0));
        let numbers: Vec<f64> = again.load((0, 3)).unwrap().unwrap();
        assert!(numbers[0] == 3.0 && numbers[1].is_nan() && numbers[2] == f64::INFINITY);
        assert_eq!(again.load::<String>((1, 0)).unwrap().as_deref(), Some("text"));
        assert_eq!(again.load::<String>((1, 1)).unwrap(), None);
        again.save((1, 1), &"more").unwrap();
        assert_eq!(opened(&path, &mut warnings).unwrap().load::<String>((1, 1)).unwrap().as_deref(), Some("more"));
        again.remove().unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    /// The end offsets of the header and of each item.
    fn ends(bytes: &[u8]) -> Vec<usize> {
        let mut ends = vec![bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1];
        while let Some(length) = bytes.get(ends[ends.len() - 1] + 8..).and_then(|rest| rest.first_chunk()) {
            ends.push(ends[ends.len() - 1] + HEAD + u32::from_le_bytes(*length) as usize);
        }
        assert_eq!(ends.last(), Some(&bytes.len()));
        ends
    }

    /// Asserts that a checkpoint with these bytes holds its first `items` items and can be continued.
    fn assert_resumes(bytes: &[u8], items: usize, is_damaged: bool) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        fs::write(&path, bytes).unwrap();
        let mut warnings = Vec::new();
        let mut resumed = opened(&path, &mut warnings).unwrap();
        assert_eq!((resumed.count(), warnings.len()), (items, usize::from(is_damaged)));
        for index in 0..items as u32 {
            assert_eq!(resumed.load::<Vec<f64>>((0, index)).unwrap().unwrap()[0], f64::from(index));
        }
        resumed.save((7, 7), &1u8).unwrap();
        assert_eq!(opened(&path, &mut warnings).unwrap().count(), items + 1);
        assert_eq!(warnings.len(), usize::from(is_damaged), "the file is whole again");
    }

    #[test]
    fn truncated_or_corrupted_checkpoint_resumes_from_last_valid_item() {
        let folder = tempfile::tempdir().unwrap();
        let bytes = written(&folder.path().join("a.checkpoint"));
        let ends = ends(&bytes);
        assert_eq!(ends.len(), 7);
        for at in ends[0]..bytes.len() {
            let before = ends.iter().filter(|end| **end <= at).count() - 1;
            assert_resumes(&bytes[..at], before, at != ends[before]);
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert_resumes(&changed, before, true);
        }
    }

    #[test]
    fn checkpoint_of_another_run_is_rejected_and_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        let bytes = written(&path);
        let refusal =
            |seed| Checkpoint::open(&path, &task(seed), CreateFile::AtOnce, |_| {}).err().map(|e| e.to_string());
        assert!(refusal(2).unwrap().ends_with("with --seed 1, not 2: repeat that call, or remove the file"));
        assert_eq!(fs::read(&path).unwrap(), bytes);
        for other in ["", "my own notes\n", "{\"mindgap_checkpoint\":1,\"ver"] {
            fs::write(&path, other).unwrap();
            assert!(refusal(1).unwrap().contains("is not a checkpoint"), "{other}");
        }
    }

    #[test]
    fn short_work_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        let mut checkpoint = Checkpoint::open(&path, &task(1), CreateFile::AfterAMinute, |_| {}).unwrap();
        checkpoint.save((0, 0), &1u8).unwrap();
        assert!(!path.exists());
        checkpoint.save((0, 1), &"x".repeat(MAX_BUFFER_BYTES)).unwrap();
        assert_eq!(opened(&path, &mut Vec::new()).unwrap().count(), 2, "the buffer was full");
        checkpoint.remove().unwrap();
        assert!(!path.exists());
    }
}
