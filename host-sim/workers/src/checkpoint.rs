//! The file from which a run goes on that was broken off: what came of every piece of work so far.
//!
//! Nothing else is needed. Between pieces a command does the same each time, so that a run that goes on takes the way of
//! the one before and leaves out the pieces that are there. A piece is written when it is done; one whose writing was
//! broken off is left out with all that follows, and done again.

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

/// How the file begins.
pub const SIGN: &[u8] = br#"{"mindgap_checkpoint":"#;
/// The version of this format.
const FORMAT: u32 = 3;
/// What is held back is written when it is this old,
const HELD_FOR: Duration = Duration::from_secs(60);
/// or so large, bytes.
const MOST_HELD: usize = 16 << 20;
/// Bytes before each piece: its part, index and length, and the beginning of its SHA-256.
const HEAD: usize = 4 + 4 + 4 + 8;

/// A piece of work: the number of its part of the run, and its index therein.
pub type Piece = (u32, u32);

/// When the file is begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// With the first piece of work.
    AtOnce,
    /// When the work turns out to be long.
    AfterAMinute,
}

/// A checkpoint, to which pieces are added.
pub struct Checkpoint {
    path: PathBuf,
    /// None until it is begun.
    file: Option<File>,
    /// What is to be written when it is.
    held: Vec<u8>,
    since: Instant,
    begin: Begin,
    /// Where the pieces of the run before lie in the file, and how long they are.
    places: HashMap<Piece, (u64, usize)>,
}

/// The first line.
#[derive(Serialize, Deserialize)]
struct Header {
    mindgap_checkpoint: u32,
    #[serde(flatten)]
    task: Task,
}

impl Checkpoint {
    /// The checkpoint of a task: the one that is there, or a new one. `warn` is told when the end of it is lost.
    ///
    /// # Errors
    /// When the file cannot be read or written, or is of another task.
    pub fn open(path: &Path, task: &Task, begin: Begin, mut warn: impl FnMut(String)) -> Result<Self> {
        let header = serde_json::to_string(&Header { mindgap_checkpoint: FORMAT, task: task.clone() });
        let header = header.map_err(|e| Error::in_file(path, e.to_string()))? + "\n";
        let mut checkpoint = Checkpoint {
            path: path.to_owned(),
            file: None,
            held: header.into_bytes(),
            since: Instant::now(),
            begin,
            places: HashMap::new(),
        };
        if path.exists() && checkpoint.resume(task)? {
            let count = checkpoint.count();
            warn(format!("{}: its end is torn; the run goes on from {count} pieces of work before", path.display()));
        }
        Ok(checkpoint)
    }

    /// How many pieces of work the run before has left.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Whether the run before has left a piece.
    pub fn holds(&self, piece: Piece) -> bool {
        self.places.contains_key(&piece)
    }

    /// What came of a piece in the run before.
    ///
    /// # Errors
    /// When the file can no longer be read, or holds something else there.
    pub fn recall<T: DeserializeOwned>(&mut self, piece: Piece) -> Result<Option<T>> {
        let (Some((at, length)), Some(file)) = (self.places.get(&piece), &mut self.file) else { return Ok(None) };
        let mut bytes = vec![0; *length];
        let read = file.seek(SeekFrom::Start(*at)).and_then(|_| file.read_exact(&mut bytes));
        read.map_err(|e| Error::in_file(&self.path, format!("cannot be read: {e}")))?;
        rmp_serde::from_slice(&bytes).map(Some).map_err(|e| Error::in_file(&self.path, e.to_string()))
    }

