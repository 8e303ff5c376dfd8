//! `mindgap evolve`

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum, value_parser};

use super::{Run, kinds, progress};
use crate::error::{Error, Result};
use crate::evolve::controller_file::{ControllerFile, Origin};
use crate::evolve::fitness::{FitnessEvaluator, RandomNumbers};
use crate::evolve::genome::GenotypeDecoder;
use crate::evolve::paper;
use crate::evolve::robust::{self, EvolutionTask};
use crate::files::places::Places;
use crate::geometry::Pose;
use crate::logs::{Robot, Scene};
use crate::pictures;
use crate::simulator::environment::Environment;
use crate::simulator::rollout_report::RolloutReport;
use crate::simulator::{Noise, Simulator};

/// Evolve one controller in a simulator.
#[derive(Args)]
pub struct Evolve {
    /// The simulator file.
    sim: PathBuf,
    /// The scene, with a target and starts.
    #[arg(long)]
    scene: PathBuf,
    /// Which of the scene's starts, from 1.
    #[arg(long, default_value_t = 1)]
    start: usize,
    /// The controller file to write.
    #[arg(long)]
    out: PathBuf,
    /// Fixes every draw.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Follow the paper exactly: one run of the genetic algorithm, its fittest individual, echoes that fail as the only
    /// noise.
    #[arg(long)]
    paper: bool,
    /// Echoes that fail are the only noise.
    #[arg(long)]
    paper_noise: bool,
    /// What makes the readings: the networks (and the beam that the training logs show, in turn with them), or the
    /// first-echo law, which is slower.
    #[arg(long, value_enum, default_value_t = Sonar::Networks, conflicts_with_all = ["paper", "paper_noise"])]
    sonar: Sonar,
    /// Steps after which a controller gives up.
    #[arg(long, default_value_t = 60, value_parser = value_parser!(u16).range(1..))]
    max_steps: u16,
    /// Let every individual of a generation meet its own random numbers, as with --paper, and not all the same ones.
    #[arg(long)]
    fresh_numbers: bool,
    /// Also draw simulated runs of the controller into this folder, as SVG, PNG and PDF.
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

/// Which model of the sensor makes the readings of simulated runs.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sonar {
    /// The two sonar networks.
    Networks,
    /// The first-echo law.
    #[value(name = "first_echo")]
    FirstEcho,
}

/// Fresh runs that tell how well a controller does.
const JUDGED_RUNS: usize = 200;
/// Sets the judging runs apart from all others.
const JUDGING: u64 = 1;
/// Runs that are drawn.
const DRAWN_RUNS: usize = 10;

impl Run for Evolve {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.sim, &self.scene]).writing([&self.out], kinds::CONTROLLER);
        places.filling(&self.figures)
    }

    fn run(&self) -> Result<String> {
        let simulator = Simulator::read(&self.sim)?;
        let scene = Scene::read(&self.scene)?;
        let start = start_of(&scene, self.start, &simulator.robot, &self.scene)?;
        let target_cm = scene.target_cm.ok_or_else(|| Error::in_file(&self.scene, "has no [target]"))?;
        let noise = if self.paper || self.paper_noise { Noise::Paper } else { Noise::Learned };
        let environment = Environment::new(&simulator, &scene, start, noise)?;
        let environment = &match (self.sonar, noise) {
            (Sonar::FirstEcho, _) => environment.with_first_echo(&simulator, &scene)?,
            (Sonar::Networks, Noise::Learned) => environment.with_beam(&simulator),
            (Sonar::Networks, Noise::Paper) => environment,
        };
        let decoder = GenotypeDecoder::new(&simulator, self.max_steps);
        let random_numbers =
            if self.paper || self.fresh_numbers { RandomNumbers::Independent } else { RandomNumbers::Common };
        let seed = self.seed;
        let (runs, floor_cm) = (paper::RUNS, paper::FLOOR_CM);
        let evaluator = FitnessEvaluator { environment, target_cm, decoder, runs, floor_cm, random_numbers, seed };
        let settings = paper::settings();
        let bar = progress::bar(if self.paper { settings.max_generations } else { robust::GENERATIONS } as u64);
        let watch = |generation: usize, fitness: f64| {
            bar.set_position(generation as u64 + 1);
            bar.set_message(format!("fitness {fitness:.3}"));
        };
        let evolved = if self.paper {
            paper::evolve(&evaluator, &settings, watch)
        } else {
            robust::evolve(&EvolutionTask { environment, target_cm, decoder, random_numbers, seed }, watch)
        };
        bar.finish_and_clear();
        let success = evaluator.success(&evolved.controller, JUDGED_RUNS, JUDGING);
        let origin = Origin {
            simulator: name(&self.sim),
            scene: name(&self.scene),
            start: self.start,
            seed: self.seed,
            generations: evolved.generations,
            fitness: evolved.fitness,
            success: success.rate,
        };
        if let Some(folder) = &self.figures {
            let rollouts = RolloutReport::new(environment, &scene, &evolved.controller, DRAWN_RUNS, self.seed);
            let title = format!("Start {}", self.start);
            pictures::paths(folder, &[pictures::simulated_paths(title, &scene, start, &rollouts)])?;
        }
        ControllerFile { controller: evolved.controller, origin: Some(origin) }.write(&self.out)?;
        Ok(format!(
            "start {}: {:.0} % of {JUDGED_RUNS} fresh simulated runs reach the target, {:.0} % crash; median distance {:.1} cm\n\
             controller written to {}\n",
            self.start,
            100.0 * success.rate,
            100.0 * success.crashed,
            success.median_cm,
            self.out.display()
        ))
    }
}

/// Start N (from 1) of a scene, where the robot has room.
pub fn start_of(scene: &Scene, number: usize, robot: &Robot, path: &Path) -> Result<Pose> {
    let count = scene.starts.len();
    let start = number.checked_sub(1).and_then(|i| scene.starts.get(i)).copied();
    let start = start
        .ok_or_else(|| Error::in_file(path, format!("has {count} [[start]] table(s); there is no start {number}")))?;
    let radius_cm = robot.body_radius_cm;
    if !scene.has_room_for(start.position_cm, radius_cm) {
        let what = format!("start {number} leaves no room for a robot of radius {radius_cm} cm");
        return Err(Error::in_file(path, what));
    }
    Ok(start)
}

/// A file's name alone: where it lay says nothing to others.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
