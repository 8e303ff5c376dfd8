//! Inspection: what is wrong with logs, found before anything is learned from them or compared with them.
//!
//! A wrong unit, frame, clock or tracked row looks like an effect of the robot. Each check holds the logs as they are
//! against one discrete alternative (a sign, an exchange, a unit, a quarter turn, a row left out) and finds a fault only
//! where that alternative explains decisively better how the commands moved the robot or how the readings fit the
//! walls. What a real robot does, however strange, follows its commands in sign and within a factor of two.
//!
//! Checks come in an order: runs and clocks, units, frames, single rows, readings. Each sees what those before it put right.

mod chain;
mod clocks;
mod copies;
mod echoes;
mod finding;
mod frames;
mod frozen;
mod headings;
mod map;
mod rest;
mod tolerance;
mod track;
mod units;
mod ways;

pub use finding::{Finding, Handling, Part, Place};
pub use frames::Orientation;

use crate::Logs;
use mindgap_foundations::error::{Error, Result};

/// Logs after inspection.
pub struct Inspection {
    /// The logs, without what was left out and with what could be put right.
    pub logs: Logs,
    /// What was wrong with them.
    pub findings: Vec<Finding>,
}

impl Inspection {
    /// Inspects logs.
    pub fn of(mut logs: Logs) -> Self {
        let mut findings = Vec::new();
        let checks: [fn(&mut Logs) -> Vec<Finding>; 6] =
            [copies::check, clocks::rates, units::commands, units::headings, units::lengths, clocks::shifts];
        checks.iter().for_each(|check| findings.extend(check(&mut logs)));
        findings.extend(echoes::units(&mut logs));
        findings.extend(echoes::none_numbers(&mut logs));
        findings.extend(frames::check(&logs));
        // Row by row the track is held against the commands, which it has to follow as a whole.
        if !findings.iter().any(|found| found.withholds.contains(&Part::Motion)) {
            let checks: [fn(&mut Logs) -> Vec<Finding>; 5] =
                [frozen::check, rest::starts_moving, rest::moves_at_zero_command, headings::check, track::check];
            checks.iter().for_each(|check| findings.extend(check(&mut logs)));
        }
        Inspection { logs, findings }
    }

    /// The logs, for those who learn from them or judge by them; `warn` receives what could be put right in them.
    ///
    /// # Errors
    /// When something is wrong with them that could not be put right.
    pub fn sound(self, warn: impl FnMut(String)) -> Result<Logs> {
        if let Some(why) = self.refusal() {
            return Err(Error::new(why));
        }
        self.findings.iter().map(Finding::line).for_each(warn);
        Ok(self.logs)
    }

    /// Why nothing must be learned from the logs as they are, where something could not be put right.
    pub fn refusal(&self) -> Option<&str> {
        let found = self.findings.iter().find(|found| !found.withholds.is_empty());
        found.map(|found| found.sentence.as_str())
    }

    /// Why a part of the logs must not be compared, where it must not.
    pub fn withheld(&self, part: Part) -> Option<&str> {
        let found = self.findings.iter().find(|found| found.withholds.contains(&part));
        found.map(|found| found.sentence.as_str())
    }
}
