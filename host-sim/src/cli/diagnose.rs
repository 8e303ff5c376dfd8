//! `mindgap diagnose`

use std::path::PathBuf;

use clap::Args;
use mindgap_core::controller::Controller;

use super::facts::FactsOption;
use super::fleet::FleetRequest;
use super::lasting::{KeepOption, Kept};
use super::textbook::{KINEMATIC, simulator_beside_textbook};
use super::{Run, diagnosis_text, kinds, progress};
use crate::effects::own;
use crate::error::{Error, Result};
use crate::evolve::controller_file::ControllerFile;
use crate::files;
use crate::files::places::Places;
use crate::fleet::source::is_address;
use crate::gap::Method;
use crate::gap::progress::Stage;
use crate::gap::request::{Answered, Request};
use crate::page::diagnosis::{Source, Subject, page};
use crate::pictures;
use crate::simulator::{Simulator, textbook};

/// Find the gap between a simulator and logs: where it lies, what causes it, and how far it shrinks.
#[derive(Args)]
pub struct Diagnose {
    /// The simulator file; or `kinematic`, which compares with the textbook's differential drive and an ideal sonar, by the
    /// measures in the logs' robot.toml alone.
    #[arg(value_name = "SIM|kinematic")]
    sim: PathBuf,
    /// Folder of logs; with --fleet a folder that has one for each robot.
    logs: PathBuf,
    /// The logs are of this controller's runs: also compare where they end.
    #[arg(long, value_name = "CONTROLLER")]
    controller: Option<PathBuf>,
    /// Effects of your own that compete with the built-in ones; may be given several times.
    #[arg(long, value_name = "FILE")]
    effects: Vec<PathBuf>,
    /// Fixes every draw: bootstrap intervals and simulated noise.
    #[arg(long, value_name = "N", default_value_t = Method::SEED)]
    seed: u64,
    /// Length of the steps in which rows are compared; by default the simulator's, and of rows that come faster than
    /// that, a length that motion shows in.
    #[arg(long, value_name = "MS", value_parser = positive)]
    step_ms: Option<f64>,
    #[command(flatten)]
    facts: FactsOption,
    /// Also write a page for a browser here.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Also draw figures into this folder, as SVG, PNG and PDF.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Write a simulator with the effects added that explain the gap, and the formula of what they leave.
    #[arg(long, value_name = "SIM_OUT")]
    apply: Option<PathBuf>,
    /// Write the formula of what no effect explains here, as a file of own effects.
    #[arg(long, value_name = "FILE")]
    formula: Option<PathBuf>,
    /// Write the commands to log next here, as a run in CSV, where causes remain confused.
    #[arg(long, value_name = "FILE")]
    next_experiment: Option<PathBuf>,
    /// Diagnose a fleet, every folder in LOGS, and write into this folder what the robots have in common, who stands out, and
    /// each one's diagnosis. LOGS and OUT may be addresses in object storage, as s3://robots/tonight. --apply then
    /// writes a simulator with the effects that nearly all robots have alike.
    #[arg(
        long,
        value_name = "OUT",
        conflicts_with_all = ["controller", "json", "html", "figures", "formula", "next_experiment"]
    )]
    fleet: Option<PathBuf>,
    #[command(flatten)]
    keep: KeepOption,
}

impl Run for Diagnose {
    fn places(&self) -> Places {
        let on_disk = |path: &&PathBuf| !is_address(path);
        let logs = Some(&self.logs).filter(on_disk);
        let inputs = self.simulator_file().into_iter().chain(logs).chain(&self.controller).chain(&self.effects);
        let places = Places::default().reading(inputs).writing(self.facts.asked(), kinds::REPORT);
        let places = places.writing(&self.html, kinds::PAGE).writing(&self.apply, kinds::SIMULATOR);
        let places = places.writing(&self.formula, kinds::FORMULA).writing(&self.next_experiment, kinds::UNSIGNED);
        let places = places.filling(&self.figures).filling(self.fleet.as_ref().filter(on_disk));
        places.writing(self.keep.asked(), kinds::CHECKPOINT)
    }

