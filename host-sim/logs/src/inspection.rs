//! Inspects logs for defects before anything is learned from them or compared with them.
//!
//! A wrong unit, frame, clock or tracked row looks like an effect of the robot. Each check compares the logs as they are with
//! one discrete alternative (a sign, an exchange, a unit, a quarter turn, an excluded row). It reports a defect only if the
//! alternative explains decisively better how the commands moved the robot or how the readings fit the walls. A real robot,
//! however faulty, follows its commands in sign and within a factor of two.
//!
//! Checks run in order: runs and clocks, units, readings, frames, map, single rows, counters and gyro. Each sees the corrections
//! of those before it.

mod against_map;
mod clocks;
mod copies;
mod echoes;
mod finding;
mod frames;
mod frozen;
mod headings;
mod map;
mod moved_walls;
mod rest;
mod segments;
mod stuck;
mod tolerance;
mod track;
mod units;
mod viterbi;
mod witnesses;

pub use finding::{Finding, Handling, Part, RunRows};
pub use frames::Orientation;
pub use map::fit_to_walls;

use crate::Logs;
use mindgap_foundations::error::{Error, Result};

/// The result of inspecting logs.
pub struct Inspection {
    /// The logs, with corrections applied and defective rows and runs excluded.
    pub logs: Logs,
    /// The defects found.
    pub findings: Vec<Finding>,
}

impl Inspection {
    /// Inspects logs.
    pub fn new(mut logs: Logs) -> Self {
        let mut findings = Vec::new();
        let checks: [fn(&mut Logs) -> Vec<Finding>; 6] =
            [copies::check, clocks::rates, units::commands, units::headings, units::lengths, clocks::shifts];
        checks.iter().for_each(|check| findings.extend(check(&mut logs)));
        findings.extend(echoes::units(&mut logs));
        findings.extend(echoes::no_echo_numbers(&mut logs));
        findings.extend(stuck::check(&mut logs));
        let frame = frames::check(&mut logs);
        let fits = frame.iter().all(|found| found.withholds.is_empty());
        findings.extend(frame);
        findings.extend(units::scale(&logs));
        // In another frame every path leaves the map.
        let is_sound = fits && !findings.iter().any(|found| found.withholds.contains(&Part::Motion));
        let against_map = if is_sound { against_map::check(&logs) } else { Vec::new() };
        // Readings are compared with the map where frame, path and sensor are sound.
        if against_map.is_empty() && findings.iter().all(|found| found.withholds.is_empty()) {
            findings.extend(moved_walls::check(&logs));
        }
        findings.extend(against_map);
        // Checks of single rows and of counters presume that the track as a whole follows the commands.
        if !findings.iter().any(|found| found.withholds.contains(&Part::Motion)) {
            let checks: [fn(&mut Logs) -> Vec<Finding>; 5] =
                [frozen::check, rest::starts_moving, rest::moves_at_zero_command, headings::check, track::check];
            checks.iter().for_each(|check| findings.extend(check(&mut logs)));
            findings.extend(witnesses::check(&mut logs));
        }
        Inspection { logs, findings }
    }

    /// Returns the logs for training and evaluation; `warn` receives the findings that were handled.
    ///
    /// # Errors
    /// When there is a defect that could not be handled.
    pub fn into_usable(self, warn: impl FnMut(String)) -> Result<Logs> {
        if let Some(why) = self.refusal() {
            return Err(Error::new(why));
        }
        self.findings.iter().map(Finding::line).for_each(warn);
        Ok(self.logs)
    }

    /// Removes all readings if nothing but them must not be compared; the findings then withhold nothing.
    pub(super) fn silence_unsound(&mut self) {
        if self.withheld(Part::Motion).is_none() && self.withheld(Part::Sonar).is_some() {
            self.logs.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.echo_cm = None));
            for found in self.findings.iter_mut().filter(|found| !found.withholds.is_empty()) {
                (found.withholds, found.handling) = (&[], Handling::Excluded);
            }
        }
    }

    /// Returns why the logs must not be used for training, if a defect could not be handled.
    pub fn refusal(&self) -> Option<&str> {
        let found = self.findings.iter().find(|found| !found.withholds.is_empty());
        found.map(|found| found.sentence.as_str())
    }

    /// Returns why a part of the logs must not be compared, if so.
    pub fn withheld(&self, part: Part) -> Option<&str> {
        let found = self.findings.iter().find(|found| found.withholds.contains(&part));
        found.map(|found| found.sentence.as_str())
    }
}
