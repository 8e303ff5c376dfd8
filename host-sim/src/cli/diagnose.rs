//! `mindgap diagnose`

use std::path::PathBuf;

use clap::Args;

use crate::files;
use crate::gap::baseline::Baseline;
use crate::gap::verdict::Verdict;
use crate::gap::{Diagnosis, admission, diagnose, kinematic};
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
}

/// Stands for a simulator file: the textbook's.
const KINEMATIC: &str = "kinematic";

impl Diagnose {
    /// Diagnoses; returns the findings.
    pub fn run(&self) -> Result<String> {
        let logs = super::read_logs(&self.logs)?;
        let diagnosis = if self.sim.as_os_str() == KINEMATIC {
            diagnose(kinematic::baseline(&logs), &logs)?
        } else {
            let simulator = Simulator::read(&self.sim)?;
            admission::same_robot(&simulator.robot, &logs.robot)?;
            diagnose(Baseline::learned(&simulator)?, &logs)?
        };
        if let Some(path) = &self.json {
            files::write_json(path, &diagnosis)?;
        }
        Ok(text(&diagnosis))
    }
}

/// A diagnosis on one screen.
fn text(diagnosis: &Diagnosis) -> String {
    let verdict = match diagnosis.verdict {
        Verdict::NoGap => "No gap: the logs agree with the simulator within its own error.",
        Verdict::Known => "There is a gap, and known effects explain it:",
        Verdict::Unknown => "There is a gap, and no known effect explains it.",
    };
    let mut lines = vec![verdict.to_string()];
    for effect in &diagnosis.effects {
        let parameters: Vec<String> = effect.parameters.iter().map(|(name, value)| format!("{name} {value}")).collect();
        lines.push(format!("  {:>3.0} %  {}: {}", 100.0 * effect.probability, effect.id, parameters.join(", ")));
        if !effect.ambiguous_with.is_empty() {
            lines.push(format!("         these logs cannot tell it from {}", effect.ambiguous_with.join(", ")));
        }
    }
    for place in &diagnosis.r#where {
        lines.push(format!(
            "  {:>3.0} % of the gap in {}: {}",
            100.0 * place.share,
            place.channel.name(),
            place.context
        ));
    }
    if let Some(shrink) = &diagnosis.shrink {
        let [low, high] = shrink.ci95.map(|share| 100.0 * share);
        let closed = 100.0 * shrink.reducible_closed;
        lines.push(format!(
            "Gap {:.3} -> {:.3} nats a step on runs not fitted on: {closed:.0} % of what is reducible ({low:.0} to {high:.0})",
            shrink.before, shrink.after
        ));
        if let Some(next) = &shrink.runner_up {
            lines.push(format!("Runner-up {}: {:.0} %", next.id, 100.0 * next.reducible_closed));
        }
    }
    if !diagnosis.untestable.is_empty() {
        let ids = diagnosis.untestable.join(", ");
        lines.push(format!("Not excited by these logs, so neither there nor absent: {ids}"));
    }
    lines.extend(diagnosis.notes.iter().cloned());
    lines.join("\n") + "\n"
}
