//! Sorts the files of a batch by what they hold, and combines them to drives.

use super::file_streams::FileStreams;
use super::left_out::LeftOut;
use mindgap_foundations::error::{Error, Result};

/// The files of a drive: commands, or all of it; poses; what else the robot measured.
pub type Drive = Vec<FileStreams>;

/// Files by what they hold, each with its place in the batch.
#[derive(Default)]
pub struct Batch {
    complete: Vec<Entry>,
    commands: Vec<Entry>,
    poses: Vec<Entry>,
    /// What the robot measured: one list for each kind of file.
    measurements: Vec<Vec<Entry>>,
    /// Places of files that cannot be read.
    pub failed: Vec<usize>,
}

/// A file: its place in the batch, and its parts if the recording was restarted within it; none if it cannot be used.
#[derive(Clone)]
struct Entry {
    place: usize,
    parts: Vec<FileStreams>,
}

impl Batch {
    /// Adds a file.
    pub fn add(&mut self, place: usize, parts: Vec<FileStreams>) {
        let Some(first) = parts.first() else { return };
        let list = match (&first.commands, first.bodies.is_empty()) {
            (Some(_), false) => &mut self.complete,
            (Some(_), true) => &mut self.commands,
            (None, false) => &mut self.poses,
            (None, true) => self.measurements_like(first),
        };
        list.push(Entry { place, parts });
    }

    /// Returns the files that measured the same as this one.
    fn measurements_like(&mut self, file: &FileStreams) -> &mut Vec<Entry> {
        let is_like = |files: &Vec<Entry>| {
            let first = files.first().and_then(|entry| entry.parts.first());
            first.is_some_and(|first| first.measured() == file.measured())
        };
        let place = self.measurements.iter().position(is_like).unwrap_or_else(|| {
            self.measurements.push(Vec::new());
            self.measurements.len() - 1
        });
        &mut self.measurements[place]
    }

    /// Returns whether no file can be used.
    pub fn is_empty(&self) -> bool {
        [&self.complete, &self.commands, &self.poses].iter().all(|list| list.is_empty()) && self.measurements.is_empty()
    }

    /// Combines the files to drives.
    ///
    /// # Errors
    /// When the numbers of files of each kind differ.
    pub fn drives(mut self, left_out: &mut Vec<LeftOut>) -> Result<Vec<Drive>> {
        self.use_separate_commands(left_out);
        // Measurements next to a single file with everything else.
        if let ([_], [], []) = (self.complete.as_slice(), self.commands.as_slice(), self.poses.as_slice())
            && !self.measurements.is_empty()
            && self.measurements.iter().all(|files| files.len() == 1)
        {
            return Ok(combined(self.complete.into_iter().chain(self.measurements.into_iter().flatten()).collect()));
        }
        self.hold_places_of_failed();
        let Batch { complete, commands, poses, measurements, .. } = &self;
        let has_shared_track = poses.len() == 1 && commands.len() > 1;
        let is_matched = (commands.len() == poses.len() || has_shared_track || self.measure_themselves())
            && measurements.iter().all(|files| files.len() == commands.len());
        if !is_matched || (complete.is_empty() && commands.is_empty()) {
            return Err(self.mismatch());
        }
        let Batch { complete, commands, poses, measurements, .. } = self;
        let mut measurements: Vec<_> = measurements.into_iter().map(Vec::into_iter).collect();
        let mut drives: Vec<Drive> = complete.into_iter().flat_map(|entry| combined(vec![entry])).collect();
        let shared = poses.first().filter(|_| poses.len() < commands.len()).cloned();
        let mut poses = poses.into_iter();
        for commands in commands {
            let poses = shared.clone().or_else(|| poses.next());
            let measured = measurements.iter_mut().filter_map(Iterator::next);
            let files: Vec<Entry> = [commands].into_iter().chain(poses).chain(measured).collect();
            match files.iter().find(|entry| entry.parts.is_empty()) {
                // The partners of a file that cannot be read.
                Some(_) => {
                    let partners = files.iter().filter_map(|entry| entry.parts.first());
                    left_out.extend(
                        partners
                            .map(|streams| LeftOut::file(&streams.file, "the other file of its drive cannot be used")),
                    );
                }
                None => drives.extend(combined(files)),
            }
        }
        Ok(drives)
    }

