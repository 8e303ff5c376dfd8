//! Coverage of predicted end poses. Logged commands are replayed open-loop on robots drawn from the posterior. A region that
//! contains a share of their end poses should contain the same share of the logged ones.

use glam::DVec2;
use mindgap_built_in_robot::{BuiltInRobot, default_robot, four_obstacles, run_controller};
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_foundations::motion::Motion;
use mindgap_foundations::random::{Generator, generator};
use mindgap_learning::evolve::genome::GenotypeDecoder;
use mindgap_logs::{Logs, Run, Termination};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::ensemble::{HeldMotion, Member, Robots};
use mindgap_models::simulator::motion::{MotionNetworks, Speeds};
use rand_distr::{Distribution, StandardNormal};

/// Shares of the drawn end poses that the regions contain.
pub const REGIONS: [f64; 3] = [0.5, 0.8, 0.95];
/// Lengths of paths in steps.
pub const LENGTHS: [usize; 3] = [5, 10, 25];

/// Number of robots drawn. Each drives every path once.
const ROBOTS: usize = 200;
/// A step longer than this multiple of the nominal one spans missing rows.
const LONGEST_STEP: f64 = 1.5;
/// Rows at the end of a crashed run that a wall may have affected.
const LAST_ROWS: usize = 3;
const MAX_STEPS: u16 = 60;

/// Coverage for paths of one length.
#[derive(Clone, Copy, Debug)]
pub struct Coverage {
    /// Length of the paths in steps.
    pub steps: usize,
    /// Number of paths.
    pub paths: usize,
    /// Share of paths that end within each of [`REGIONS`] about the expected position.
    pub places: [f64; 3],
    /// Share of paths whose final heading is within each region.
    pub headings: [f64; 3],
}

/// Returns the coverage for every length of which the logs have paths, or `None` if the simulator has no posterior.
pub fn coverage(simulator: &Simulator, logs: &Logs, seed: u64) -> Option<Vec<Coverage>> {
    let Robots { drawn, .. } = simulator.robots(ROBOTS, seed)?;
    let correction = simulator.reference.as_ref()?.motion.as_ref()?;
    let replay = Replay {
        networks: simulator.motion_networks()?.corrected(Some(correction)),
        tracker: simulator.ensemble.as_ref()?.noise.tracker.map(f64::sqrt),
        step_ms: simulator.robot.step_ms,
    };
    let mut rng = generator(seed, &[]);
    let mut of_length = |steps: usize| {
        let levels: Vec<[f64; 2]> = logs
            .runs
            .iter()
            .flat_map(|run| replay.paths(run, steps))
            .map(|path| path.levels(&drawn, &mut rng))
            .collect();
        let within = |of: usize| {
            REGIONS.map(|region| levels.iter().filter(|level| level[of] < region).count() as f64 / levels.len() as f64)
        };
        Coverage { steps, paths: levels.len(), places: within(0), headings: within(1) }
    };
    Some(LENGTHS.map(&mut of_length).into_iter().filter(|coverage| coverage.paths > 0).collect())
}

/// Returns runs of random controllers on the built-in robot, without rows that a wall may have affected. They hold their
/// commands for many steps.
pub fn controller_runs(simulator: &Simulator, runs: usize, seed: u64) -> Logs {
    let (robot, scene) = (default_robot(), four_obstacles());
    let built_in = BuiltInRobot::new(&robot, &scene, &[]);
    let decoder = GenotypeDecoder::new(simulator, MAX_STEPS);
    let mut rng = generator(seed, &[]);
    let mut driven = Vec::new();
    while driven.len() < runs {
        let controller = decoder.controller(&decoder.random(&mut rng));
        let start = scene.starts[driven.len() % scene.starts.len()];
        let trajectory = run_controller(&built_in, &controller, start, &mut rng);
        let mut run = trajectory.to_run("run");
        if trajectory.termination == Termination::Crashed {
            run.rows.truncate(run.rows.len().saturating_sub(LAST_ROWS));
        }
        if run.rows.len() > LENGTHS[0] {
            driven.push(run);
        }
    }
    Logs { robot, scene, runs: driven }
}

/// Predicts logged steps.
struct Replay<'a> {
    networks: MotionNetworks<'a>,
    /// Standard deviations of the tracker's error in one pose.
    tracker: Motion<f64>,
    step_ms: f64,
}

/// Consecutive steps of a run between two poses.
struct LoggedPath<'a> {
    replay: &'a Replay<'a>,
    steps: Vec<Step>,
    from: Pose,
    to: Pose,
}

/// A logged step without its outcome.
struct Step {
    /// Left, right, previous left and previous right command.
    speeds: Speeds<f32>,
    /// What the networks predict for it beyond a step in which its command is held; the turn is in degrees.
    beyond_held: Motion<f64>,
    /// Its length against the usual one.
    stretch: f64,
}

