//! `mindgap simulate`

use std::path::PathBuf;

use clap::{Args, value_parser};

use super::choices::{SENSOR_MODELS, one_of};
use super::evolve::start_of;
use super::json_output::JsonOption;
use super::table::{self, number};
use super::{Run, kinds, progress, textbook};
use mindgap_figures::pictures;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_learning::evolve::trial::Trial;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::{Scene, Termination};
use mindgap_models::simulator::environment::SensorModel;
use mindgap_models::simulator::rollout_report::RolloutReport;
use mindgap_models::simulator::{Noise, Simulator};
use mindgap_pages::simulation::{Subject, page};

/// Run a controller in a simulator; each run samples a robot from the posterior.
#[derive(Args)]
pub struct Simulate {
    /// The simulator file.
    sim: PathBuf,
    /// The controller file.
    controller: PathBuf,
    /// The scene.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Number of the start in the scene, from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: usize,
    /// Number of runs.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = value_parser!(u32).range(1..=1_000_000))]
    runs: u32,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Simulate echo dropouts only, as in the paper.
    #[arg(long)]
    paper_noise: bool,
    /// Sensor model: the beam model fitted to the training logs, the two networks, or the first-echo law. --paper-noise
    /// uses the networks.
    #[arg(long, value_parser = one_of::<SensorModel>(SENSOR_MODELS), default_value = "beam", conflicts_with = "paper_noise")]
    sonar: SensorModel,
    #[command(flatten)]
    json: JsonOption,
    /// Write an HTML page.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Write figures into this folder, as SVG and PNG.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

/// Returns the simulator of the robot with the range sensor that a controller asks.
///
/// # Errors
/// When its tuples ask several, or one that the robot does not have.
pub fn asking(simulator: Simulator, controller: &ControllerFile) -> Result<Simulator> {
    let asked = controller.sensor(simulator.first_sensor())?;
    if asked == simulator.first_sensor() { Ok(simulator) } else { simulator.asking(asked) }
}

/// Maximum number of rows of the table.
const ROWS: usize = 20;

impl Run for Simulate {
    fn places(&self) -> Places {
        let inputs = [&self.sim, &self.controller, &self.scene];
        let places = Places::default().reading(inputs).writing(self.json.path(), kinds::REPORT);
        places.writing(&self.html, kinds::PAGE).filling(&self.figures)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let simulator = textbook::simulator(&self.sim)?;
        let file = ControllerFile::read_for(&self.controller, &simulator.robot)?;
        let simulator = asking(simulator, &file).map_err(|error| error.or_in_file(&self.controller))?;
        let controller = file.controller;
        let scene = Scene::read(&self.scene)?;
        let start = start_of(&scene, self.start, &simulator.robot, &self.scene)?;
        let trial = Trial {
            simulator: &simulator,
            controller: &controller,
            scene: &scene,
            start,
            noise: if self.paper_noise { Noise::Paper } else { Noise::Learned },
            sensor: self.sonar,
            runs: self.runs as usize,
            seed: self.seed,
        };
        let bar = progress::bar(self.runs.into());
        let rollouts = trial.run(progress::counting(&bar));
        bar.finish_and_clear();
        let rollouts = rollouts?;
        if let Some(path) = &self.html {
            let names = [&self.sim, &self.controller, &self.scene].map(|path| path.display().to_string());
            let subject = Subject {
                rollouts: &rollouts,
                controller: &controller,
                robot: &simulator.robot,
                scene: &scene,
                names: names.each_ref().map(String::as_str),
                start: self.start,
                seed: self.seed,
            };
            files::write(path, page(&subject)?)?;
        }
        if let Some(folder) = &self.figures {
            let title = format!("Start {}", self.start);
            pictures::paths(folder, &[pictures::simulated_paths(title, &scene, start, &rollouts)])?;
        }
        self.json.emit(&rollouts, describe(&rollouts))
    }
}

fn describe(rollouts: &RolloutReport) -> String {
    let rows: Vec<[String; 6]> = rollouts
        .runs
        .iter()
        .take(ROWS)
        .enumerate()
        .map(|(i, run)| {
            let end = [number(Some(run.end_x_cm), 1), number(Some(run.end_y_cm), 1)];
            let [x, y] = end;
            [(i + 1).to_string(), run.termination.to_string(), run.steps.to_string(), x, y, number(run.distance_cm, 1)]
        })
        .collect();
    let mut text = table::text(["run", "ending", "steps", "x (cm)", "y (cm)", "to target (cm)"], &rows);
    if rollouts.runs.len() > ROWS {
        text += &format!("... and {} more\n", rollouts.runs.len() - ROWS);
    }
    if rollouts.runs.iter().any(|run| run.termination == Termination::TimedOut) {
        text += "timed out: step limit reached; success if within the target radius\n";
    }
    let crashed = rollouts.runs.iter().filter(|run| run.termination == Termination::Crashed).count();
    let crashes = format!("{crashed} of {} crashed", rollouts.runs.len());
    text + &match rollouts.success {
        Some(success) => format!(
            "{:.1} % of the runs reached the target (within {} cm, no crash); {crashes}\n",
            100.0 * success,
            rollouts.reached_within_cm
        ),
        None => format!("{crashes}; the scene has no target\n"),
    }
}
