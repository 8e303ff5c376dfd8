//! `mindgap diagnose`

use std::path::{Path, PathBuf};

use clap::Args;
use mindgap_core::controller::Controller;

use super::{Run, diagnosis_text, kinds, progress};
use crate::effects::applied::AppliedEffect;
use crate::effects::{CATALOGUE, Effect, own};
use crate::error::{Error, Result};
use crate::evaluation::final_position::{FinalPositionErrors, final_position_errors};
use crate::evolve::controller_file::ControllerFile;
use crate::files;
use crate::files::places::Places;
use crate::gap::progress::Stage;
use crate::gap::{Findings, Method, condition, findings_watched, validate};
use crate::inspection::Inspection;
use crate::logs::Logs;
use crate::page::diagnosis::{Source, Subject, page};
use crate::pictures;
use crate::simulator::baseline::Baseline;
use crate::simulator::{Simulator, kinematic, textbook};

/// Find the gap between a simulator and logs: where it lies, what causes it, and how far it shrinks.
#[derive(Args)]
pub struct Diagnose {
    /// The simulator file; or `kinematic`, which compares with the textbook's differential drive and an ideal sonar, by the
    /// measures in the logs' robot.toml alone.
    #[arg(value_name = "SIM|kinematic")]
    sim: PathBuf,
    /// Folder of logs.
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
    /// Also write the same facts here, for programs; `-` is standard output, in place of the text.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
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
}

/// Stands for a simulator file: the textbook's.
const KINEMATIC: &str = "kinematic";

impl Run for Diagnose {
    fn places(&self) -> Places {
        let inputs = self.simulator_file().into_iter().chain([&self.logs]).chain(&self.controller).chain(&self.effects);
        let places = Places::default().reading(inputs).writing(&self.json, kinds::REPORT);
        let places = places.writing(&self.html, kinds::PAGE).writing(&self.apply, kinds::SIMULATOR);
        let places = places.writing(&self.formula, kinds::FORMULA).writing(&self.next_experiment, kinds::UNSIGNED);
        places.filling(&self.figures)
    }

    fn run(&self) -> Result<String> {
        let simulator = self.simulator_file().map(|path| read_simulator(path)).transpose()?;
        let controller = self.controller_of(simulator.as_ref())?;
        let method = Method { catalogue: self.catalogue()?, seed: self.seed, ..Method::default() };
        // What is wrong with rows shows in the rows as they came.
        let mut inspected = Inspection::of(super::read_logs(&self.logs)?);
        inspected.logs = in_steps(inspected.logs, simulator.as_ref(), self.step_ms)?;
        let logs = &inspected.logs;
        if let Some(simulator) = &simulator {
            validate::same_robot(&simulator.robot, &logs.robot)?;
        }
        let bar = progress::shares();
        let watch = |stage: Stage| {
            bar.set_position((100.0 * stage.share_before()) as u64);
            bar.set_message(stage.words());
            log::info!("{}", stage.words());
        };
        let found = findings_watched(baseline(simulator.as_ref(), logs)?, &inspected, method, watch);
        bar.finish_and_clear();
        let mut found = found?;
        if let Some((simulator, controller)) = simulator.as_ref().zip(controller) {
            found.diagnosis.final_positions =
                Some(ends(simulator, found.with_formula(), &controller, logs, self.seed)?);
        }
        if let Some(path) = &self.html {
            let subject = Subject {
                findings: &found,
                logs,
                baseline: &baseline(simulator.as_ref(), logs)?,
                catalogue: method.catalogue,
                source: self.source()?,
            };
            files::write(path, page(&subject)?)?;
        }
        if let Some(folder) = &self.figures {
            pictures::diagnosis(folder, &found.diagnosis)?;
        }
        if let Some(path) = &self.apply {
            with_effects(simulator, logs, &found)?.write(path)?;
        }
        let mut text = diagnosis_text::text(&found.diagnosis);
        match (&self.next_experiment, found.diagnosis.experiment()) {
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
        super::reported(self.json.as_deref(), &found.diagnosis, text)
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

    fn source(&self) -> Result<Source> {
        Ok(Source {
            simulator: match self.sim.as_os_str() == KINEMATIC {
                true => "the textbook's differential drive and an ideal sonar, from robot.toml (kinematic)".into(),
                false => self.sim.display().to_string(),
            },
            logs: self.logs.display().to_string(),
            written: files::days_written(&self.logs)?,
            seed: self.seed,
        })
    }

    /// The built-in effects and those of the user, whose ids have to differ.
    fn catalogue(&self) -> Result<&'static [&'static Effect]> {
        let mut catalogue = CATALOGUE.to_vec();
        for path in &self.effects {
            for effect in own::read(path)? {
                if catalogue.iter().any(|other| other.id == effect.id) {
                    return Err(Error::in_file(path, format!("effect {} is in another file too", effect.id)));
                }
                catalogue.push(effect);
            }
        }
        Ok(catalogue.leak())
    }
}

/// A simulator file, or what was meant by one that is not there.
fn read_simulator(path: &Path) -> Result<Simulator> {
    let meant = files::did_you_mean(&path.to_string_lossy(), [KINEMATIC]);
    if !path.exists() && !meant.is_empty() {
        return Err(Error::in_file(path, format!("is not there{meant}")));
    }
    Simulator::read(path)
}

fn baseline<'s>(simulator: Option<&'s Simulator>, logs: &Logs) -> Result<Baseline<'s>> {
    simulator.map_or_else(|| Ok(kinematic::baseline(logs)), Baseline::learned)
}

