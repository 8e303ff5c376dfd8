//! `mindgap diagnose`

use std::cell::Cell;
use std::path::PathBuf;

use clap::Args;
use mindgap_core::controller::Controller;
use schemars::JsonSchema;
use serde::Serialize;

use super::checkpoint_args::{Checkpoint, CheckpointOption};
use super::experiments::DriveOptions;
use super::fleet::FleetRequest;
use super::json_output::JsonOption;
use super::patch_args::{self, PatchOptions};
use super::textbook::{not_a_recording, simulator_file, simulator_or_textbook};
use super::{GAP, Run, kinds, progress};
use mindgap_applications::experiments::DrivenScript;
use mindgap_diagnosis::Method;
use mindgap_diagnosis::between_sessions;
use mindgap_diagnosis::diagnosis::Diagnosis;
use mindgap_diagnosis::progress::Stage;
use mindgap_diagnosis::request::{Answered, Request};
use mindgap_diagnosis::verdict::Verdict;
use mindgap_figures::pictures;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_logs::Logs;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::sessions::{self, Session};
use mindgap_models::effects::own;
use mindgap_models::simulator::{Simulator, textbook};
use mindgap_pages::diagnosis::{Source, Subject, page};
use mindgap_pages::text;
use mindgap_patch::patch::{NotPatched, Patch};

/// Diagnose the gap between a simulator and logs: where it is, what causes it, and how much of it can be closed.
#[derive(Args)]
pub struct Diagnose {
    /// Simulator file; or `kinematic` to compare with a textbook differential drive and an ideal sonar, from the logs'
    /// robot.toml alone.
    #[arg(value_name = "SIM|kinematic", value_parser = not_a_recording)]
    sim: PathBuf,
    /// Folders of logs, each a session of one robot; with --fleet, a folder that contains one such folder per robot.
    #[arg(required = true)]
    logs: Vec<PathBuf>,
    /// Controller that drove the logged runs. Final positions are then compared too.
    #[arg(long, value_name = "CONTROLLER")]
    controller: Option<PathBuf>,
    /// User-defined effects that compete with the built-in ones; repeatable.
    #[arg(long, value_name = "FILE")]
    effects: Vec<PathBuf>,
    /// Random seed, for bootstrap intervals and simulated noise.
    #[arg(long, value_name = "N", default_value_t = Method::SEED)]
    seed: u64,
    /// Step length for a comparison with `kinematic` (default: that of the logs; for fast logs, the smallest multiple that
    /// covers the longest latency). A simulator always uses its own step length.
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
    /// Write a copy of the simulator with the effects that explain the gap added, and the formula of the residual if there is
    /// one.
    #[arg(long, value_name = "SIM_OUT")]
    apply: Option<PathBuf>,
    /// Write the formula of the unexplained residual, as a file for --effects.
    #[arg(long, value_name = "FILE")]
    formula: Option<PathBuf>,
    /// Write the commands that best discriminate between ambiguous causes, as a run in CSV.
    #[arg(long, value_name = "FILE")]
    next_experiment: Option<PathBuf>,
    #[command(flatten)]
    patch: PatchOptions,
    #[command(flatten)]
    drive: DriveOptions,
    /// Diagnose a fleet, one robot per folder in LOGS, and write common effects, outliers and each robot's diagnosis into
    /// this folder. --apply then writes a simulator with the effects that nearly all robots share.
    #[arg(
        long,
        value_name = "OUT",
        conflicts_with_all = ["controller", "json", "html", "figures", "formula", "next_experiment", "patch", "drive"]
    )]
    fleet: Option<PathBuf>,
    /// Exit with 3 unless the verdict is `no_gap` (with --fleet: the verdict of every robot). For scripts.
    #[arg(long)]
    exit_code: bool,
    #[command(flatten)]
    checkpoint: CheckpointOption,
    /// Whether a gap was found.
    #[arg(skip)]
    has_gap: Cell<bool>,
}

/// Results of `mindgap diagnose`.
#[derive(Serialize, JsonSchema)]
pub struct DiagnoseResults<'a> {
    /// What was found.
    #[serde(flatten)]
    pub diagnosis: &'a Diagnosis,
    /// Tags of model files that were changed, with `--patch`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patches: Option<&'a [Patch]>,
    /// Causes that have no tag in a model file, with `--patch`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_patched: Option<&'a [NotPatched]>,
    /// Runs that this call drove, with `--drive`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub driven: Option<&'a [DrivenScript]>,
}

impl<'a> DiagnoseResults<'a> {
    /// Returns the results of a diagnosis alone.
    pub fn of(diagnosis: &'a Diagnosis) -> Self {
        DiagnoseResults { diagnosis, patches: None, not_patched: None, driven: None }
    }
}

impl Run for Diagnose {
    fn places(&self) -> Places {
        let inputs =
            simulator_file(&self.sim).into_iter().chain(&self.logs).chain(&self.controller).chain(&self.effects);
        let places = Places::default().reading(inputs).writing(self.json.path(), kinds::REPORT);
        let places = places.writing(&self.html, kinds::PAGE).writing(&self.apply, kinds::SIMULATOR);
        let places = places.writing(&self.formula, kinds::FORMULA).writing(&self.next_experiment, kinds::UNSIGNED);
        let places = self.drive.places(self.patch.places(places)).filling(&self.figures).filling(&self.fleet);
        places.writing(self.checkpoint.path(), kinds::CHECKPOINT)
    }

