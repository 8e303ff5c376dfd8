//! The robots of a vector: where they are, what they hold, and how a step moves them.

use glam::DVec2;
use mindgap_core::controller::{Machine, Status, When};
use mindgap_core::maths;
use mindgap_core::scalar::Scalar;
use pulp::Simd;

use super::{Row, StepDraws, level, load, row};
use crate::effects::context::HISTORY;
use crate::simulator::Noise;
use crate::simulator::draws::{Draws, Seeds};
use crate::simulator::effect_layer::EffectMemory;
use crate::simulator::environment::Environment;
use crate::simulator::known_steps::KnownSteps;
use crate::simulator::motion::{PredictedStep, speeds};
use crate::simulator::rollout::{RolloutOutcome, RolloutRequest, TrajectoryPoint};
use crate::simulator::room::Point;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::lanes::{Lanes, Mask, WIDEST};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_foundations::random::derive;
use mindgap_logs::Termination;

/// Stream key of what a sensor draws that effects change.
const SENSOR: u64 = 1;
/// What happens to a robot that may have touched something.
const MAY_TOUCH: f32 = 2.0;

/// The robots of a vector.
pub struct Robots<'a> {
    pub environment: &'a Environment<'a>,
    pub runs: [Option<Run<'a>>; WIDEST],
    /// Lanes that have a run.
    pub running: usize,
    pub x_cm: Row,
    pub y_cm: Row,
    pub heading_rad: Row,
    pub heading_cos: Row,
    pub heading_sin: Row,
    /// The last reading: not a number where there was none.
    pub echo_before_cm: Row,
    /// The motion of the command that is held.
    motion: Motion<Row>,
    /// The commands themselves, where the networks are asked in every step.
    speeds: [Row; 4],
    /// Readings beyond these end the tuple that is held.
    above_cm: Row,
    below_cm: Row,
    /// Steps until the limit.
    steps_left: Row,
    /// One where the step is the first of a tuple: the next one moves otherwise.
    first: Row,
    seeds: Seeds,
    /// Of what a beam draws, so that robots move alike whatever hears for them.
    pub sensor_seeds: Seeds,
    /// What effects asked for.
    known_steps: KnownSteps<'a>,
}

/// A run on its lane.
pub struct Run<'a> {
    number: usize,
    request: RolloutRequest<'a>,
    machine: Machine<'a>,
    /// What added effects look back on.
    pub memory: EffectMemory,
    /// Steps for which its tuple and the one before were held, as far back as effects look.
    held_steps: usize,
    held_before: usize,
    /// Residual cells of the motion that is held.
    cells: Motion<usize>,
    /// The residuals that last as long as it is held.
    held_levels: Motion<usize>,
}

impl<'a> Robots<'a> {
    /// Lanes without runs: nothing ever happens to them.
    pub fn new(environment: &'a Environment<'a>) -> Self {
        let row = [0.0; WIDEST];
        Robots {
            environment,
            runs: std::array::from_fn(|_| None),
            running: 0,
            x_cm: row,
            y_cm: row,
            heading_rad: row,
            heading_cos: row,
            heading_sin: row,
            echo_before_cm: row,
            motion: Motion::splat(row),
            speeds: [row; 4],
            above_cm: row,
            below_cm: row,
            steps_left: row,
            first: row,
            seeds: Seeds::default(),
            sensor_seeds: Seeds::default(),
            known_steps: KnownSteps::new(&environment.motion),
        }
    }

