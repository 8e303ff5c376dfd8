//! What was found wrong with logs, where, and what was done about it.

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use crate::Logs;

/// One thing that is wrong with logs.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is, for programs.
    pub id: &'static str,
    /// The rows that have it.
    pub places: Vec<Place>,
    /// What was done about it.
    pub handling: Handling,
    /// What must not be compared because of it.
    pub withholds: &'static [Part],
    /// What was found and what to write instead, for people.
    pub sentence: String,
}

/// Rows of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The run's name.
    pub run: String,
    /// Indices of the rows, rising.
    pub rows: Vec<usize>,
}

/// What was done about a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Handling {
    /// The rows count no more.
    LeftOut,
    /// The numbers were put right.
    PutRight,
    /// Nothing: the logs stay as they are.
    Told,
}

impl Handling {
    /// The word for people.
    fn word(self) -> &'static str {
        match self {
            Handling::LeftOut => "left out",
            Handling::PutRight => "put right",
            Handling::Told => "told",
        }
    }
}

/// A part of logs that is compared or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// How commands move the robot.
    Motion,
    /// What the sensor reads.
    Sonar,
}

impl Place {
    /// Every row of every run.
    pub fn all(logs: &Logs) -> Vec<Place> {
        let whole = |run: &crate::Run| Place { run: run.name.clone(), rows: (0..run.rows.len()).collect() };
        logs.runs.iter().map(whole).collect()
    }

    /// Rows given as index of the run and of the row, in order.
    pub fn of(logs: &Logs, rows: &[(usize, usize)]) -> Vec<Place> {
        rows.chunk_by(|a, b| a.0 == b.0)
            .map(|of_run| Place {
                run: logs.runs[of_run[0].0].name.clone(),
                rows: of_run.iter().map(|(_, row)| *row).collect(),
            })
            .collect()
    }

    /// Line numbers in the run's file as ranges: its header is line 1.
    fn lines(&self) -> Vec<[usize; 2]> {
        let ranges = self.rows.chunk_by(|a, b| a + 1 == *b);
        ranges.map(|range| [range[0] + 2, range[range.len() - 1] + 2]).collect()
    }
}

impl Finding {
    /// That the poses of rows, given as index of the run and of the row, were wrong, which leaves them out of the logs; none
    /// where there are no such rows.
    pub fn without_poses(
        logs: &mut Logs,
        id: &'static str,
        rows: &[(usize, usize)],
        sentence: &'static str,
    ) -> Option<Self> {
        if rows.is_empty() {
            return None;
        }
        let places = Place::of(logs, rows);
        rows.iter().for_each(|(run, row)| logs.runs[*run].rows.edit(*row, |row| row.pose = None));
        Some(Finding { id, places, handling: Handling::LeftOut, withholds: &[], sentence: sentence.into() })
    }

    /// The finding as one line for people.
    pub fn line(&self) -> String {
        let (rows, runs, handling) = (self.rows(), self.places.len(), self.handling.word());
        format!("{} ({rows} rows in {runs} runs, {handling}): {}", self.id, self.sentence)
    }

    /// Number of rows that have it.
    pub fn rows(&self) -> usize {
        self.places.iter().map(|place| place.rows.len()).sum()
    }
}

impl Serialize for Finding {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut fields = to.serialize_struct("Finding", 6)?;
        fields.serialize_field("finding", self.id)?;
        fields.serialize_field("runs", &self.places.iter().map(|place| &place.run).collect::<Vec<_>>())?;
        fields.serialize_field("rows", &self.rows())?;
        fields.serialize_field("lines", &self.places.iter().map(Place::lines).collect::<Vec<_>>())?;
        fields.serialize_field("handling", &self.handling)?;
        fields.serialize_field("sentence", &self.sentence)?;
        fields.end()
    }
}
