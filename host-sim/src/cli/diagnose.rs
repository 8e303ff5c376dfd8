//! `mindgap diagnose`

use std::path::{Path, PathBuf};

use clap::Args;

use super::{diagnosis_page, diagnosis_text};
use crate::effects::applied::AppliedEffect;
use crate::error::{Error, Result};
use crate::evaluation::final_position::{FinalPositionErrors, final_position_errors};
use crate::evolve::controller_file::ControllerFile;
use crate::files;
use crate::gap::{Findings, Method, findings, validate};
use crate::logs::Logs;
use crate::simulator::Simulator;
use crate::simulator::baseline::Baseline;
use crate::simulator::kinematic;

/// Find the gap between a simulator and logs: where it lies, what causes it, and how far it shrinks.
#[derive(Args)]
pub struct Diagnose {
    /// The simulator file.
    sim: PathBuf,
    /// Folder of logs.
    logs: PathBuf,
    /// The logs are of this controller's runs: also compare where they end.
    #[arg(long, value_name = "CONTROLLER")]
    controller: Option<PathBuf>,
    /// Fixes every draw: bootstrap intervals and simulated noise.
    #[arg(long, default_value_t = Method::SEED)]
    seed: u64,
    /// Also write the diagnosis here.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Also write a page for a browser here.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Write a simulator with the effects added that explain the gap.
    #[arg(long, value_name = "SIM_OUT")]
    apply: Option<PathBuf>,
    /// Write the commands to log next here, as a run in CSV, where causes remain confused.
    #[arg(long, value_name = "FILE")]
    next_experiment: Option<PathBuf>,
}

/// Stands for a simulator file: the textbook's.
const KINEMATIC: &str = "kinematic";

impl Diagnose {
    /// Diagnoses; returns the findings.
    pub fn run(&self) -> Result<String> {
        let logs = super::read_logs(&self.logs)?;
        let simulator = if self.sim.as_os_str() == KINEMATIC { None } else { Some(Simulator::read(&self.sim)?) };
        let method = Method { seed: self.seed, ..Method::default() };
        let mut found = match &simulator {
            None => findings(kinematic::baseline(&logs), &logs, method)?,
            Some(simulator) => {
                validate::same_robot(&simulator.robot, &logs.robot)?;
                findings(Baseline::learned(simulator)?, &logs, method)?
            }
        };
        if let Some(path) = &self.controller {
            found.diagnosis.final_positions = Some(ends(simulator.as_ref(), &found.applied, path, &logs, self.seed)?);
        }
        let diagnosis = &found.diagnosis;
        if let Some(path) = &self.apply {
            with_effects(simulator, &found)?.write(path)?;
        }
        if let Some(path) = &self.json {
            files::write_json(path, diagnosis)?;
        }
        if let Some(path) = &self.html {
            let title = format!("{} against {}", self.logs.display(), self.sim.display());
            files::write(path, diagnosis_page::page(diagnosis, &title))?;
        }
        let mut text = diagnosis_text::text(diagnosis);
        match (&self.next_experiment, found.diagnosis.experiment()) {
            (Some(path), Some(experiment)) => experiment.commands.write(path)?,
            (Some(path), None) => text += &format!("No causes are confused: {} is not written.\n", path.display()),
            (None, _) => (),
        }
        Ok(text)
    }
}

/// Where the controller's runs end, with the simulator as it is and with the effects found.
fn ends(
    simulator: Option<&Simulator>,
    applied: &[AppliedEffect],
    controller: &Path,
    logs: &Logs,
    seed: u64,
) -> Result<FinalPositionErrors> {
    let simulator = simulator.ok_or_else(|| Error::new("--controller needs a simulator file that can run it"))?;
    let controller = ControllerFile::read(controller)?.controller;
    let mut better = simulator.clone();
    better.added.extend(applied.iter().cloned());
    final_position_errors([simulator, &better], &controller, logs, seed)
}

/// The simulator with the effects found.
fn with_effects(simulator: Option<Simulator>, found: &Findings) -> Result<Simulator> {
    let Some(mut simulator) = simulator else {
        return Err(Error::new("--apply needs a simulator file to add effects to"));
    };
    if found.applied.is_empty() {
        return Err(Error::new("--apply: no known effect explains a gap here, so there is nothing to add"));
    }
    simulator.added.extend(found.applied.iter().cloned());
    Ok(simulator)
}