impl Replay<'_> {
    /// Returns paths of a run. Each begins in the middle of the one before.
    fn paths<'a>(&'a self, run: &'a Run, steps: usize) -> impl Iterator<Item = LoggedPath<'a>> {
        let last = run.rows.len().saturating_sub(steps);
        (0..last).step_by(steps.div_ceil(2)).filter_map(move |first| self.path(run, first, steps))
    }

    fn path(&self, run: &Run, first: usize, count: usize) -> Option<LoggedPath<'_>> {
        let (from, to) = (run.rows.at(first).pose?, run.rows.at(first + count).pose?);
        let steps: Vec<Step> = (first..first + count).map(|row| self.step(run, row)).collect();
        let unbroken = steps.iter().all(|step| step.stretch <= LONGEST_STEP);
        unbroken.then_some(LoggedPath { replay: self, steps, from, to })
    }

    fn step(&self, run: &Run, row: usize) -> Step {
        let ([left, right], [left_before, right_before]) = (run.rows.at(row).command(), run.previous_command(row));
        let speeds = [left, right, left_before, right_before].map(|command| command as f32);
        let motion = self.networks.evaluate(speeds).map(f64::from).turn_in_degrees();
        Step {
            speeds,
            beyond_held: motion - self.networks.motion([left, right]),
            stretch: (run.rows.at(row + 1).t_ms - run.rows.at(row).t_ms) / self.step_ms,
        }
    }
}

impl LoggedPath<'_> {
    /// Returns the shares of drawn end positions and headings that are nearer to the expected one than the logged one.
    fn levels(&self, robots: &[Member], rng: &mut Generator) -> [f64; 2] {
        let ends: Vec<Pose> = robots.iter().map(|robot| self.end(robot, rng)).collect();
        let count = ends.len() as f64;
        let middle_cm = ends.iter().map(|end| end.position_cm).sum::<DVec2>() / count;
        let turned = |end: &Pose| wrap_rad(end.heading_rad - ends[0].heading_rad);
        let middle_rad = ends.iter().map(turned).sum::<f64>() / count;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for end in &ends {
            let off = end.position_cm - middle_cm;
            (xx, xy, yy) = (xx + off.x * off.x, xy + off.x * off.y, yy + off.y * off.y);
        }
        // The distance in standard deviations, up to a factor.
        let distance = |end: &Pose| {
            let off = end.position_cm - middle_cm;
            yy * off.x * off.x - 2.0 * xy * off.x * off.y + xx * off.y * off.y
        };
        let angle = |end: &Pose| (turned(end) - middle_rad).abs();
        let share = |of: &dyn Fn(&Pose) -> f64| ends.iter().filter(|end| of(end) < of(&self.to)).count() as f64 / count;
        [share(&distance), share(&angle)]
    }

    /// Returns where a tracker sees a robot at the end of these commands.
    fn end(&self, robot: &Member, rng: &mut Generator) -> Pose {
        let seen = |pose: Pose, rng: &mut Generator| {
            self.replay.tracker.map(|deviation| deviation * normal(rng)).turn_in_radians().end(&pose)
        };
        let start = seen(self.from, rng);
        let mut lasting = Motion::ZERO;
        let end = self.steps.iter().enumerate().fold(start, |pose, (place, step)| {
            if place == 0 || !step.is_steady() {
                lasting = Motion::from_fn(|_| normal(rng));
            }
            step.motion(robot, lasting, rng).scaled(step.stretch).turn_in_radians().end(&pose)
        });
        seen(end, rng)
    }
}

impl Step {
    /// Returns whether the command equals that of the step before.
    fn is_steady(&self) -> bool {
        self.speeds[..2] == self.speeds[2..]
    }

    /// Draws the motion of a robot in the step; the turn is in degrees. `lasting` is the deviation that persists while a
    /// command is held, in standard deviations.
    fn motion(&self, robot: &Member, lasting: Motion<f64>, rng: &mut Generator) -> Motion<f64> {
        let [left, right, left_before, right_before] = self.speeds;
        let held = robot.motion([left, right].map(f64::from));
        let first_step = if self.is_steady() {
            Motion::ZERO
        } else {
            robot.first_step([left as i8, right as i8], [left_before as i8, right_before as i8])
        };
        let scatter = robot.scatter([left, right].map(f64::from));
        Motion::from_fn(|axis| {
            let [step, lasts] = scatter[axis];
            let chance = step * normal(rng) + lasts * lasting[axis];
            held[axis] + self.beyond_held[axis] + first_step[axis] + chance
        })
    }
}

fn normal(rng: &mut Generator) -> f64 {
    StandardNormal.sample(rng)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::{record, training_room};
    use mindgap_foundations::executor::Serial;
    use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};

    /// Regions that hold much less would drive controllers into what nobody expects, and much more would hide them. So few
    /// runs leave controllers' headings too narrow: docs/reference/measurements.md has all figures.
    #[test]
    fn regions_contain_their_share_of_paths() {
        let recorded = |seed| record(&default_robot(), &training_room(), 50, 60, &[], seed).expect("room to drive");
        let simulator = train(&Serial, &recorded(1), &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        for (name, logs) in [("random", recorded(2)), ("controllers", controller_runs(&simulator, 60, 3))] {
            for coverage in coverage(&simulator, &logs, 4).expect("a distribution") {
                let [places, headings] = [coverage.places[1], coverage.headings[1]];
                let is_held = (0.7..=0.95).contains(&places) && (0.55..=0.95).contains(&headings);
                assert!(coverage.paths > 20 && is_held, "{name}: {coverage:?}");
            }
        }
    }
}
