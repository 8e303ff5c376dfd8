//! `mindgap diagnose --fleet`: a folder with one folder of logs per robot.

use std::path::Path;

use super::{fleet_text, progress};
use mindgap_applications::fleet::{self, ANSWER, DIAGNOSES, Fleet, TABLE};
use mindgap_diagnosis::request::Request;
use mindgap_diagnosis::verdict::Verdict;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_models::effects::Effect;
use mindgap_pages::fleet::{Subject, page};

/// File name of the page in the output folder.
const PAGE: &str = "fleet.html";

/// A request to diagnose a fleet.
pub struct FleetRequest<'a> {
    /// Executes the diagnoses.
    pub executor: &'a dyn Executor,
    /// Request for each robot.
    pub request: Request<'a>,
    /// Folder with the robots' folders of logs.
    pub logs: &'a Path,
    /// Output folder.
    pub out: &'a Path,
    /// Simulator file to write, with the effects that are common to all robots.
    pub apply: Option<&'a Path>,
    /// Name of the simulator file, or of the textbook model.
    pub simulator: String,
}

impl FleetRequest<'_> {
    /// Diagnoses the fleet, writes the results, and returns the report for the terminal and whether any robot has a gap.
    ///
    /// # Errors
    /// If no robot can be diagnosed, or a file cannot be read or written.
    pub fn answer(&self) -> Result<(String, bool)> {
        if self.apply.is_some() && self.request.simulator.is_none() {
            return Err(Error::new("--apply with --fleet needs a simulator file"));
        }
        let found = self.written()?;
        let mut text = fleet_text::text(&found);
        if let (Some(path), Some(simulator)) = (self.apply, self.request.simulator) {
            if found.common.is_empty() {
                text += &format!("No effect is common to all robots: {} was not written.\n", path.display());
            } else {
                let mut simulator = simulator.clone();
                simulator.added.extend(found.common.iter().map(|common| common.effect.clone()));
                simulator.write(path)?;
            }
        }
        let has_gap = found.verdicts.keys().any(|verdict| *verdict != Verdict::NoGap.id());
        Ok((text, has_gap))
    }

    /// Diagnoses the fleet and writes its folder.
    fn written(&self) -> Result<Fleet> {
        let ours = |name: &str| [ANSWER, PAGE, TABLE, DIAGNOSES].contains(&name);
        files::write_folder(self.out, ours, |fresh| {
            let bar = progress::bar(0);
            let fleet = fleet::diagnose(self.executor, self.logs, &self.request, fresh, progress::counting(&bar));
            bar.finish_and_clear();
            let fleet = fleet?;
            files::write_json(&fresh.join(ANSWER), &fleet)?;
            let names = [&*self.logs.to_string_lossy(), self.simulator.as_str()];
            let catalogue: &[&'static Effect] = self.request.method.catalogue;
            let subject = Subject { fleet: &fleet, catalogue, names, seed: self.request.method.seed };
            files::write(&fresh.join(PAGE), page(&subject))?;
            Ok(fleet)
        })
    }
}
