//! Measures the loop on the built-in robot in generated rooms against procedures without it, as rows of CSV for
//! docs/loop.md: `cargo run --release -p mindgap-tests --bin loop-trials -- SIM FIRST_ROOM ROOMS [EFFECT…]`. An effect is
//! `none` or one of `mindgap record --help`, with its strength.

use std::path::Path;
use std::process::ExitCode;

use glam::DVec2;
use mindgap_core::controller::Controller;
use mindgap_host_sim::built_in_robot::{ActiveEffect, BuiltInRobot, Termination, run_controller};
use mindgap_host_sim::chance::{Generator, derive, generator};
use mindgap_host_sim::error::{Error, Result};
use mindgap_host_sim::evolve::controller_file::ControllerFile;
use mindgap_host_sim::evolve::fitness::{FitnessEvaluator, RandomNumbers};
use mindgap_host_sim::evolve::genome::GenotypeDecoder;
use mindgap_host_sim::evolve::paper;
use mindgap_host_sim::evolve::robust::{self, EvolutionTask};
use mindgap_host_sim::evolve::way::WayMap;
use mindgap_host_sim::geometry::{Pose, Rectangle};
use mindgap_host_sim::logs::Scene;
use mindgap_host_sim::simulator::environment::Environment;
use mindgap_host_sim::simulator::rollout::REACHED_CM;
use mindgap_host_sim::simulator::{Noise, Simulator};
use mindgap_host_sim::trials::robot::{Call, TrialRobot};
use mindgap_host_sim::trials::{self, Job};
use rand::RngExt;

const SEED: u64 = 1703;
const STARTS: usize = 4;
const OBSTACLES: usize = 4;
const TRIALS: usize = 5;
const FRESH_RUNS: u64 = 5;
const MAX_STEPS: u16 = 60;

fn main() -> ExitCode {
    match measure() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("loop-trials: {error}");
            ExitCode::FAILURE
        }
    }
}

fn measure() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [sim, first, rooms, effects @ ..] = arguments.as_slice() else {
        return Err(Error::new("SIM FIRST_ROOM ROOMS [EFFECT…]"));
    };
    let number = |text: &String| text.parse::<u64>().map_err(|e| Error::new(format!("{text}: {e}")));
    let (first, rooms) = (number(first)?, number(rooms)?);
    println!("room,start,effect,method,trials,fresh_successes,verdict");
    for room in first..first + rooms {
        for effect in effects {
            for start in 1..=STARTS {
                Case { simulator: Path::new(sim), room, start, effect }.measure()?;
            }
        }
    }
    Ok(())
}

/// A start in a room for a robot.
struct Case<'a> {
    simulator: &'a Path,
    room: u64,
    start: usize,
    effect: &'a str,
}

/// The built-in robot as one that a loop drives.
struct BuiltIn<'a>(&'a Case<'a>);

impl TrialRobot for BuiltIn<'_> {
    fn drive(&mut self, call: &Call) -> Result<()> {
        let controller = ControllerFile::read(call.controller)?.controller;
        let scene = Scene::read(call.scene)?;
        let robot = self.0.robot(&scene)?;
        let rng = &mut generator(call.seed, &[]);
        run_controller(&robot, &controller, scene.starts[call.start - 1], rng).to_run("run").write(call.out)
    }
}

