//! `mindgap diagnose`

use std::path::PathBuf;

use clap::Args;

use super::{diagnosis_page, diagnosis_text};
use crate::files;
use crate::gap::baseline::Baseline;
use crate::gap::{Findings, admission, findings, kinematic};
use crate::problem::{Problem, Result};
use crate::simulator::Simulator;

/// Find the gap between a simulator and logs: where it lies, what causes it, and how far it shrinks.
#[derive(Args)]
pub struct Diagnose {
    /// The simulator file.
    sim: PathBuf,
    /// Folder of logs.
    logs: PathBuf,
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
        let found = match &simulator {
            None => findings(kinematic::baseline(&logs), &logs)?,
            Some(simulator) => {
                admission::same_robot(&simulator.robot, &logs.robot)?;
                findings(Baseline::learned(simulator)?, &logs)?
            }
        };
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
        if let (Some(path), Some(experiment)) = (&self.next_experiment, &found.experiment) {
            experiment.commands.write(path)?;
        }
        Ok(diagnosis_text::text(diagnosis))
    }
}

/// The simulator with the effects found.
fn with_effects(simulator: Option<Simulator>, found: &Findings) -> Result<Simulator> {
    let Some(mut simulator) = simulator else {
        return Err(Problem::new("--apply needs a simulator file to add effects to"));
    };
    if found.added.is_empty() {
        return Err(Problem::new("--apply: no known effect explains a gap here, so there is nothing to add"));
    }
    simulator.added.extend(found.added.iter().cloned());
    Ok(simulator)
}
