//! `mindgap simulate`

use std::path::PathBuf;

use clap::{Args, value_parser};

use super::evolve::start_of;
use super::table::{self, number};
use crate::error::Result;
use crate::evolve::chance::ROBOTS;
use crate::evolve::controller_file::ControllerFile;
use crate::logs::Scene;
use crate::simulator::environment::Environment;
use crate::simulator::rollout_report::RolloutReport;
use crate::simulator::{Noise, Simulator};

/// Run a controller in a simulator: each run is of another robot that its logs leave possible.
#[derive(Args)]
pub struct Simulate {
    /// The simulator file.
    sim: PathBuf,
    /// The controller file.
    controller: PathBuf,
    /// The scene.
    #[arg(long)]
    scene: PathBuf,
    /// Which of the scene's starts, from 1.
    #[arg(long, default_value_t = 1)]
    start: usize,
    /// How many runs.
    #[arg(long, default_value_t = 10, value_parser = value_parser!(u32).range(1..=1_000_000))]
    runs: u32,
    /// Fixes every draw.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Echoes that fail are the only noise.
    #[arg(long)]
    paper_noise: bool,
    /// Also write paths and outcomes here.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Rows of the table at most.
const ROWS: usize = 20;

impl Simulate {
    /// Simulates and tells how the runs ended.
    pub fn run(&self) -> Result<String> {
        let simulator = Simulator::read(&self.sim)?;
        let controller = ControllerFile::read(&self.controller)?.controller;
        let scene = Scene::read(&self.scene)?;
        let start = start_of(&scene, self.start, &simulator.robot, &self.scene)?;
        let noise = if self.paper_noise { Noise::Paper } else { Noise::Learned };
        let (runs, seed) = (self.runs as usize, self.seed);
        let open = simulator.ensemble.as_ref().filter(|_| noise == Noise::Learned);
        let drawn = open.and_then(|ensemble| ensemble.robots(runs.min(ROBOTS), seed)).map(|robots| robots.drawn);
        let robots = match &drawn {
            Some(drawn) => Environment::of_robots(&simulator, drawn, &scene, start)?,
            None => vec![Environment::new(&simulator, &scene, start, noise)?],
        };
        let rollouts = RolloutReport::of_robots(&robots, &scene, &controller, runs, seed);
        super::reported(self.json.as_deref(), &rollouts, told(&rollouts))
    }
}

fn told(rollouts: &RolloutReport) -> String {
    let rows: Vec<[String; 6]> = rollouts
        .runs
        .iter()
        .take(ROWS)
        .enumerate()
        .map(|(i, run)| {
            let end = [number(Some(run.end_x_cm), 1), number(Some(run.end_y_cm), 1)];
            let [x, y] = end;
            [(i + 1).to_string(), run.termination.into(), run.steps.to_string(), x, y, number(run.distance_cm, 1)]
        })
        .collect();
    let mut text = table::text(["run", "ending", "steps", "x (cm)", "y (cm)", "to target (cm)"], &rows);
    if rollouts.runs.len() > ROWS {
        text += &format!("... and {} more\n", rollouts.runs.len() - ROWS);
    }
    let crashed = rollouts.runs.iter().filter(|run| run.termination == "crashed").count();
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