    /// Returns whether there are no poses, and every drive shows its motion by what the robot measured of it.
    fn measure_themselves(&self) -> bool {
        let shows_motion = |entry: &Entry| entry.parts.first().is_some_and(FileStreams::shows_motion);
        let is_measured_beside = self.measurements.iter().any(|files| files.first().is_some_and(shows_motion));
        self.poses.is_empty() && (is_measured_beside || self.commands.iter().all(shows_motion))
    }

    /// Takes the commands from files with commands alone, where there is one for each file that has speeds next to its poses.
    fn use_separate_commands(&mut self, left_out: &mut Vec<LeftOut>) {
        let spare = self.commands.len().saturating_sub(self.poses.len());
        if spare == 0 || spare != self.complete.len() {
            return;
        }
        for mut entry in self.complete.drain(..) {
            for streams in &mut entry.parts {
                streams.commands = None;
                let reason = "its speeds are not used: a file with commands alone is given, so they were measured";
                left_out.push(LeftOut::file(&streams.file, reason));
            }
            self.poses.push(entry);
        }
        self.poses.sort_by_key(|entry| entry.place);
    }

    /// Puts empty entries for the files that cannot be read, so that the others keep their partners.
    fn hold_places_of_failed(&mut self) {
        // Most are drives by themselves.
        if self.commands.len() > self.failed.len() && self.measure_themselves() {
            return;
        }
        // Where all others have a partner, a single one held measurements alone.
        if self.commands.len() == self.poses.len() && (!self.complete.is_empty() || self.failed.len() < 2) {
            return;
        }
        for place in std::mem::take(&mut self.failed) {
            let list = match self.holds_commands(place) {
                Some(true) => &mut self.commands,
                Some(false) => &mut self.poses,
                None => continue,
            };
            list.push(Entry { place, parts: Vec::new() });
            list.sort_by_key(|entry| entry.place);
        }
    }

    /// Guesses from the order of the files whether one that cannot be read holds commands rather than poses.
    fn holds_commands(&self, place: usize) -> Option<bool> {
        let ends = |list: &[Entry]| Some((list.first()?.place, list.last()?.place));
        let (commands, poses) = match (ends(&self.commands), ends(&self.poses)) {
            (Some(commands), Some(poses)) => (commands, poses),
            (None, None) => return None,
            (commands, _) => return Some(commands.is_none()),
        };
        let is_lacking_commands = self.commands.len() < self.poses.len();
        if commands.1 < poses.0 {
            // First all commands, then all poses.
            Some(place < commands.1 || place < poses.0 && is_lacking_commands)
        } else if poses.1 < commands.0 {
            Some(place > commands.0 || place > poses.1 && is_lacking_commands)
        } else {
            // The two files of each drive together.
            let is_partner = |entry: &Entry| entry.place == place ^ 1;
            let partners = [self.poses.iter().any(is_partner), self.commands.iter().any(is_partner)];
            partners.contains(&true).then_some(partners[0])
        }
    }

    fn mismatch(&self) -> Error {
        let Batch { complete, commands, poses, measurements, .. } = self;
        let entries = || [complete, commands, poses].into_iter().chain(measurements).flatten();
        let streams = || entries().flat_map(|entry| &entry.parts);
        let unused = streams().flat_map(|s| s.source.unused_columns().map(move |column| (s, column)));
        let hints: Vec<String> = unused
            .map(|(streams, column)| format!("{} of {}: {}", column.name, streams.file.display(), column.reason))
            .take(3)
            .collect();
        let hint = if hints.is_empty() { String::new() } else { format!("; unused columns: {}", hints.join("; ")) };
        Error::new(format!(
            "{} file(s) contain commands and poses, {} only commands, {} only poses, {} only readings, rotation counters or a gyro: a \
             drive needs commands, and poses or else rotation counters or a gyro; give one file of each per drive, in the same \
             order{hint}",
            complete.len(),
            commands.len(),
            poses.len(),
            measurements.iter().map(Vec::len).sum::<usize>(),
        ))
    }
}

/// Combines the parts of files: the first of each, the second of each, and so on; a file in one part belongs to all.
fn combined(files: Vec<Entry>) -> Vec<Drive> {
    let parts = files.iter().map(|entry| entry.parts.len()).max().unwrap_or(0);
    // Most are in one part, and are large.
    if parts == 1 {
        return vec![files.into_iter().flat_map(|entry| entry.parts).collect()];
    }
    let part = |entry: &Entry, part: usize| match entry.parts.as_slice() {
        [whole] => Some(whole.clone()),
        parts => parts.get(part).cloned(),
    };
    (0..parts).map(|i| files.iter().filter_map(|entry| part(entry, i)).collect()).collect()
}
