//! `mindgap compare`

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use super::json_output::JsonOption;
use super::patch_args::{self, Models, PatchOptions};
use super::table;
use super::{GAP, Run, kinds, progress, warn};
use mindgap_applications::compare::coverage::{self, Script};
use mindgap_applications::compare::layers;
use mindgap_applications::compare::pairs::{self, Pair};
use mindgap_applications::compare::sides;
use mindgap_applications::compare::verify::{Verification, Verifier};
use mindgap_diagnosis::Method;
use mindgap_diagnosis::diagnosis::Diagnosis;
use mindgap_diagnosis::progress::Stage;
use mindgap_diagnosis::request::{Answered, Request};
use mindgap_diagnosis::verdict::Verdict;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_learning::learn::train::{NETWORKS, OF_A_SENSOR, TABLE_ONE, Trainer, train_sensors};
use mindgap_logs::heard::Heard;
use mindgap_logs::{Logs, Robot, Scene};
use mindgap_models::simulator::Simulator;
use mindgap_pages::diagnosis::comparison::Comparison;
use mindgap_pages::diagnosis::{Source, Subject, page};
use mindgap_pages::text;
use mindgap_patch::patch::{NotPatched, Patch, Patched};
use mindgap_workers::program::Program;

/// Compare your own simulator with the robot, from recordings of both: find what differs, why, and what to change in the model
/// file.
///
/// Each side can be folders of logs, ROS bags, or streams as CSV. To compare a robot before and after a repair, use the same
/// command.
#[derive(Args)]
#[command(override_usage = "mindgap compare [OPTIONS] <SIM_RECORDING>... --real <RECORDING>...")]
pub struct Compare {
    /// Recordings of the simulator.
    #[arg(value_name = "SIM_RECORDING", required = true)]
    simulator: Vec<PathBuf>,
    /// Recordings of the robot.
    #[arg(long, value_name = "RECORDING", required = true, num_args = 1..)]
    real: Vec<PathBuf>,
    /// Measured dimensions of the robot, robot.toml (default: that of a folder of logs, or a fit to the recordings).
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// Scene of the recordings (default: open ground); folders of logs contain their own.
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    patch: PatchOptions,
    /// Verify the patch: call COMMAND MODEL COMMANDS.csv OUT once per held-out run, to drive the simulator with the first
    /// patched file. A patch that does not reduce the end-point error is withdrawn.
    #[arg(long, value_name = "COMMAND", requires = "patch")]
    verify: Option<String>,
    /// Timeout of each call of the --verify command, s.
    #[arg(long, value_name = "S", default_value_t = 600.0, value_parser = seconds)]
    command_timeout: f64,
    /// Folder for the imported logs, the learned simulator and the recordings of --verify. If the simulator's recordings are
    /// insufficient, only the commands to drive it with are written there.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = Method::SEED)]
    seed: u64,
    #[command(flatten)]
    json: JsonOption,
    /// Write an HTML page.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Write the robot's runs, the simulator with the same commands without and with the causes, and the residuals as a ROS 2
    /// bag, for Foxglove, PlotJuggler or Rerun.
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Exit with 3 unless the verdict is `no_gap`, for scripts.
    #[arg(long)]
    exit_code: bool,
    /// Whether a gap was found.
    #[arg(skip)]
    has_gap: Cell<bool>,
}

/// Results of `mindgap compare`: a diagnosis, and what was patched and verified.
#[derive(Serialize, JsonSchema)]
pub struct CompareResults<'a> {
    /// What was found.
    #[serde(flatten)]
    diagnosis: &'a Diagnosis,
    /// Runs of both sides that drove the same commands.
    pairs: &'a [Pair],
    /// Tags of model files that were changed.
    patches: &'a [Patch],
    /// Causes that have no tag in a model file.
    not_patched: &'a [NotPatched],
    /// How far path ends are from the robot's, before and after the patch, with `--verify`.
    #[serde(skip_serializing_if = "Option::is_none")]
    verification: Option<&'a [Verification]>,
}