    fn checkpoint(&self) -> Option<Checkpoint> {
        self.checkpoint.for_output(self.fleet.as_ref()?)
    }

    fn exit_code(&self) -> u8 {
        if self.exit_code && self.has_gap.get() { GAP } else { 0 }
    }

    fn is_shared(&self) -> bool {
        self.fleet.is_some()
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        if self.fleet.is_none() && self.checkpoint.path().is_some() {
            return Err(Error::new("--checkpoint needs --fleet: the diagnosis of a single robot has no checkpoint"));
        }
        let simulator = simulator_file(&self.sim).map(|path| simulator_or_textbook(path)).transpose()?;
        let controller = self.controller_of(simulator.as_ref())?;
        let request = Request {
            simulator: simulator.as_ref(),
            controller: controller.as_ref(),
            method: Method {
                catalogue: own::beside_built_in(&self.effects)?,
                seed: self.seed,
                is_driving: self.drive.is_driving(),
                ..Method::default()
            },
            step_ms: self.step_ms,
        };
        if let Some(out) = &self.fleet {
            let [logs] = self.logs.as_slice() else {
                return Err(Error::new("--fleet takes one folder, which contains a folder of logs per robot"));
            };
            let apply = self.apply.as_deref();
            let request = FleetRequest { executor, request, logs, out, apply, simulator: self.simulator_name() };
            let (text, has_gap) = request.answer()?;
            self.has_gap.set(has_gap);
            return Ok(text);
        }
        let (sessions, logs) = sessions::read_all(&self.logs, super::read_logs)?;
        let models = self.patch.models(&logs.robot)?;
        let series = self.drive.driven(&request, &logs)?;
        let said = series.as_ref().map(|ended| self.drive.text(ended));
        let (mut answered, driven) = match series {
            Some(ended) => (ended.answered, Some(ended.driven)),
            None => (answered(&request, logs)?, None),
        };
        between_sessions::compare(&request, &mut answered, &self.with_series(sessions)?)?;
        let Answered { findings: found, logs } = &answered;
        self.has_gap.set(found.diagnosis.verdict != Verdict::NoGap);
        // Everything that can fail happens before anything is written.
        let applied = match &self.apply {
            Some(path) if !found.with_formula().is_empty() => Some((path, request.with_effects_applied(&answered)?)),
            _ => None,
        };
        let patched = self.patch.is_given().then(|| self.patch.patched(&models, found));
        if let Some(path) = &self.html {
            let subject = Subject {
                findings: found,
                logs,
                baseline: &request.baseline(logs)?,
                catalogue: request.method.catalogue,
                source: self.source()?,
                comparison: patched.as_ref().map(patch_args::on_page).unwrap_or_default(),
            };
            files::write(path, page(&subject)?)?;
        }
        if let Some(folder) = &self.figures {
            pictures::diagnosis(folder, &found.diagnosis)?;
        }
        if let Some((path, simulator)) = &applied {
            simulator.write(path)?;
        }
        let mut text = said.unwrap_or_default() + &text::diagnosis(&found.diagnosis);
        if let Some(patched) = &patched {
            patch_args::write(&models, patched)?;
            text += &patch_args::text(&models, patched);
        }
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
        let results = DiagnoseResults {
            diagnosis: &found.diagnosis,
            patches: patched.as_ref().map(|patched| patched.patches.as_slice()),
            not_patched: patched.as_ref().map(|patched| patched.not_patched.as_slice()),
            driven: driven.as_deref(),
        };
        self.json.emit(&results, text)
    }
}

impl Diagnose {
    /// Adds the runs that were driven as one more session, where the logs are of several.
    fn with_series(&self, mut sessions: Vec<Session>) -> Result<Vec<Session>> {
        if let Some(folder) = self.drive.folder().filter(|_| sessions.len() > 1) {
            sessions.push(Session::read(folder)?);
        }
        Ok(sessions)
    }

    /// Reads the controller that drove the logged runs, if one is given.
    fn controller_of(&self, simulator: Option<&Simulator>) -> Result<Option<Controller>> {
        let Some(path) = &self.controller else { return Ok(None) };
        let simulator = simulator.ok_or_else(|| Error::new("--controller needs a simulator file"))?;
        let file = ControllerFile::read_for(path, &simulator.robot)?;
        file.check_asks(simulator.first_sensor()).map_err(|error| error.or_in_file(path))?;
        Ok(Some(file.controller))
    }

    fn simulator_name(&self) -> String {
        simulator_file(&self.sim).map_or_else(|| textbook::NAME.into(), |file| file.display().to_string())
    }

    fn source(&self) -> Result<Source> {
        let names: Vec<String> = self.logs.iter().map(|folder| folder.display().to_string()).collect();
        let written = files::days_written(&self.logs)?;
        Ok(Source { simulator: self.simulator_name(), logs: names.join(", "), written, seed: self.seed })
    }
}

/// Diagnoses logs and shows how far it is.
pub fn answered(request: &Request, logs: Logs) -> Result<Answered> {
    let bar = progress::shares();
    let watch = |stage: Stage| {
        progress::at(&bar, stage.share_before(), stage.words().into());
        log::info!("{}", stage.words());
    };
    let answered = request.of(logs, watch);
    bar.finish_and_clear();
    answered
}

/// Parses a positive length of time, ms.
pub fn positive(text: &str) -> std::result::Result<f64, String> {
    let ms: f64 = text.parse().map_err(|_| String::from("is not a number"))?;
    if ms.is_finite() && ms > 0.0 { Ok(ms) } else { Err("must be above zero".into()) }
}
