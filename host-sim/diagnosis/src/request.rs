//! A diagnosis as it is asked for: of logs in any steps, against a simulator or the textbook, with what is made of it.

use mindgap_core::controller::Controller;

use super::condition;
use super::diagnose::{Findings, findings_watched};
use super::method::Method;
use super::progress::Stage;
use mindgap_foundations::error::{Error, Result};
use mindgap_learning::evaluation::final_position::final_position_errors;
use mindgap_logs::Logs;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::robot::same_robot;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::{Simulator, kinematic, textbook};

/// What is asked.
pub struct Request<'a> {
    /// What logs are compared with; none is the textbook.
    pub simulator: Option<&'a Simulator>,
    /// The controller whose runs the logs are, where they are.
    pub controller: Option<&'a Controller>,
    /// The settings.
    pub method: Method,
    /// Length of the steps in which rows are compared, unless it is the usual one.
    pub step_ms: Option<f64>,
}

/// What was found.
pub struct Answered {
    /// It.
    pub findings: Findings,
    /// The logs in the steps in which they were compared, after inspection as it found them.
    pub logs: Logs,
}

impl<'a> Request<'a> {
    /// Diagnoses logs as they were read; `watch` is told each stage when it begins.
    ///
    /// # Errors
    /// When they are another robot's, cannot be compared in such steps, or say nothing that could be compared, and when a
    /// controller is given without a simulator.
    pub fn of(&self, logs: Logs, watch: impl Fn(Stage)) -> Result<Answered> {
        if self.controller.is_some() && self.simulator.is_none() {
            return Err(Error::new("where a controller's runs end needs a simulator that can run it"));
        }
        // What is wrong with rows shows in the rows as they came.
        let mut inspected = Inspection::new(logs);
        inspected.logs = self.in_steps(inspected.logs)?;
        if let Some(simulator) = self.simulator {
            same_robot(&simulator.robot, &inspected.logs.robot)?;
        }
        let mut findings = findings_watched(self.baseline(&inspected.logs)?, &inspected, self.method, watch)?;
        let logs = inspected.logs;
        if let Some((simulator, controller)) = self.simulator.zip(self.controller) {
            let mut better = simulator.clone();
            better.added.extend(findings.with_formula());
            let ends = final_position_errors([simulator, &better], controller, &logs, self.method.seed)?;
            findings.diagnosis.final_positions = Some(ends);
        }
        Ok(Answered { findings, logs })
    }

    /// What logs are compared with.
    ///
    /// # Errors
    /// As [`Baseline::at_posterior_mean`].
    pub fn baseline(&self, logs: &Logs) -> Result<Baseline<'a>> {
        self.simulator.map_or_else(|| Ok(kinematic::baseline(logs)), Baseline::at_posterior_mean)
    }

    /// The simulator with the effects found and the formula of what they leave; the textbook becomes one that can be run.
    ///
    /// # Errors
    /// When nothing was found that explains a gap.
    pub fn corrected_simulator(&self, Answered { findings, logs }: &Answered) -> Result<Simulator> {
        let effects = findings.with_formula();
        if effects.is_empty() {
            return Err(Error::new(
                "neither a known effect nor a formula explains a gap here, so there is nothing to add to a simulator",
            ));
        }
        let mut simulator = match self.simulator {
            Some(simulator) => simulator.clone(),
            None => textbook::simulator(&kinematic::baseline(logs), findings.scatter.into())?,
        };
        simulator.added.extend(effects);
        Ok(simulator)
    }

    /// The logs in the steps of the simulator, or in those that are asked for.
    fn in_steps(&self, logs: Logs) -> Result<Logs> {
        let own_ms = logs.robot.step_ms;
        let step_ms = match (self.step_ms, self.simulator) {
            (Some(asked_ms), Some(simulator)) if asked_ms != simulator.robot.step_ms => {
                let what = format!("steps of {asked_ms} ms: the simulator's steps are {} ms", simulator.robot.step_ms);
                return Err(Error::new(what));
            }
            (Some(asked_ms), None) => asked_ms,
            (_, Some(simulator)) => simulator.robot.step_ms,
            (None, None) => condition::step_ms(own_ms),
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
