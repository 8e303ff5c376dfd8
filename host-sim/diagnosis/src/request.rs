//! A request for a diagnosis: of logs in steps of any length, against a simulator or the textbook.

use mindgap_core::controller::Controller;

use super::diagnose::{Findings, findings_watched};
use super::method::Method;
use super::progress::Stage;
use super::sensors::{Comparison, with_further};
use super::split;
use mindgap_foundations::error::{Error, Result};
use mindgap_learning::evaluation::final_position::final_position_errors;
use mindgap_logs::Logs;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::robot::same_robot;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::{Simulator, kinematic, textbook};

/// A request for a diagnosis.
pub struct Request<'a> {
    /// The simulator, or `None` for the textbook.
    pub simulator: Option<&'a Simulator>,
    /// The controller of the logged runs, if they are runs of a controller.
    pub controller: Option<&'a Controller>,
    /// The settings.
    pub method: Method,
    /// Length of the steps in which rows are compared, unless it is the usual one.
    pub step_ms: Option<f64>,
}

/// The answer to a request.
pub struct Answered {
    /// The findings.
    pub findings: Findings,
    /// The inspected logs in the steps in which they were compared.
    pub logs: Logs,
}

impl<'a> Request<'a> {
    /// Diagnoses logs. `watch` receives each stage when it begins.
    ///
    /// # Errors
    /// If the logs are of another robot, cannot be compared in such steps, or contain nothing to compare, or if there is a
    /// controller and no simulator.
    pub fn of(&self, logs: Logs, watch: impl Fn(Stage)) -> Result<Answered> {
        if self.controller.is_some() && self.simulator.is_none() {
            return Err(Error::new("comparing the final positions of a controller needs a simulator that can run it"));
        }
        let heard = if logs.sensors().are_several() || self.simulator.is_some_and(|of| !of.further.is_empty()) {
            logs.by_sensor()
        } else {
            Vec::new()
        };
        // Defects show in the rows as they were logged.
        let mut inspected = Inspection::new(logs);
        inspected.logs = self.in_steps(inspected.logs)?;
        if let Some(simulator) = self.simulator {
            same_robot(&simulator.robot, &inspected.logs.robot)?;
        }
        let mut findings = findings_watched(self.baseline(&inspected.logs)?, &inspected, self.method, watch)?;
        if !heard.is_empty() {
            let in_steps = |logs| self.in_steps(logs);
            let comparison = Comparison { simulator: self.simulator, method: self.method, in_steps: &in_steps };
            findings = with_further(findings, &heard, &comparison)?;
        }
        let logs = inspected.logs;
        if let Some((simulator, controller)) = self.simulator.zip(self.controller) {
            let mut improved = simulator.clone();
            improved.added.extend(findings.with_formula());
            let errors = final_position_errors([simulator, &improved], controller, &logs, self.method.seed)?;
            findings.diagnosis.final_positions = Some(errors);
        }
        Ok(Answered { findings, logs })
    }

    /// Returns what logs are compared with.
    ///
    /// # Errors
    /// As [`Baseline::at_posterior_mean`].
    pub fn baseline(&self, logs: &Logs) -> Result<Baseline<'a>> {
        self.simulator.map_or_else(|| Ok(kinematic::baseline(logs)), Baseline::at_posterior_mean)
    }

    /// Returns the simulator with the found effects and formula; the textbook becomes a simulator that can be run.
    ///
    /// # Errors
    /// If nothing was found that explains a gap.
    pub fn with_effects_applied(&self, Answered { findings, logs }: &Answered) -> Result<Simulator> {
        let effects = findings.with_formula();
        if effects.is_empty() {
            return Err(Error::new(
                "no effect and no formula explains a gap, so there is nothing to add to a simulator",
            ));
        }
        let mut simulator = match self.simulator {
            Some(simulator) => simulator.clone(),
            None => textbook_of(logs, findings.noise)?,
        };
        simulator.added.extend(effects);
        Ok(simulator)
    }

    /// Resamples logs to the steps of the simulator, or to those requested.
    fn in_steps(&self, logs: Logs) -> Result<Logs> {
        let own_ms = logs.robot.step_ms;
        let step_ms = match (self.step_ms, self.simulator) {
            (Some(requested_ms), Some(simulator)) if requested_ms != simulator.robot.step_ms => {
                let own_ms = simulator.robot.step_ms;
                return Err(Error::new(format!("steps of {requested_ms} ms: the simulator's steps are {own_ms} ms")));
            }
            (Some(requested_ms), None) => requested_ms,
            (_, Some(simulator)) => simulator.robot.step_ms,
            (None, None) => split::step_ms(own_ms),
        };
        if step_ms < own_ms {
            return Err(Error::new(format!("steps of {step_ms} ms cannot be compared: rows are {own_ms} ms apart")));
        }
        let logs = if step_ms > own_ms { logs.resampled(step_ms) } else { logs };
        if logs.runs.is_empty() {
            Err(Error::new(format!("no run is as long as a step of {step_ms} ms")))
        } else {
            Ok(logs)
        }
    }
}

/// Returns the textbook with all range sensors of the logs as a simulator.
fn textbook_of(logs: &Logs, noise: [f64; 3]) -> Result<Simulator> {
    let of = |logs: &Logs| textbook::simulator(&kinematic::baseline(logs), noise.into());
    let mut all = Simulator { sensor: logs.sensors().first_table().map(str::to_owned), ..of(logs)? };
    for heard in logs.by_further_sensor() {
        all = all.with_sensor_of(&heard.sensor, of(&heard.logs)?);
    }
    Ok(all)
}
