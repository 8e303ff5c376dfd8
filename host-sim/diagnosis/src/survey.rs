//! A survey of logs before anything is made of them: what they hold, what is wrong with them, what they suffice for, and
//! what to drive more.
//!
//! It decides nothing by itself: faults are those of [`inspection`](mindgap_logs::inspection), networks are judged by the limits
//! of their training, and effects by what a diagnosis against the textbook could see of them.

mod advice;
mod further;
mod holdings;

use schemars::JsonSchema;
use serde::Serialize;

pub use holdings::{Heard, Holdings, Range, Witness};

use crate::diagnose::{Prospect, prospect};
use crate::method::Method;
use crate::split;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_learning::learn::train;
use mindgap_logs::inspection::{Finding, Inspection};
use mindgap_logs::{Logs, Run};
use mindgap_models::effects::CATALOGUE;
use mindgap_models::simulator::{Missing, kinematic};

/// What there is to say about logs; docs/reference/json.md has the JSON.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Survey {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// Contents of the logs after correction.
    pub holds: Holdings,
    /// Defects of the logs.
    pub findings: Vec<Finding>,
    /// Why `train`, `evaluate` and `crosscheck` refuse these logs; null if they do not.
    pub refused: Option<String>,
    /// Networks that cannot be trained on these logs.
    pub missing_networks: Vec<Missing>,
    /// Effects that a diagnosis against `kinematic` could not show.
    pub untestable: Vec<&'static str>,
    /// What the logs lack, one sentence each.
    pub drive_more: Vec<String>,
}

impl Survey {
    /// Surveys logs.
    pub fn of(logs: Logs) -> Self {
        Survey::with_logs(logs).0
    }

    /// Surveys logs, and returns them with what can be corrected corrected.
    pub fn with_logs(logs: Logs) -> (Self, Logs) {
        let heard = if logs.sensors().are_several() { logs.by_sensor() } else { Vec::new() };
        let inspected = Inspection::new(logs);
        let mut survey = Survey::of_first(&inspected);
        if let Some(first) = heard.first() {
            further::name_first(&mut survey, &first.sensor);
        }
        heard.into_iter().skip(1).for_each(|heard| further::add(&mut survey, heard));
        (survey, inspected.logs)
    }

    /// Surveys logs as the first range sensor heard them.
    fn of_first(inspected: &Inspection) -> Self {
        let refused = inspected.refusal().map(str::to_owned);
        let enough = enough_of(&inspected.logs);
        let missing_networks = train::unsupported(&enough);
        let coarse = in_steps_that_motion_shows_in(&inspected.logs);
        let mut holds = Holdings::of(&inspected.logs, coarse.as_ref().unwrap_or(&inspected.logs));
        let mut drive_more = advice::advice(&inspected.logs, &holds);
        let findings = inspected.findings.clone();
        let sample = Inspection { logs: coarse.map_or(enough, |coarse| enough_of(&coarse)), findings };
        let untestable;
        (untestable, holds.detectable) = match shown(&sample) {
            Ok(Prospect { untestable, detectable, notes }) => {
                drive_more.extend(notes);
                (untestable, detectable)
            }
            Err(why) => {
                drive_more.push(format!("No effect can be identified: {why}"));
                (CATALOGUE.iter().map(|effect| effect.id).collect(), Vec::new())
            }
        };
        let findings = sample.findings;
        Survey { schema: SchemaNumber, holds, findings, refused, missing_networks, untestable, drive_more }
    }
}

/// Maximum number of rows: effects that these do not excite, more random driving hardly would. A row takes almost a kilobyte.
const ENOUGH_ROWS: usize = 20_000;
/// Minimum number of runs of a sample.
const ENOUGH_RUNS: usize = 100;

/// Returns a sample of large logs: evenly spaced runs, and the beginnings of long ones.
fn enough_of(logs: &Logs) -> Logs {
    let rows = logs.rows();
    if rows <= ENOUGH_ROWS {
        return logs.clone();
    }
    let every = rows.div_ceil(ENOUGH_ROWS).min(logs.runs.len() / ENOUGH_RUNS).max(1);
    let most = (ENOUGH_ROWS / logs.runs.len().div_ceil(every)).max(2);
    let begin = |run: &Run| Run { name: run.name.clone(), rows: run.rows.beginning(most) };
    let runs = logs.runs.iter().step_by(every).map(begin).collect();
    Logs { robot: logs.robot, scene: logs.scene.clone(), runs }
}

/// What a diagnosis against the textbook could show.
fn shown(inspected: &Inspection) -> Result<Prospect> {
    if inspected.logs.runs.is_empty() {
        return Err(Error::new(format!("no run is as long as a step of {} ms.", inspected.logs.robot.step_ms)));
    }
    prospect(kinematic::baseline(&inspected.logs), inspected, Method::default())
}

/// Logs in the steps that a diagnosis compares, where those are longer.
fn in_steps_that_motion_shows_in(logs: &Logs) -> Option<Logs> {
    let step_ms = split::step_ms(logs.robot.step_ms);
    (step_ms > logs.robot.step_ms).then(|| logs.resampled(step_ms))
}

#[cfg(test)]
mod tests;