impl Run for Compare {
    fn places(&self) -> Places {
        let inputs = self.simulator.iter().chain(&self.real).chain(&self.robot).chain(&self.scene);
        let places = Places::default().reading(inputs).writing(self.json.path(), kinds::REPORT);
        self.patch.places(places).writing(&self.html, kinds::PAGE).writing(&self.mcap, kinds::BAG).filling(&self.out)
    }

    fn exit_code(&self) -> u8 {
        if self.exit_code && self.has_gap.get() { GAP } else { 0 }
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        let (known, real) = self.sides()?;
        let models = self.patch.models(&real.robot)?;
        let heard = self.usable(known.clone())?;
        let usable = &heard[0].logs;
        if let Some(what) = coverage::missing(usable, &real) {
            return Err(self.not_enough(&what, &real)?);
        }
        let simulator = self.learned(executor, &heard)?;
        let method = Method { seed: self.seed, ..Method::default() };
        let request = Request { simulator: Some(&simulator), controller: None, method, step_ms: None };
        let pairs = pairs::pairs(usable, &real);
        let bar = progress::shares();
        let watch = |stage: Stage| progress::at(&bar, stage.share_before(), stage.words().into());
        let answered = request.of(real.clone(), watch);
        bar.finish_and_clear();
        let answered = answered?;
        let found = &answered.findings;
        self.has_gap.set(found.diagnosis.verdict != Verdict::NoGap);
        if let Some(folder) = &self.out {
            self.write_sides(folder, &known, &real, &simulator)?;
        }
        let mut patched = self.patch.patched(&models, found);
        patch_args::write(&models, &patched)?;
        let verification = self.verified(&models, &mut patched, &answered)?;
        let baseline = || request.baseline(&answered.logs);
        if let Some(path) = &self.mcap {
            files::write(path, layers::bag(found, &baseline()?, &answered.logs, usable, &pairs))?;
        }
        if let Some(path) = &self.html {
            let baseline = &baseline()?;
            let (logs, catalogue, source) = (&answered.logs, request.method.catalogue, self.source());
            let verification = verification.as_deref().unwrap_or_default();
            let simulator = Some(usable);
            let comparison = Comparison { pairs: &pairs, simulator, verification, ..patch_args::on_page(&patched) };
            files::write(path, page(&Subject { findings: found, logs, baseline, catalogue, source, comparison })?)?;
        }
        let mut text = text::diagnosis(&found.diagnosis);
        text += &of_pairs(&pairs);
        if self.patch.is_given() {
            text += &patch_args::text(&models, &patched);
        }
        text += &verification.as_deref().map(of_verification).unwrap_or_default();
        let results = CompareResults {
            diagnosis: &found.diagnosis,
            pairs: &pairs,
            patches: &patched.patches,
            not_patched: &patched.not_patched,
            verification: verification.as_deref(),
        };
        self.json.emit(&results, text)
    }
}

impl Compare {
    /// Reads both sides; a side without robot.toml has the other's robot.
    fn sides(&self) -> Result<(Logs, Logs)> {
        let given = match &self.robot {
            Some(path) => Some(Robot::read_all(path)?),
            None => sides::robot_of(&self.simulator)?
                .map_or_else(|| sides::robot_of(&self.real), |robot| Ok(Some(robot)))?,
        };
        let scene = self.scene.as_deref().map_or(Ok(Scene::default()), Scene::read)?;
        let known = sides::read(&self.simulator, given.clone(), &scene, warn)?;
        let given = given.unwrap_or_else(|| (known.robot, known.sensors()));
        let real = sides::read(&self.real, Some(given), &scene, warn)?;
        Ok((known, real))
    }

    /// Returns the simulator's logs without their defects, as each of its range sensors heard them.
    fn usable(&self, known: Logs) -> Result<Vec<Heard>> {
        let first = &self.simulator[0];
        let report = |found| warn(format!("{}: {found}", first.display()));
        known.usable_by_sensor(report).map_err(|error| error.or_in_file(first))
    }

    /// Learns the simulator's side.
    fn learned(&self, executor: &dyn Executor, heard: &[Heard]) -> Result<Simulator> {
        let bar = progress::bar((NETWORKS.len() + OF_A_SENSOR * (heard.len() - 1)) as u64);
        let watch = |p| progress::training(&bar, p);
        let simulator = train_sensors(executor, heard, &Trainer::Fast, &TABLE_ONE, self.seed, &watch);
        bar.finish_and_clear();
        let simulator = simulator?;
        simulator.missing.iter().for_each(|missing| warn(missing.to_string()));
        Ok(simulator)
    }