/// The logs in the steps of the simulator, or in those that are asked for.
fn in_steps(logs: Logs, simulator: Option<&Simulator>, asked_ms: Option<f64>) -> Result<Logs> {
    let own_ms = logs.robot.step_ms;
    let step_ms = match (asked_ms, simulator) {
        (Some(asked_ms), Some(simulator)) if asked_ms != simulator.robot.step_ms => {
            let what = format!("--step-ms {asked_ms}: the simulator's steps are {} ms", simulator.robot.step_ms);
            return Err(Error::new(what));
        }
        (Some(asked_ms), None) => asked_ms,
        (_, Some(simulator)) => simulator.robot.step_ms,
        (None, None) => condition::step_ms(own_ms),
    };
    if step_ms < own_ms {
        return Err(Error::new(format!("steps of {step_ms} ms cannot be compared: rows are {own_ms} ms apart")));
    }
    let logs = if step_ms > own_ms { logs.in_steps_of(step_ms) } else { logs };
    if logs.runs.is_empty() {
        Err(Error::new(format!("no run is as long as a step of {step_ms} ms")))
    } else {
        Ok(logs)
    }
}

/// A length of time.
fn positive(text: &str) -> std::result::Result<f64, String> {
    let ms: f64 = text.parse().map_err(|_| String::from("is no number"))?;
    if ms.is_finite() && ms > 0.0 { Ok(ms) } else { Err("is not above zero".into()) }
}

/// Where the controller's runs end, with the simulator as it is and with the effects found.
fn ends(
    simulator: &Simulator,
    effects: Vec<AppliedEffect>,
    controller: &Controller,
    logs: &Logs,
    seed: u64,
) -> Result<FinalPositionErrors> {
    let mut better = simulator.clone();
    better.added.extend(effects);
    final_position_errors([simulator, &better], controller, logs, seed)
}

/// The simulator with the effects found; the textbook becomes one that can be run.
fn with_effects(simulator: Option<Simulator>, logs: &Logs, found: &Findings) -> Result<Simulator> {
    let effects = found.with_formula();
    if effects.is_empty() {
        return Err(Error::new(
            "--apply: neither a known effect nor a formula explains a gap here, so there is nothing to add",
        ));
    }
    let mut simulator = match simulator {
        Some(simulator) => simulator,
        None => textbook::simulator(&kinematic::baseline(logs), found.scatter)?,
    };
    simulator.added.extend(effects);
    Ok(simulator)
}
