//! The cases: starts in generated rooms, for the built-in robot without and with effects that its simulator does not know.

use glam::DVec2;
use mindgap_built_in_robot::{ActiveEffect, BuiltInRobot, Effect, Trajectory, default_robot, run_controller};
use mindgap_core::controller::Controller;
use mindgap_foundations::geometry::{Pose, Rectangle};
use mindgap_foundations::random::{Generator, generator};
use mindgap_learning::evolve::route::RouteMap;
use mindgap_logs::{Scene, Termination};
use mindgap_models::simulator::rollout::REACHED_CM;
use rand::RngExt;
use rand::seq::SliceRandom;

/// Seed of the rooms and of all runs in them.
pub const SEED: u64 = 1703;
const ROOMS: u64 = 10;
const STARTS: usize = 4;
const OBSTACLES: usize = 4;
const FRESH_RUNS: u64 = 5;
const EFFECTS: [Effect; 8] = [
    Effect::MotorAsymmetry,
    Effect::DriveScale,
    Effect::TrackWidth,
    Effect::BatterySag,
    Effect::Deadband,
    Effect::Payload,
    Effect::SonarOffset,
    Effect::SonarYaw,
];

/// A start in a room for a robot.
pub struct Case {
    /// Number of the room.
    pub room: u64,
    /// Number of the start in the room, from 1.
    pub start: usize,
    /// Effect on the robot.
    pub effect: Option<ActiveEffect>,
    /// The room.
    pub scene: Scene,
}

/// Returns all cases in random order. `radius_cm` is the radius of the robot's body.
pub fn all(radius_cm: f64) -> Vec<Case> {
    let mut cases = Vec::new();
    for room in 0..ROOMS {
        let scene = generated(room, radius_cm);
        for start in 1..=STARTS {
            for (effect, number) in [None].into_iter().chain(EFFECTS.map(Some)).zip(0..) {
                let rng = &mut generator(SEED, &[room, start as u64, number]);
                let effect = effect.map(|effect| ActiveEffect::random(effect, rng));
                cases.push(Case { room, start, effect, scene: scene.clone() });
            }
        }
    }
    cases.shuffle(&mut generator(SEED, &[]));
    cases
}

impl Case {
    /// Returns the start pose of the robot.
    pub fn pose(&self) -> Pose {
        self.scene.starts[self.start - 1]
    }

    /// Returns the target, cm.
    pub fn target_cm(&self) -> DVec2 {
        self.scene.target_cm.unwrap_or_default()
    }

    /// Returns the effects on the robot.
    pub fn effects(&self) -> Vec<ActiveEffect> {
        self.effect.into_iter().collect()
    }

    /// Returns the run with this number.
    pub fn drive(&self, controller: &Controller, run: u64) -> Trajectory {
        let robot = BuiltInRobot::new(&default_robot(), &self.scene, &self.effects());
        run_controller(&robot, controller, self.pose(), &mut generator(SEED, &[self.room, self.start as u64, run]))
    }

    /// Returns the final distance from the target, infinite after a crash.
    pub fn missed_cm(&self, driven: &Trajectory) -> f64 {
        let crashed = driven.termination == Termination::Crashed;
        if crashed { f64::INFINITY } else { driven.end().position_cm.distance(self.target_cm()) }
    }

    /// Returns whether a run reached the target.
    pub fn reached(&self, driven: &Trajectory) -> bool {
        self.missed_cm(driven) <= REACHED_CM
    }

    /// Returns the number of successes in five runs that no procedure has seen.
    pub fn fresh_successes(&self, controller: &Controller) -> usize {
        (1..=FRESH_RUNS).filter(|run| self.reached(&self.drive(controller, *run))).count()
    }
}

/// Returns a room with obstacles, a target and starts that all have a path to it.
fn generated(room: u64, radius_cm: f64) -> Scene {
    let mut rng = generator(SEED, &[room]);
    loop {
        let scene = drawn(&mut rng, radius_cm);
        let Some(target_cm) = scene.target_cm else { continue };
        let routes = RouteMap::new(&scene, target_cm, radius_cm + 5.0);
        let far = |start: &Pose| (120.0..450.0).contains(&routes.length_cm(start.position_cm));
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