    /// Writes the commands that the simulator should be driven with, and returns the error that says so.
    fn not_enough(&self, what: &str, real: &Logs) -> Result<Error> {
        let script = Script::of(real);
        let Some(folder) = &self.out else {
            return Ok(Error::in_file(
                &self.simulator[0],
                format!("{what}; with --out DIR, the commands to drive it with are written there"),
            ));
        };
        let table = folder.join("drive-these.csv");
        files::make_folder(folder)?;
        files::write(&table, script.to_csv())?;
        files::write(&folder.join("drive-these.mcap"), script.to_bag(&real.robot))?;
        Ok(Error::in_file(
            &self.simulator[0],
            format!("{what}; drive it with {} (or drive-these.mcap beside it)", table.display()),
        ))
    }

    fn write_sides(&self, folder: &Path, known: &Logs, real: &Logs, simulator: &Simulator) -> Result<()> {
        files::make_folder(folder)?;
        known.write(&folder.join("simulator"))?;
        real.write(&folder.join("robot"))?;
        simulator.write(&folder.join("simulator.json"))
    }

    /// Verifies a patch and takes it back if it does not bring path ends nearer.
    fn verified(
        &self,
        models: &Models,
        patched: &mut Patched,
        answered: &Answered,
    ) -> Result<Option<Vec<Verification>>> {
        let (Some(command), Some((_, out))) = (&self.verify, models.first()) else {
            return Ok(None);
        };
        let Some(reduction) = answered.findings.diagnosis.reduction.as_ref().filter(|_| !patched.patches.is_empty())
        else {
            return Ok(Some(Vec::new()));
        };
        let kept = self.out.as_ref().map(|folder| folder.join("verify"));
        kept.as_deref().map_or(Ok(()), files::make_folder)?;
        let timeout = Duration::from_secs_f64(self.command_timeout);
        let command = Program::new("the simulator's command", command, timeout)?;
        let moves = patched.patches.iter().any(|patch| !patch.effect.starts_with("sonar_"));
        let verifier = Verifier { command, folder: kept.as_deref(), real: &answered.logs };
        let verification = verifier.verify(&reduction.paths, out, moves)?;
        if verification.iter().any(|length| length.withdrawn) {
            patched.withdraw(models, "withdrawn: the simulator with the patched file ended no nearer to the robot");
            patch_args::write(models, patched)?;
        }
        Ok(Some(verification))
    }

    fn source(&self) -> Source {
        let names =
            |paths: &[PathBuf]| paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
        Source { simulator: names(&self.simulator), logs: names(&self.real), written: None, seed: self.seed }
    }
}

fn of_pairs(pairs: &[Pair]) -> String {
    if pairs.is_empty() {
        return String::new();
    }
    let rows: Vec<[String; 4]> = pairs
        .iter()
        .map(|pair| {
            [pair.real.clone(), pair.simulated.clone(), format!("{:.1}", pair.mean_cm), format!("{:.1}", pair.end_cm)]
        })
        .collect();
    let header = ["robot's run", "simulator's run", "mean distance (cm)", "distance of ends (cm)"];
    format!("Runs with the same commands, aligned at the start:\n{}", table::text(header, &rows))
}

fn of_verification(verification: &[Verification]) -> String {
    let line = |length: &Verification| {
        let Verification { steps, before_cm, after_cm, withdrawn } = length;
        let end = if *withdrawn { "; the patch was withdrawn" } else { "" };
        format!(
            "Path ends after {steps} steps: {before_cm:.1} cm from the robot's before the patch, {after_cm:.1} cm after it{end}\n"
        )
    };
    verification.iter().map(line).collect()
}

/// Parses a positive length of time, s.
pub(super) fn seconds(text: &str) -> std::result::Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| String::from("is not a number"))?;
    if seconds > 0.0 && seconds < 1e9 { Ok(seconds) } else { Err("must be above zero".into()) }
}
