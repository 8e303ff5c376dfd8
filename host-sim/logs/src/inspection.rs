//! Inspects logs for defects before anything is learned from them or compared with them.
//!
//! A wrong unit, frame, clock or tracked row looks like an effect of the robot. Each check compares the logs as they are with
//! one discrete alternative (a sign, an exchange, a unit, a quarter turn, an excluded row). It reports a defect only if the
//! alternative explains decisively better how the commands moved the robot or how the readings fit the walls. A real robot,
//! however faulty, follows its commands in sign and within a factor of two.
//!
//! Checks run in order: runs and clocks, units, readings, frames, single rows. Each sees the corrections of those before it.

mod clocks;
mod copies;
mod echoes;
mod finding;
mod frames;
mod frozen;
mod headings;
mod map;
mod rest;
mod segments;
mod tolerance;
mod track;
mod units;
mod viterbi;

pub use finding::{Finding, Handling, Part, RunRows};
pub use frames::Orientation;

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
        findings.extend(frames::check(&logs));
        // Checks of single rows presume that the track as a whole follows the commands.
        if !findings.iter().any(|found| found.withholds.contains(&Part::Motion)) {
            let checks: [fn(&mut Logs) -> Vec<Finding>; 5] =
                [frozen::check, rest::starts_moving, rest::moves_at_zero_command, headings::check, track::check];
            checks.iter().for_each(|check| findings.extend(check(&mut logs)));
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
