//! `mindgap diagnose`

use std::path::PathBuf;

use clap::Args;
use mindgap_core::controller::Controller;

use super::checkpoint_args::{Checkpoint, CheckpointOption};
use super::fleet::FleetRequest;
use super::json_output::JsonOption;
use super::textbook::{KINEMATIC, simulator_or_textbook};
use super::{Run, diagnosis_text, kinds, progress};
use mindgap_diagnosis::Method;
use mindgap_diagnosis::progress::Stage;
use mindgap_diagnosis::request::{Answered, Request};
use mindgap_figures::pictures;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_models::effects::own;
use mindgap_models::simulator::{Simulator, textbook};
use mindgap_pages::diagnosis::{Source, Subject, page};

/// Diagnose the gap between a simulator and logs: where it is, what causes it, and how much of it can be closed.
#[derive(Args)]
pub struct Diagnose {
    /// Simulator file; or `kinematic` to compare with a textbook differential drive and an ideal sonar, from the logs'
    /// robot.toml alone.
    #[arg(value_name = "SIM|kinematic")]
    sim: PathBuf,
    /// Folder of logs; with --fleet, a folder that contains one such folder per robot.
    logs: PathBuf,
    /// Controller that drove the logged runs: also compare final positions.
    #[arg(long, value_name = "CONTROLLER")]
    controller: Option<PathBuf>,
    /// User-defined effects that compete with the built-in ones; repeatable.
    #[arg(long, value_name = "FILE")]
    effects: Vec<PathBuf>,
    /// Random seed, for bootstrap intervals and simulated noise.
    #[arg(long, value_name = "N", default_value_t = Method::SEED)]
    seed: u64,
    /// Step length for the comparison (default: the simulator's, or for faster logs a length in which motion is
    /// measurable).
    #[arg(long, value_name = "MS", value_parser = positive)]
    step_ms: Option<f64>,
    #[command(flatten)]
    json: JsonOption,
    /// Write an HTML page.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Write figures into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Write a copy of the simulator with the effects that explain the gap, and the formula of the residual, if any.
    #[arg(long, value_name = "SIM_OUT")]
    apply: Option<PathBuf>,
    /// Write the formula of the unexplained residual, as a file for --effects.
    #[arg(long, value_name = "FILE")]
    formula: Option<PathBuf>,
    /// Write the commands that best discriminate between ambiguous causes, as a run in CSV.
    #[arg(long, value_name = "FILE")]
    next_experiment: Option<PathBuf>,
    /// Diagnose a fleet, one robot per folder in LOGS, and write common effects, outliers and each robot's diagnosis into
    /// this folder. --apply then writes a simulator with the effects that nearly all robots share.
    #[arg(
        long,
        value_name = "OUT",
        conflicts_with_all = ["controller", "json", "html", "figures", "formula", "next_experiment"]
    )]
    fleet: Option<PathBuf>,
    #[command(flatten)]
    checkpoint: CheckpointOption,
}

impl Run for Diagnose {
    fn places(&self) -> Places {
        let inputs = self.simulator_file().into_iter().chain([&self.logs]).chain(&self.controller).chain(&self.effects);
        let places = Places::default().reading(inputs).writing(self.json.path(), kinds::REPORT);
        let places = places.writing(&self.html, kinds::PAGE).writing(&self.apply, kinds::SIMULATOR);
        let places = places.writing(&self.formula, kinds::FORMULA).writing(&self.next_experiment, kinds::UNSIGNED);
        let places = places.filling(&self.figures).filling(&self.fleet);
        places.writing(self.checkpoint.path(), kinds::CHECKPOINT)
    }

    fn checkpoint(&self) -> Option<Checkpoint> {
        self.checkpoint.for_output(self.fleet.as_ref()?)
    }

    fn is_shared(&self) -> bool {
        self.fleet.is_some()
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        if self.fleet.is_none() && self.checkpoint.path().is_some() {
            return Err(Error::new("--checkpoint needs --fleet: the diagnosis of a single robot has no checkpoint"));
        }
        let simulator = self.simulator_file().map(|path| simulator_or_textbook(path)).transpose()?;
        let controller = self.controller_of(simulator.as_ref())?;
        let request = Request {
            simulator: simulator.as_ref(),
            controller: controller.as_ref(),
            method: Method { catalogue: own::beside_built_in(&self.effects)?, seed: self.seed, ..Method::default() },
            step_ms: self.step_ms,
        };
        if let Some(out) = &self.fleet {
            let apply = self.apply.as_deref();
            return FleetRequest { executor, request, logs: &self.logs, out, apply, simulator: self.simulator_name() }
                .answer();
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
        // Everything that can fail happens before anything is written.
        let applied = match &self.apply {
            Some(path) if !found.with_formula().is_empty() => Some((path, request.with_effects_applied(&answered)?)),
            _ => None,
        };
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
        if let Some((path, simulator)) = &applied {
            simulator.write(path)?;
        }
        let mut text = diagnosis_text::text(&found.diagnosis);
        if let (Some(path), None) = (&self.apply, &applied) {
            text += &format!("No effect to apply: {} was not written.\n", path.display());
        }
        match (&self.next_experiment, found.diagnosis.experiment.as_ref()) {
            (Some(path), Some(experiment)) => experiment.commands.write(path)?,
            (Some(path), None) => text += &format!("No causes are ambiguous: {} was not written.\n", path.display()),
            (None, _) => (),
        }
        match (&self.formula, &found.formula) {
            (Some(path), Some(formula)) => {
                files::write(path, kinds::FORMULA_SIGN.to_owned() + &own::to_text(&formula.definition))?;
            }
            (Some(path), None) => text += &format!("No formula was confirmed: {} was not written.\n", path.display()),
            (None, _) => (),
        }
        self.json.emit(&found.diagnosis, text)
    }
}

impl Diagnose {
    /// Returns the simulator file, or `None` for `kinematic`.
    fn simulator_file(&self) -> Option<&PathBuf> {
        Some(&self.sim).filter(|sim| sim.as_os_str() != KINEMATIC)
    }

    /// Reads the controller that drove the logged runs, if one is given.
    fn controller_of(&self, simulator: Option<&Simulator>) -> Result<Option<Controller>> {
        let Some(path) = &self.controller else { return Ok(None) };
        let simulator = simulator.ok_or_else(|| Error::new("--controller needs a simulator file"))?;
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

/// Parses a positive length of time, ms.
fn positive(text: &str) -> std::result::Result<f64, String> {
    let ms: f64 = text.parse().map_err(|_| String::from("is not a number"))?;
    if ms.is_finite() && ms > 0.0 { Ok(ms) } else { Err("must be above zero".into()) }
}