    /// Adds what came of a piece.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn keep(&mut self, piece: Piece, value: &impl Serialize) -> Result<()> {
        let bytes = rmp_serde::to_vec_named(value).map_err(|e| Error::in_file(&self.path, e.to_string()))?;
        let record = [&head(piece, &bytes)[..], &bytes].concat();
        if let Some(file) = &mut self.file {
            return file.write_all(&record).map_err(|e| failed(&self.path, &e));
        }
        self.held.extend(record);
        let is_long = self.since.elapsed() >= HELD_FOR || self.held.len() >= MOST_HELD;
        if is_long || self.begin == Begin::AtOnce { self.begin_file() } else { Ok(()) }
    }

    /// Removes the file: its run has ended well.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn remove(self) -> Result<()> {
        if self.file.is_none() {
            return Ok(());
        }
        fs::remove_file(&self.path).map_err(|e| Error::in_file(&self.path, format!("cannot be removed: {e}")))
    }

    fn begin_file(&mut self) -> Result<()> {
        files::write(&self.path, std::mem::take(&mut self.held))?;
        self.file = Some(open(&self.path).map_err(|e| failed(&self.path, &e))?);
        Ok(())
    }

    /// Finds the pieces of a file that is there; returns whether its end was torn.
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
                "is no checkpoint that this version reads: remove it to begin anew",
            ));
        };
        if let Some(difference) = theirs.difference_from(task) {
            let what = format!("is the checkpoint of a run with {difference}: call that again, or remove the file");
            return Err(Error::in_file(&self.path, what));
        }
        let mut at = line.len() as u64;
        while let Some((piece, bytes)) = record(&mut reader, length - at) {
            self.places.insert(piece, (at + HEAD as u64, bytes));
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

fn head((part, index): Piece, bytes: &[u8]) -> [u8; HEAD] {
    let mut head = [0; HEAD];
    head[..4].copy_from_slice(&part.to_le_bytes());
    head[4..8].copy_from_slice(&index.to_le_bytes());
    head[8..12].copy_from_slice(&(bytes.len() as u32).to_le_bytes());
    let sum = Sha256::new().chain_update(&head[..12]).chain_update(bytes).finalize();
    head[12..].copy_from_slice(&sum[..HEAD - 12]);
    head
}

/// The next piece and its length, of a file with so many bytes left; none at its end, or where it is torn.
fn record(reader: &mut impl Read, left: u64) -> Option<(Piece, usize)> {
    let mut read = [0; HEAD];
    reader.read_exact(&mut read).ok()?;
    let number = |at: usize| Some(u32::from_le_bytes(read[at..at + 4].try_into().ok()?));
    let (piece, length) = ((number(0)?, number(4)?), number(8)? as usize);
    // A torn length must not take all memory.
    if (HEAD + length) as u64 > left {
        return None;
    }
    let mut bytes = vec![0; length];
    reader.read_exact(&mut bytes).ok()?;
    (head(piece, &bytes) == read).then_some((piece, length))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn task(seed: u64) -> Task {
        Task::new("evolve".into(), BTreeMap::from([("--seed".into(), seed.to_string())]), &[], &[])
    }

    fn opened(path: &Path, told: &mut Vec<String>) -> Result<Checkpoint> {
        Checkpoint::open(path, &task(1), Begin::AtOnce, |line| told.push(line))
    }

    fn written(path: &Path) -> Vec<u8> {
        let mut checkpoint = opened(path, &mut Vec::new()).unwrap();
        for index in 0..5 {
            checkpoint.keep((0, index), &vec![f64::from(index), f64::NAN, f64::INFINITY]).unwrap();
        }
        checkpoint.keep((1, 0), &"text").unwrap();
        fs::read(path).unwrap()
    }

    #[test]
    fn pieces_come_back_as_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        assert!(written(&path).starts_with(SIGN));
        let mut told = Vec::new();
        let mut again = opened(&path, &mut told).unwrap();
        assert_eq!((again.count(), told.len()), (6, 0));
        let numbers: Vec<f64> = again.recall((0, 3)).unwrap().unwrap();
        assert!(numbers[0] == 3.0 && numbers[1].is_nan() && numbers[2] == f64::INFINITY);
        assert_eq!(again.recall::<String>((1, 0)).unwrap().as_deref(), Some("text"));
        assert_eq!(again.recall::<String>((1, 1)).unwrap(), None);
        again.keep((1, 1), &"more").unwrap();
        assert_eq!(opened(&path, &mut told).unwrap().recall::<String>((1, 1)).unwrap().as_deref(), Some("more"));
        again.remove().unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    /// The ends of the pieces in a checkpoint, after that of its header.
    fn ends(bytes: &[u8]) -> Vec<usize> {
        let mut ends = vec![bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1];
        while let Some(length) = bytes.get(ends[ends.len() - 1] + 8..).and_then(|rest| rest.first_chunk()) {
            ends.push(ends[ends.len() - 1] + HEAD + u32::from_le_bytes(*length) as usize);
        }
        assert_eq!(ends.last(), Some(&bytes.len()));
        ends
    }

    /// What is left of a checkpoint with these bytes are its first pieces, so many; and it can be gone on with.
    fn assert_left(bytes: &[u8], pieces: usize, is_torn: bool) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        fs::write(&path, bytes).unwrap();
        let mut told = Vec::new();
        let mut left = opened(&path, &mut told).unwrap();
        assert_eq!((left.count(), told.len()), (pieces, usize::from(is_torn)));
        for index in 0..pieces as u32 {
            assert_eq!(left.recall::<Vec<f64>>((0, index)).unwrap().unwrap()[0], f64::from(index));
        }
        left.keep((7, 7), &1u8).unwrap();
        assert_eq!(opened(&path, &mut told).unwrap().count(), pieces + 1);
        assert_eq!(told.len(), usize::from(is_torn), "the file is whole again");
    }

    #[test]
    fn wherever_it_is_cut_off_or_changed_the_pieces_before_are_left() {
        let folder = tempfile::tempdir().unwrap();
        let bytes = written(&folder.path().join("a.checkpoint"));
        let ends = ends(&bytes);
        assert_eq!(ends.len(), 7);
        for at in ends[0]..bytes.len() {
            let before = ends.iter().filter(|end| **end <= at).count() - 1;
            assert_left(&bytes[..at], before, at != ends[before]);
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert_left(&changed, before, true);
        }
    }

    #[test]
    fn that_of_another_run_is_refused_and_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        let bytes = written(&path);
        let refusal = |seed| Checkpoint::open(&path, &task(seed), Begin::AtOnce, |_| {}).err().map(|e| e.to_string());
        assert!(refusal(2).unwrap().ends_with("with --seed 1, not 2: call that again, or remove the file"));
        assert_eq!(fs::read(&path).unwrap(), bytes);
        for other in ["", "my own notes\n", "{\"mindgap_checkpoint\":1,\"ver"] {
            fs::write(&path, other).unwrap();
            assert!(refusal(1).unwrap().contains("is no checkpoint"), "{other}");
        }
    }

    #[test]
    fn what_is_short_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.checkpoint");
        let mut checkpoint = Checkpoint::open(&path, &task(1), Begin::AfterAMinute, |_| {}).unwrap();
        checkpoint.keep((0, 0), &1u8).unwrap();
        assert!(!path.exists());
        checkpoint.keep((0, 1), &"x".repeat(MOST_HELD)).unwrap();
        assert_eq!(opened(&path, &mut Vec::new()).unwrap().count(), 2, "it is long after all");
        checkpoint.remove().unwrap();
        assert!(!path.exists());
    }
}