    /// Puts a run, or none, on a lane.
    pub fn begin(&mut self, lane: usize, next: Option<(usize, RolloutRequest<'a>)>) {
        let start = self.environment.start;
        self.x_cm[lane] = start.position_cm.x as f32;
        self.y_cm[lane] = start.position_cm.y as f32;
        self.heading_rad[lane] = start.heading_rad as f32;
        self.heading_cos[lane] = maths::cos(self.heading_rad[lane]);
        self.heading_sin[lane] = maths::sin(self.heading_rad[lane]);
        self.echo_before_cm[lane] = 0.0;
        self.running -= usize::from(self.runs[lane].is_some());
        self.running += usize::from(next.is_some());
        self.runs[lane] = next.map(|(number, request)| {
            self.seeds.set(lane, request.seed);
            self.sensor_seeds.set(lane, derive(request.seed, &[SENSOR]));
            self.steps_left[lane] = f32::from(request.controller.max_steps);
            Run {
                number,
                request,
                machine: Machine::start(request.controller),
                memory: EffectMemory::default(),
                held_steps: HISTORY,
                held_before: HISTORY,
                cells: Motion::splat(0),
                held_levels: Motion::splat(0),
            }
        });
        if self.runs[lane].is_some() {
            self.hold(lane, true);
        } else {
            self.motion.iter_mut().for_each(|axis| axis[lane] = 0.0);
            self.steps_left[lane] = f32::INFINITY;
            (self.above_cm[lane], self.below_cm[lane]) = (f32::INFINITY, f32::NEG_INFINITY);
            self.first[lane] = 0.0;
        }
    }

    #[inline(always)]
    pub fn draw<S: Simd>(&mut self, simd: S) -> StepDraws {
        let mut draws =
            StepDraws { echo: [0.0; WIDEST], constant: [1.0; WIDEST], bits: [0; WIDEST], held_bits: [0; WIDEST] };
        let mut generators = Draws::load(simd, &self.seeds);
        draws.echo = row(generators.uniform());
        if self.environment.noise == Noise::Learned {
            draws.constant = row(generators.uniform());
            draws.bits = generators.bits_row();
            draws.held_bits = generators.bits_row();
        }
        generators.store(&mut self.seeds);
        draws
    }

    /// Where every robot is.
    #[inline(always)]
    pub fn place(&self) -> (Row, Row) {
        (self.x_cm, self.y_cm)
    }

    /// Moves every robot by one step: straight in the heading it had, and then the turn. Returns where something may
    /// have been touched on the way.
    #[inline(always)]
    pub fn advance<S: Simd>(&mut self, simd: S, draws: &StepDraws) -> Mask<S> {
        self.apply_effects();
        let mut motion = Motion {
            forward: load(simd, &self.motion.forward),
            lateral: load(simd, &self.motion.lateral),
            turn: load(simd, &self.motion.turn),
        };
        if self.environment.asks_every_step {
            let mut speeds = [motion.forward; 4];
            for (speed, row) in speeds.iter_mut().zip(&self.speeds) {
                *speed = load(simd, row);
            }
            let mut rows = self.environment.motion.evaluate(speeds).map(row);
            for lane in (0..Lanes::<S>::WIDTH).filter(|lane| self.rests(*lane)) {
                rows.iter_mut().for_each(|row| row[lane] = 0.0);
            }
            motion = rows.map(|row| load(simd, &row));
        }
        if self.environment.noise == Noise::Learned {
            let residuals = self.residuals(Lanes::<S>::WIDTH, draws);
            for (sum, residual) in motion.iter_mut().zip(residuals.iter()) {
                *sum = *sum + load(simd, residual);
            }
        }
        let Motion { forward, lateral, turn } = motion;
        let from = Point { x: load(simd, &self.x_cm), y: load(simd, &self.y_cm) };
        let (c, s) = (load(simd, &self.heading_cos), load(simd, &self.heading_sin));
        let to = Point { x: from.x + (forward * c - lateral * s), y: from.y + (forward * s + lateral * c) };
        let heading = load(simd, &self.heading_rad) + turn;
        self.x_cm = row(to.x);
        self.y_cm = row(to.y);
        self.heading_rad = row(heading);
        self.heading_cos = row(maths::cos(heading));
        self.heading_sin = row(maths::sin(heading));
        self.environment.room.may_touch(from, to, self.environment.robot.body_radius_cm as f32)
    }

    /// Where a robot has to be looked at: [`MAY_TOUCH`] where it may have touched something, one where its tuple or its
    /// run ends or its next step moves otherwise, else zero.
    #[inline(always)]
    pub fn happens<S: Simd>(&mut self, simd: S, echo_cm: &Row, may_touch: Mask<S>) -> Row {
        let echo_cm = load(simd, echo_cm);
        let (one, half) = (echo_cm.constant(1.0), echo_cm.constant(0.5));
        let left = load(simd, &self.steps_left) - one;
        self.steps_left = row(left);
        let ends = load(simd, &self.above_cm).less(echo_cm) | echo_cm.less(load(simd, &self.below_cm));
        let happens = ends | left.less(half) | half.less(load(simd, &self.first));
        row(may_touch.select(one.constant(MAY_TOUCH), happens.select(one, one.constant(0.0))))
    }

    /// Ends a step in which something `happens` to a robot: a crash, or the reading and what the controller makes of it.
    /// Returns how the run ended, and which it was, if it did.
    pub fn close(
        &mut self,
        lane: usize,
        happens: f32,
        from: &(Row, Row),
        echo_cm: &Row,
    ) -> Option<(usize, RolloutOutcome)> {
        let (to_cm, from_cm) = (self.position_cm(lane), point(&from.0, &from.1, lane));
        let steps_left = self.steps_left[lane];
        let run = self.runs[lane].as_mut()?;
        let controller = run.request.controller;
        let steps = (f32::from(controller.max_steps) - steps_left) as u16;
        run.machine.hold(steps - 1 - run.machine.steps());
        let touch = || self.environment.room.touch(from_cm, to_cm, self.environment.robot.body_radius_cm);
        if let Some(share) = (happens == MAY_TOUCH).then(touch).flatten() {
            return Some((
                run.number,
                RolloutOutcome { termination: Termination::Crashed, end_cm: from_cm.lerp(to_cm, share), steps },
            ));
        }
        let tuple = run.machine.tuple();
        let termination = match run.machine.step(reading(echo_cm[lane])) {
            Status::Running => {
                let next = run.machine.tuple();
                if next != tuple || self.first[lane] > 0.0 {
                    self.hold(lane, next != tuple);
                }
                return None;
            }
            Status::Finished => Termination::Finished,
            Status::TimedOut => Termination::TimedOut,
        };
        Some((run.number, RolloutOutcome { termination, end_cm: to_cm, steps }))
    }

    /// The trajectory point after a step of a lane that has a run, and which it is.
    pub fn trajectory_point(
        &self,
        lane: usize,
        echo_cm: &Row,
        ended: &Option<(usize, RolloutOutcome)>,
    ) -> Option<(usize, TrajectoryPoint)> {
        let run = self.runs[lane].as_ref()?;
        let here = self.pose(lane);
        let position_cm = ended.map_or(here.position_cm, |(_, outcome)| outcome.end_cm);
        let (pose, tuple) = (Pose { position_cm, ..here }, run.machine.tuple());
        Some((run.number, TrajectoryPoint { pose, echo_cm: reading(echo_cm[lane]), tuple }))
    }

    /// Where the robot of a lane is.
    pub fn pose(&self, lane: usize) -> Pose {
        Pose { position_cm: self.position_cm(lane), heading_rad: f64::from(self.heading_rad[lane]) }
    }

    fn position_cm(&self, lane: usize) -> DVec2 {
        point(&self.x_cm, &self.y_cm, lane)
    }

    /// Takes up what the tuple of a lane's machine does in its first or in a later step.
    fn hold(&mut self, lane: usize, first: bool) {
        let Some(run) = &mut self.runs[lane] else { return };
        let place = run.machine.tuple();
        let tuple = &run.request.controller.tuples[place];
        let threshold_cm = f32::from(tuple.threshold_cm);
        (self.above_cm[lane], self.below_cm[lane]) = match tuple.when {
            When::Larger => (threshold_cm, f32::NEG_INFINITY),
            When::Smaller => (f32::INFINITY, threshold_cm),
        };
        self.first[lane] = if first { 1.0 } else { 0.0 };
        if first {
            (run.held_before, run.held_steps) = (run.held_steps, 0);
        }
        for (row, speed) in self.speeds.iter_mut().zip(speeds(run.request.controller, place, first)) {
            row[lane] = speed;
        }
        let step = run.request.motions.step(place, first);
        run.cells = step.cells;
        self.set_motion(lane, step.motion);
    }

    fn rests(&self, lane: usize) -> bool {
        self.environment.motion.rests(&self.speeds.each_ref().map(|row| row[lane]))
    }

    fn set_motion(&mut self, lane: usize, motion: Motion<f32>) {
        for (row, value) in self.motion.iter_mut().zip(motion) {
            row[lane] = value;
        }
    }

    /// Asks the added effects, where there are any, for the motion of every robot.
    fn apply_effects(&mut self) {
        let Some(effect_layer) = &self.environment.effect_layer else { return };
        for lane in 0..WIDEST {
            let pose = self.pose(lane);
            let Some(run) = &mut self.runs[lane] else { continue };
            let (place, motions) = (run.machine.tuple(), run.request.motions);
            let command = run.request.controller.tuples[place];
            let command = [command.left, command.right].map(f32::from);
            let step = match motions.transients() {
                // Nothing else lies as far back as effects look: the motion continues.
                Some(_) if run.held_steps == HISTORY => continue,
                Some(transients) if run.held_steps + run.held_before >= HISTORY - 1 => {
                    run.memory.command(command);
                    transients[place][run.held_steps]
                }
                _ => effect_layer.motion(&mut run.memory, pose, command, |speeds| self.known_steps.step(speeds)),
            };
            run.held_steps = HISTORY.min(run.held_steps + 1);
            let PredictedStep { motion, cells } = step.plus(motions.bias(place));
            run.cells = cells;
            self.set_motion(lane, motion);
        }
    }

    /// What chance adds to forward, lateral and turn.
    #[inline(always)]
    fn residuals(&mut self, width: usize, draws: &StepDraws) -> Motion<Row> {
        let mut residuals = Motion::splat([0.0; WIDEST]);
        for (lane, run) in self.runs.iter_mut().enumerate().take(width) {
            let Some(run) = run else { continue };
            let (bits, held_bits) = (draws.bits[lane], draws.held_bits[lane]);
            if self.first[lane] > 0.0 {
                run.held_levels = Motion::from_fn(|axis| level(held_bits, axis as u32));
            }
            // Nothing scatters where nothing moves.
            if self.motion.iter().all(|row| row[lane] == 0.0) {
                continue;
            }
            let times = run.request.motions.scatter(run.machine.tuple());
            for axis in Axis::ALL {
                let (cell, held, noise) =
                    (run.cells[axis], run.held_levels[axis], &self.environment.motion_noise[axis]);
                residuals[axis][lane] = noise.residual(cell, level(bits, axis as u32), held, times[axis]);
            }
        }
        residuals
    }
}

/// NaN stands for no reading.
fn reading(echo_cm: f32) -> Option<f32> {
    (!echo_cm.is_nan()).then_some(echo_cm)
}

fn point(x_cm: &Row, y_cm: &Row, lane: usize) -> DVec2 {
    DVec2::new(f64::from(x_cm[lane]), f64::from(y_cm[lane]))
}