    fn kept(&self) -> Option<Kept> {
        let out = self.fleet.as_ref()?;
        // Beside an address nothing can be kept.
        let is_possible = !is_address(out) || self.keep.asked().is_some();
        is_possible.then(|| self.keep.beside(out)).flatten()
    }

    fn is_shared(&self) -> bool {
        self.fleet.is_some()
    }

    fn run(&self) -> Result<String> {
        if self.fleet.is_none() && self.keep.asked().is_some() {
            return Err(Error::new(
                "--checkpoint keeps the diagnoses of a --fleet: of one robot there is nothing to keep",
            ));
        }
        let simulator = self.simulator_file().map(|path| simulator_beside_textbook(path)).transpose()?;
        let controller = self.controller_of(simulator.as_ref())?;
        let request = Request {
            simulator: simulator.as_ref(),
            controller: controller.as_ref(),
            method: Method { catalogue: own::beside_built_in(&self.effects)?, seed: self.seed, ..Method::default() },
            step_ms: self.step_ms,
        };
        if let Some(out) = &self.fleet {
            let apply = self.apply.as_deref();
            return FleetRequest { request, logs: &self.logs, out, apply, simulator: self.simulator_name() }.answer();
        }
        let bar = progress::shares();
        let watch = |stage: Stage| {
            progress::at(&bar, stage.share_before(), stage.words().into());
            log::info!("{}", stage.words());
        };
        let answered = request.of(super::read_logs(&self.logs)?, watch);
        bar.finish_and_clear();
        let answered = answered?;
        let Answered { findings: found, logs } = &answered;
        if let Some(path) = &self.html {
            let subject = Subject {
                findings: found,
                logs,
                baseline: &request.baseline(logs)?,
                catalogue: request.method.catalogue,
                source: self.source()?,
            };
            files::write(path, page(&subject)?)?;
        }
        if let Some(folder) = &self.figures {
            pictures::diagnosis(folder, &found.diagnosis)?;
        }
        if let Some(path) = &self.apply {
            request
                .with_effects_applied(&answered)
                .map_err(|error| Error::new(format!("--apply: {error}")))?
                .write(path)?;
        }
        let mut text = diagnosis_text::text(&found.diagnosis);
        match (&self.next_experiment, found.diagnosis.experiment.as_ref()) {
            (Some(path), Some(experiment)) => experiment.commands.write(path)?,
            (Some(path), None) => text += &format!("No causes are confused: {} is not written.\n", path.display()),
            (None, _) => (),
        }
        match (&self.formula, &found.formula) {
            (Some(path), Some(formula)) => {
                files::write(path, kinds::FORMULA_SIGN.to_owned() + &own::to_text(&formula.definition))?;
            }
            (Some(path), None) => text += &format!("No formula holds: {} is not written.\n", path.display()),
            (None, _) => (),
        }
        self.facts.told(&found.diagnosis, text)
    }
}

impl Diagnose {
    /// None where the textbook stands for a simulator.
    fn simulator_file(&self) -> Option<&PathBuf> {
        Some(&self.sim).filter(|sim| sim.as_os_str() != KINEMATIC)
    }

    /// The controller whose runs the logs are, where that is said.
    fn controller_of(&self, simulator: Option<&Simulator>) -> Result<Option<Controller>> {
        let Some(path) = &self.controller else { return Ok(None) };
        let simulator = simulator.ok_or_else(|| Error::new("--controller needs a simulator file that can run it"))?;
        Ok(Some(ControllerFile::read_for(path, &simulator.robot)?.controller))
    }

    fn simulator_name(&self) -> String {
        match self.sim.as_os_str() == KINEMATIC {
            true => textbook::NAME.into(),
            false => self.sim.display().to_string(),
        }
    }

    fn source(&self) -> Result<Source> {
        Ok(Source {
            simulator: self.simulator_name(),
            logs: self.logs.display().to_string(),
            written: files::days_written(&self.logs)?,
            seed: self.seed,
        })
    }
}

/// A length of time.
fn positive(text: &str) -> std::result::Result<f64, String> {
    let ms: f64 = text.parse().map_err(|_| String::from("is no number"))?;
    if ms.is_finite() && ms > 0.0 { Ok(ms) } else { Err("is not above zero".into()) }
}
