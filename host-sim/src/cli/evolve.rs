//! `mindgap evolve`

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum, value_parser};
use mindgap_core::controller::Controller;
use serde_json::json;

use super::{Run, kinds, progress};
use crate::error::{Error, Result};
use crate::evolve::chance::{Chance, Judge, ROBOTS, RUNS};
use crate::evolve::controller_file::{ControllerFile, Origin};
use crate::evolve::fitness::{FitnessEvaluator, RandomNumbers};
use crate::evolve::genome::GenotypeDecoder;
use crate::evolve::paper::{self, Evolved};
use crate::evolve::robust::{self, EvolutionTask};
use crate::evolve::way::WayMap;
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
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Which of the scene's starts, from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: usize,
    /// The controller file to write.
    #[arg(long)]
    out: PathBuf,
    /// Fixes every draw.
    #[arg(long, value_name = "N", default_value_t = 1)]
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
    /// Also write the same facts here, for programs; `-` is standard output, in place of the text.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
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
        places.writing(&self.json, kinds::REPORT).filling(&self.figures)
    }

    fn run(&self) -> Result<String> {
        let simulator = Simulator::read(&self.sim)?;
        let scene = Scene::read(&self.scene)?;
        let start = start_of(&scene, self.start, &simulator.robot, &self.scene)?;
        let target_cm = scene.target_cm.ok_or_else(|| Error::in_file(&self.scene, "has no [target]"))?;
        let noise = if self.paper || self.paper_noise { Noise::Paper } else { Noise::Learned };
        let environment = Environment::new(&simulator, &scene, start, noise)?;
        let open = simulator.ensemble.as_ref().filter(|_| noise == Noise::Learned);
        let robots = open.and_then(|ensemble| ensemble.robots(ROBOTS, self.seed));
        let environment = match (self.sonar, noise) {
            (Sonar::FirstEcho, _) => environment.with_first_echo(&simulator, &scene)?,
            (Sonar::Networks, Noise::Learned) => environment.with_beam(&simulator),
            (Sonar::Networks, Noise::Paper) => environment,
        };
        let environment = &robots.iter().fold(environment, |any, robots| any.of_robot(&robots.mean));
        let decoder = GenotypeDecoder::new(&simulator, self.max_steps);
        let random_numbers =
            if self.paper || self.fresh_numbers { RandomNumbers::Independent } else { RandomNumbers::Common };
        let seed = self.seed;
        let (runs, floor_cm) = (paper::RUNS, paper::FLOOR_CM);
        let way = &WayMap::new(&scene, target_cm, simulator.robot.body_radius_cm);
        let evaluator =
            FitnessEvaluator { environment, target_cm, way: None, decoder, runs, floor_cm, random_numbers, seed };
        let settings = paper::settings();
        let bar = progress::bar(if self.paper { settings.max_generations } else { robust::GENERATIONS } as u64);
        let watch = |generation: usize, fitness: f64| {
            bar.set_position(generation as u64 + 1);
            bar.set_message(format!("fitness {fitness:.3}"));
        };
        let candidates = if self.paper {
            vec![paper::evolve(&evaluator, &settings, watch)]
        } else {
            robust::candidates(&EvolutionTask { environment, target_cm, way, decoder, random_numbers, seed }, watch)
        };
        let chances = match &robots {
            Some(robots) => {
                let controllers: Vec<Controller> = candidates.iter().map(|c| c.controller.clone()).collect();
                let judge = Judge::new(&simulator, &robots.drawn, &scene, start, target_cm, seed)?;
                judge.chances(&controllers, RUNS)
            }
            None => Vec::new(),
        };
        bar.finish_and_clear();
        let (evolved, chance) = most_likely(candidates, &chances);
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
        let facts = json!({
            "schema": 1, "controller": self.out, "start": self.start, "seed": self.seed,
            "generations": evolved.generations, "fitness": evolved.fitness, "success": success.rate,
            "crashed": success.crashed, "median_cm": success.median_cm, "chance": chance,
        });
        let text = format!(
            "start {}: {:.0} % of {JUDGED_RUNS} fresh simulated runs reach the target, {:.0} % crash; median distance {:.1} cm\n\
             {}controller written to {}\n",
            self.start,
            100.0 * success.rate,
            100.0 * success.crashed,
            success.median_cm,
            chance.map_or_else(String::new, |chance| told(&chance)),
            self.out.display()
        );
        super::reported(self.json.as_deref(), &facts, text)
    }
}

/// The controller with the best chance, as far as chances are known; else the first.
fn most_likely(mut candidates: Vec<Evolved>, chances: &[Chance]) -> (Evolved, Option<Chance>) {
    let better = |a: &usize, b: &usize| chances[*a].success.total_cmp(&chances[*b].success).then(b.cmp(a));
    for (number, (candidate, chance)) in candidates.iter().zip(chances).enumerate() {
        log::info!("controller {} of the search: fitness {:.3}, chance {chance}", number + 1, candidate.fitness);
    }
    let best = (0..chances.len()).max_by(better);
    (candidates.swap_remove(best.unwrap_or(0)), best.map(|best| chances[best]))
}

fn told(chance: &Chance) -> String {
    let not_knowing = 100.0 * chance.not_knowing;
    format!(
        "over the robots that the logs leave possible {chance}; {not_knowing:.0} % of the doubt is about the robot, the rest \
         is chance\n"
    )
}

/// Start N (from 1) of a scene, where the robot has room.
pub fn start_of(scene: &Scene, number: usize, robot: &Robot, path: &Path) -> Result<Pose> {
    scene.start(number, robot.body_radius_cm).map_err(|error| error.or_in_file(path))
}

/// A file's name alone: where it lay says nothing to others.
fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
