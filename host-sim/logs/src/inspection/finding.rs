//! Defects found in logs: where they are, and how they were handled.

use schemars::JsonSchema;
use serde::Serialize;

use crate::Logs;

/// One defect of logs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(into = "WrittenFinding")]
#[schemars(with = "WrittenFinding")]
pub struct Finding {
    /// Machine-readable identifier.
    pub id: &'static str,
    /// The affected rows.
    pub rows_by_run: Vec<RunRows>,
    /// How it was handled.
    pub handling: Handling,
    /// The parts of the logs that must not be compared because of it.
    pub withholds: &'static [Part],
    /// What was found and what to log instead, for people.
    pub sentence: String,
}

/// Some rows of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRows {
    /// Name of the run.
    pub run: String,
    /// Indices of the rows, ascending.
    pub rows: Vec<usize>,
}

/// How a finding was handled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Handling {
    /// The rows were excluded.
    #[serde(rename = "left_out")]
    Excluded,
    /// The numbers were corrected.
    Corrected,
    /// The finding was only reported; the logs are unchanged.
    Reported,
}

impl Handling {
    /// Returns the word for people.
    pub fn word(self) -> &'static str {
        match self {
            Handling::Excluded => "excluded",
            Handling::Corrected => "corrected",
            Handling::Reported => "reported",
        }
    }
}

/// A part of logs that may be withheld from comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// How commands move the robot.
    Motion,
    /// The sensor's readings.
    Sonar,
}

impl RunRows {
    /// Returns all rows of all runs.
    pub fn all(logs: &Logs) -> Vec<RunRows> {
        let all_rows = |run: &crate::Run| RunRows { run: run.name.clone(), rows: (0..run.rows.len()).collect() };
        logs.runs.iter().map(all_rows).collect()
    }

    /// Groups rows, given as sorted pairs of run and row index, by run.
    pub fn group(logs: &Logs, rows: &[(usize, usize)]) -> Vec<RunRows> {
        rows.chunk_by(|a, b| a.0 == b.0)
            .map(|group| RunRows {
                run: logs.runs[group[0].0].name.clone(),
                rows: group.iter().map(|(_, row)| *row).collect(),
            })
            .collect()
    }

    /// Returns the indices of the rows as ranges.
    pub fn ranges(&self) -> impl Iterator<Item = [usize; 2]> {
        self.rows.chunk_by(|a, b| a + 1 == *b).map(|range| [range[0], range[range.len() - 1]])
    }

    /// Returns the line numbers in the run's file as ranges; the header is line 1.
    pub fn lines(&self) -> Vec<[usize; 2]> {
        self.ranges().map(|range| range.map(|row| row + 2)).collect()
    }
}

impl Finding {
    /// Reports rows, given as sorted pairs of run and row index, whose readings must not be compared.
    pub fn of_readings(logs: &Logs, id: &'static str, rows: &[(usize, usize)], sentence: String) -> Self {
        let rows_by_run = RunRows::group(logs, rows);
        Finding { id, rows_by_run, handling: Handling::Reported, withholds: &[Part::Sonar], sentence }
    }

    /// Removes the wrong poses of rows, given as pairs of run and row index, and returns the finding; `None` without rows.
    pub fn without_poses(
        logs: &mut Logs,
        id: &'static str,
        rows: &[(usize, usize)],
        sentence: &'static str,
    ) -> Option<Self> {
        if rows.is_empty() {
            return None;
        }
        let rows_by_run = RunRows::group(logs, rows);
        rows.iter().for_each(|(run, row)| logs.runs[*run].rows.edit(*row, |row| row.pose = None));
        Some(Finding { id, rows_by_run, handling: Handling::Excluded, withholds: &[], sentence: sentence.into() })
    }

    /// Returns the finding as one of a range sensor.
    pub fn of_sensor(self, sensor: &str) -> Self {
        Finding { sentence: format!("Range sensor {sensor}: {}", self.sentence), ..self }
    }

    /// Returns the finding as one line for people.
    pub fn line(&self) -> String {
        let (rows, runs, handling) = (self.rows(), self.rows_by_run.len(), self.handling.word());
        format!("{} ({rows} rows in {runs} runs, {handling}): {}", self.id, self.sentence)
    }

    /// Returns the number of affected rows.
    pub fn rows(&self) -> usize {
        self.rows_by_run.iter().map(|rows| rows.rows.len()).sum()
    }
}

/// A finding in the form of JSON files.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Finding")]
struct WrittenFinding {
    /// What is wrong, as an id.
    finding: &'static str,
    /// Names of the affected runs.
    runs: Vec<String>,
    /// Number of affected rows.
    rows: usize,
    /// For each of these runs the affected lines of its file, as ranges; the header is line 1.
    lines: Vec<Vec<[usize; 2]>>,
    /// How it was handled.
    handling: Handling,
    /// What was found and what to write instead.
    sentence: String,
}

impl From<Finding> for WrittenFinding {
    fn from(found: Finding) -> Self {
        WrittenFinding {
            finding: found.id,
            runs: found.rows_by_run.iter().map(|rows| rows.run.clone()).collect(),
            rows: found.rows(),
            lines: found.rows_by_run.iter().map(RunRows::lines).collect(),
            handling: found.handling,
            sentence: found.sentence,
        }
    }
}