impl Case<'_> {
    fn measure(&self) -> Result<()> {
        let simulator = Simulator::read(self.simulator)?;
        let scene = generated(self.room, simulator.robot.body_radius_cm);
        let seed = derive(SEED, &[self.room, self.start as u64]);
        let target_cm = scene.target_cm.ok_or_else(|| Error::new("a room without a target"))?;
        let pose = scene.starts[self.start - 1];
        let decoder = GenotypeDecoder::new(&simulator, MAX_STEPS);

        let environment = &Environment::new(&simulator, &scene, pose, Noise::Paper)?;
        let evaluator = FitnessEvaluator {
            environment,
            target_cm,
            way: None,
            decoder,
            runs: paper::RUNS,
            floor_cm: paper::FLOOR_CM,
            random_numbers: RandomNumbers::Independent,
            seed,
        };
        let controller = paper::evolve(&evaluator, &paper::settings(), |_, _| {}).controller;
        self.tell("paper", 0, self.fresh(&scene, &controller)?, "");

        let environment = &Environment::new(&simulator, &scene, pose, Noise::Learned)?.with_beam(&simulator);
        let way = &WayMap::new(&scene, target_cm, simulator.robot.body_radius_cm);
        let task = EvolutionTask { environment, target_cm, way, decoder, random_numbers: RandomNumbers::Common, seed };
        let candidates = robust::candidates(&task, |_, _| {});
        self.tell("evolve", 0, self.fresh(&scene, &candidates[0].controller)?, "");
        let tried = candidates.iter().map(|c| Ok((self.missed_cm(&scene, &c.controller, 0)?, &c.controller)));
        let tried = tried.collect::<Result<Vec<_>>>()?;
        if let Some((_, best)) = tried.iter().min_by(|a, b| a.0.total_cmp(&b.0)) {
            self.tell("evolve and try three", tried.len(), self.fresh(&scene, best)?, "");
        }

        let folder = tempfile::tempdir().map_err(|e| Error::new(e.to_string()))?;
        let path = folder.path().join("scene.toml");
        scene.write(&path)?;
        let job = Job {
            folder: &folder.path().join("loop"),
            simulator: self.simulator,
            scene: &path,
            start: self.start,
            trials: TRIALS,
            max_steps: MAX_STEPS,
            seed,
        };
        let state = trials::run(&job, &mut BuiltIn(self), |_| {})?;
        let controller = ControllerFile::read(&job.folder.join("controller.toml"))?.controller;
        self.tell("loop", state.trials.len(), self.fresh(&scene, &controller)?, &format!("{:?}", state.verdict));
        Ok(())
    }

    fn tell(&self, method: &str, trials: usize, successes: usize, verdict: &str) {
        println!("{},{},{},{method},{trials},{successes},{verdict}", self.room, self.start, self.effect);
    }

    fn robot(&self, scene: &Scene) -> Result<BuiltInRobot> {
        let effects: Vec<ActiveEffect> = match self.effect {
            "none" => Vec::new(),
            effect => vec![effect.parse().map_err(|e| Error::new(format!("{effect}: {e}")))?],
        };
        Ok(BuiltInRobot::new(&mindgap_host_sim::built_in_robot::default_robot(), scene, &effects))
    }

    /// Successes in runs that no procedure saw.
    fn fresh(&self, scene: &Scene, controller: &Controller) -> Result<usize> {
        let missed =
            (1..=FRESH_RUNS).map(|run| self.missed_cm(scene, controller, run)).collect::<Result<Vec<f64>>>()?;
        Ok(missed.iter().filter(|cm| **cm <= REACHED_CM).count())
    }

    /// How far from the target a run ends; infinite after a crash.
    fn missed_cm(&self, scene: &Scene, controller: &Controller, run: u64) -> Result<f64> {
        let rng = &mut generator(SEED, &[self.room, self.start as u64, run]);
        let driven = run_controller(&self.robot(scene)?, controller, scene.starts[self.start - 1], rng);
        let target_cm = scene.target_cm.unwrap_or_default();
        let crashed = driven.termination == Termination::Crashed;
        Ok(if crashed { f64::INFINITY } else { driven.end().position_cm.distance(target_cm) })
    }
}

/// A room with obstacles, a target and starts, from each of which there is a way.
fn generated(room: u64, radius_cm: f64) -> Scene {
    let mut rng = generator(SEED, &[room]);
    loop {
        let scene = drawn(&mut rng, radius_cm);
        let Some(target_cm) = scene.target_cm else { continue };
        let way = WayMap::new(&scene, target_cm, radius_cm + 5.0);
        let far = |start: &Pose| (120.0..450.0).contains(&way.cm(start.position_cm));
        if scene.starts.len() == STARTS && scene.starts.iter().all(far) {
            return scene;
        }
    }
}

fn drawn(rng: &mut Generator, radius_cm: f64) -> Scene {
    let arena_cm = DVec2::new(rng.random_range(260.0..340.0), rng.random_range(200.0..260.0)).round();
    let mut scene = Scene { arena_cm: Some(arena_cm), ..Scene::default() };
    for _ in 0..OBSTACLES {
        let size = DVec2::new(rng.random_range(25.0..65.0), rng.random_range(25.0..65.0)).round();
        let low_cm = (DVec2::new(rng.random(), rng.random()) * (arena_cm - size)).round();
        scene.obstacles.push(Rectangle { low_cm, high_cm: low_cm + size });
    }
    let place = |rng: &mut Generator| {
        let at_cm = (DVec2::new(rng.random(), rng.random()) * arena_cm).round();
        scene.has_room_for(at_cm, radius_cm + 8.0).then_some(at_cm)
    };
    let target_cm = place(rng);
    let starts: Vec<DVec2> = (0..STARTS).filter_map(|_| place(rng)).collect();
    let pose = |at: DVec2| Pose::new(at.x, at.y, 0.0);
    Scene { target_cm, starts: starts.into_iter().map(pose).collect(), ..scene }
}
