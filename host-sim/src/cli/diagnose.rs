//! `mindgap diagnose`

use std::path::PathBuf;

use clap::Args;

use super::{diagnosis_page, diagnosis_text};
use crate::files;
use crate::gap::baseline::Baseline;
use crate::gap::{admission, findings, kinematic};
use crate::problem::Result;
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
        let found = if self.sim.as_os_str() == KINEMATIC {
            findings(kinematic::baseline(&logs), &logs)?
        } else {
            let simulator = Simulator::read(&self.sim)?;
            admission::same_robot(&simulator.robot, &logs.robot)?;
            findings(Baseline::learned(&simulator)?, &logs)?
        };
        let diagnosis = &found.diagnosis;
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
