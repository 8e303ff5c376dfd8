//! The kernel: many runs advance together, one a lane, and a lane whose run has ended takes up the next.
//!
//! Each run draws from its own generator and no operation crosses lanes, so an outcome depends neither on the runs
//! beside it nor on the width of a vector.

use std::f32::consts::PI;

use glam::DVec2;
use mindgap_core::controller::{Machine, Status};
use mindgap_core::maths;
use mindgap_core::maths::Binary32;
use pulp::{Simd, WithSimd};

use super::Noise;
use super::beam::Beam;
use super::course::{Course, Ending, Job, Moment, Outcome, Sensor};
use super::draws::{Draws, Seeds};
use super::room::Point;
use super::scatter::LEVELS;
use super::wrapped::Past;
use crate::geometry::Pose;
use crate::lanes::{Lanes, WIDEST};

/// Runs `jobs`; `finish` is told the outcome of each, `watch` every moment of all.
pub(super) struct Batch<'a, W, F> {
    pub course: &'a Course<'a>,
    pub jobs: &'a [Job<'a>],
    pub watch: W,
    pub finish: F,
}

/// A number a lane.
type Row = [f32; WIDEST];

/// The robots of a vector.
struct Robots<'a> {
    course: &'a Course<'a>,
    runs: [Option<Run<'a>>; WIDEST],
    x_cm: Row,
    y_cm: Row,
    heading_rad: Row,
    seeds: Seeds,
}

/// A run on its lane.
struct Run<'a> {
    number: usize,
    job: Job<'a>,
    machine: Machine,
    /// The tuple that was held in the step before, none before the first.
    held: Option<usize>,
    /// What added effects look back on.
    past: Past,
    /// The residuals that last as long as it is held.
    held_levels: [usize; 3],
}

/// The draws of one step.
struct StepDraws {
    /// An echo comes back where this is below its probability.
    echo: Row,
    /// The reading is the constant one where this is below its probability.
    constant: Row,
    /// Raw bits that choose residuals of the step.
    bits: [u32; WIDEST],
    /// The same for residuals that last.
    held_bits: [u32; WIDEST],
}

/// What came back to the sensors that are beams.
struct Heard {
    reading_cm: Row,
    scatter_cm: Row,
}

/// What the sensors face, and what the networks say of it.
struct Look {
    distance_cm: Row,
    alpha_deg: Row,
    probability: Row,
    value_cm: Row,
}

impl<W: FnMut(Moment), F: FnMut(usize, Outcome)> WithSimd for Batch<'_, W, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let width = Lanes::<S>::WIDTH;
        let mut waiting = self.jobs.iter().copied().enumerate();
        let mut robots = Robots::new(self.course);
        (0..width).for_each(|lane| robots.begin(lane, waiting.next()));
        while robots.runs.iter().any(Option::is_some) {
            let draws = robots.draw(simd);
            let from = (robots.x_cm, robots.y_cm);
            let may_touch = robots.advance(simd, &draws);
            let look = robots.look(simd);
            let heard = robots.hear(simd);
            for (lane, may_touch) in may_touch.into_iter().enumerate().take(width) {
                let Some(run) = &mut robots.runs[lane] else { continue };
                let to_cm = point(&robots.x_cm, &robots.y_cm, lane);
                let from_cm = point(&from.0, &from.1, lane);
                let radius_cm = self.course.robot.body_radius_cm;
                let touch = if may_touch > 0.0 { self.course.room.touch(from_cm, to_cm, radius_cm) } else { None };
                let echo_cm = match (&self.course.wrapped, &self.course.beam, run.job.sensor) {
                    (Some(wrapped), ..) if wrapped.senses() => {
                        let pose = Pose::new(to_cm.x, to_cm.y, f64::from(robots.heading_rad[lane]));
                        wrapped.echo_cm(&mut run.past, pose, draws.echo[lane])
                    }
                    (_, Some(beam), Sensor::Beam) => heard.echo_cm(lane, &draws, beam, self.course),
                    _ => look.echo_cm(lane, &draws, self.course),
                };
                let outcome = run.close_step(from_cm, to_cm, touch, echo_cm);
                let at = outcome.map_or(to_cm, |o| o.end_cm);
                let pose = Pose::new(at.x, at.y, f64::from(robots.heading_rad[lane]));
                (self.watch)(Moment { pose, echo_cm, tuple: run.machine.tuple() });
                if let Some(outcome) = outcome {
                    (self.finish)(run.number, outcome);
                    robots.begin(lane, waiting.next());
                }
            }
        }
    }
}

impl<'a> Robots<'a> {
    fn new(course: &'a Course<'a>) -> Self {
        let row = [0.0; WIDEST];
        let runs = std::array::from_fn(|_| None);
        Robots { course, runs, x_cm: row, y_cm: row, heading_rad: row, seeds: Seeds::default() }
    }

    /// Puts a run, or none, on a lane.
    fn begin(&mut self, lane: usize, next: Option<(usize, Job<'a>)>) {
        let start = self.course.start;
        self.x_cm[lane] = start.position_cm.x as f32;
        self.y_cm[lane] = start.position_cm.y as f32;
        self.heading_rad[lane] = start.heading_rad as f32;
        if let Some((_, job)) = next {
            self.seeds.set(lane, job.seed);
        }
        self.runs[lane] = next.map(|(number, job)| Run {
            number,
            job,
            machine: Machine::start(),
            held: None,
            held_levels: [0; 3],
            past: Past::default(),
        });
    }

    #[inline(always)]
    fn draw<S: Simd>(&mut self, simd: S) -> StepDraws {
        let width = Lanes::<S>::WIDTH;
        let mut draws =
            StepDraws { echo: [0.0; WIDEST], constant: [1.0; WIDEST], bits: [0; WIDEST], held_bits: [0; WIDEST] };
        let mut generators = Draws::load(simd, &self.seeds);
        draws.echo = row(generators.uniform());
        if self.course.noise == Noise::Learned {
            draws.constant = row(generators.uniform());
            simd.partial_store_u32s(&mut draws.bits[..width], generators.bits());
            simd.partial_store_u32s(&mut draws.held_bits[..width], generators.bits());
        }
        generators.store(&mut self.seeds);
        draws
    }

    /// Moves every robot by one step: straight in the heading it had, and then the turn. Returns one for
    /// each that may have touched something on the way, else zero.
    #[inline(always)]
    fn advance<S: Simd>(&mut self, simd: S, draws: &StepDraws) -> Row {
        let width = Lanes::<S>::WIDTH;
        let (mut forward, mut lateral, mut turn) = ([0.0; WIDEST], [0.0; WIDEST], [0.0; WIDEST]);
        for lane in 0..width {
            let Some(run) = &mut self.runs[lane] else { continue };
            let tuple = run.machine.tuple();
            let first = run.held != Some(tuple);
            let mut motion = match &self.course.wrapped {
                None => *run.job.motions.motion(tuple, first),
                Some(wrapped) => {
                    let at = point(&self.x_cm, &self.y_cm, lane);
                    let pose = Pose::new(at.x, at.y, f64::from(self.heading_rad[lane]));
                    let command = run.job.controller.tuples[tuple];
                    let command = [command.left, command.right].map(f32::from);
                    wrapped.motion(&mut run.past, pose, command, &self.course.motion)
                }
            };
            run.held = Some(tuple);
            if self.course.noise == Noise::Learned {
                if first {
                    run.held_levels = [0, 1, 2].map(|i| level(draws.held_bits[lane], i));
                }
                motion = self.course.motion.scatter(&motion, [0, 1, 2].map(|i| draws.level(lane, i)), run.held_levels);
            }
            (forward[lane], lateral[lane], turn[lane]) = (motion.forward_cm, motion.lateral_cm, motion.turn_rad);
        }
        let from = Point { x: load(simd, &self.x_cm), y: load(simd, &self.y_cm) };
        let heading = load(simd, &self.heading_rad);
        let (forward, lateral) = (load(simd, &forward), load(simd, &lateral));
        let (c, s) = (maths::cos(heading), maths::sin(heading));
        let to = Point { x: from.x + (forward * c - lateral * s), y: from.y + (forward * s + lateral * c) };
        self.x_cm = row(to.x);
        self.y_cm = row(to.y);
        self.heading_rad = row(heading + load(simd, &turn));
        let touching = self.course.room.may_touch(from, to, self.course.robot.body_radius_cm as f32);
        row(touching.select(heading.constant(1.0), heading.constant(0.0)))
    }

    /// Where every sensor is, its axis as a unit vector, and its angle in degrees.
    #[inline(always)]
    fn sensors<S: Simd>(&self, simd: S) -> (Point<S>, Point<S>, Lanes<S>) {
        let course = self.course;
        let sonar = &course.robot.ultrasonic;
        let heading = load(simd, &self.heading_rad);
        let (c, s) = (maths::cos(heading), maths::sin(heading));
        let ahead = heading.constant(sonar.x_cm as f32);
        let left = heading.constant(sonar.y_cm as f32);
        let origin = Point {
            x: load(simd, &self.x_cm) + (ahead * c - left * s),
            y: load(simd, &self.y_cm) + (ahead * s + left * c),
        };
        let (cos_yaw, sin_yaw) = (heading.constant(course.yaw_direction[0]), heading.constant(course.yaw_direction[1]));
        let axis = Point { x: c * cos_yaw - s * sin_yaw, y: s * cos_yaw + c * sin_yaw };
        let axis_deg = heading * heading.constant(180.0 / PI) + heading.constant(sonar.yaw_deg as f32);
        (origin, axis, axis_deg)
    }

    /// Listens with every beam, on a course that has one.
    #[inline(always)]
    fn hear<S: Simd>(&mut self, simd: S) -> Heard {
        let Some(beam) = &self.course.beam else {
            return Heard { reading_cm: [f32::INFINITY; WIDEST], scatter_cm: [0.0; WIDEST] };
        };
        let (origin, axis, axis_deg) = self.sensors(simd);
        let mut generators = Draws::load(simd, &self.seeds);
        let heard = beam.hear(&self.course.room, origin, axis, axis_deg, &mut generators);
        generators.store(&mut self.seeds);
        Heard { reading_cm: row(heard.reading_cm), scatter_cm: row(heard.scatter_cm) }
    }

    /// Casts every sensor's axis into the room and asks the two sonar networks.
    #[inline(always)]
    fn look<S: Simd>(&self, simd: S) -> Look {
        let course = self.course;
        let (origin, axis, axis_deg) = self.sensors(simd);
        let faced = course.room.cast(origin, axis, axis_deg);
        let inputs = [faced.distance_cm, faced.alpha_deg];
        let (x, log2_x) = course.echo_probability.scale(inputs);
        let probability = course.echo_probability.evaluate(&x, &log2_x);
        let (x, log2_x) = course.echo_value.scale(inputs);
        let value_cm = course.echo_value.evaluate(&x, &log2_x);
        Look {
            distance_cm: row(faced.distance_cm),
            alpha_deg: row(faced.alpha_deg),
            probability: row(probability),
            value_cm: row(value_cm),
        }
    }
}

impl Run<'_> {
    /// Ends a step of the run: a crash, or the reading and what the controller makes of it.
    fn close_step(
        &mut self,
        from_cm: DVec2,
        to_cm: DVec2,
        touch: Option<f64>,
        echo_cm: Option<f32>,
    ) -> Option<Outcome> {
        if let Some(share) = touch {
            let (end_cm, steps) = (from_cm.lerp(to_cm, share), self.machine.steps() + 1);
            return Some(Outcome { ending: Ending::Crashed, end_cm, steps });
        }
        let ending = match self.machine.step(self.job.controller, echo_cm) {
            Status::Running => return None,
            Status::Finished => Ending::Finished,
            Status::TimedOut => Ending::TimedOut,
        };
        Some(Outcome { ending, end_cm: to_cm, steps: self.machine.steps() })
    }
}

impl StepDraws {
    /// One of the equally likely residuals: five bits for each of the four networks that scatter.
    fn level(&self, lane: usize, network: u32) -> usize {
        level(self.bits[lane], network)
    }
}

/// One of the equally likely residuals of a network.
fn level(bits: u32, network: u32) -> usize {
    (bits >> (5 * network)) as usize % LEVELS
}

impl Heard {
    /// The reading of a lane's sensor, if it produces one.
    fn echo_cm(&self, lane: usize, draws: &StepDraws, beam: &Beam, course: &Course) -> Option<f32> {
        let sonar = &course.robot.ultrasonic;
        let echo_cm =
            beam.report(self.reading_cm[lane], self.scatter_cm[lane], draws.constant[lane], draws.level(lane, 3));
        echo_cm.map(|echo_cm| echo_cm.clamp(sonar.min_cm as f32, sonar.max_cm as f32))
    }
}

impl Look {
    /// The reading of a lane's sensor, if it produces one; where it faces nothing it does not.
    fn echo_cm(&self, lane: usize, draws: &StepDraws, course: &Course) -> Option<f32> {
        if !(self.distance_cm[lane].is_finite() && draws.echo[lane] < self.probability[lane]) {
            return None;
        }
        let sonar = &course.robot.ultrasonic;
        let mut reading_cm = self.value_cm[lane];
        if course.noise == Noise::Learned {
            let context = [self.distance_cm[lane], self.alpha_deg[lane]];
            reading_cm += course.echo_spread.residual(context, draws.level(lane, 3));
            if let Some(constant) = course.constant_reading.filter(|c| draws.constant[lane] < c.probability) {
                // It scatters by a centimetre to either side.
                reading_cm = constant.value_cm + (draws.bits[lane] >> 20) as f32 % 3.0 - 1.0;
            }
        }
        Some(reading_cm.clamp(sonar.min_cm as f32, sonar.max_cm as f32))
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, row: &Row) -> Lanes<S> {
    Lanes::load(simd, &row[..Lanes::<S>::WIDTH])
}

#[inline(always)]
fn row<S: Simd>(lanes: Lanes<S>) -> Row {
    let mut row = [0.0; WIDEST];
    lanes.store(&mut row[..Lanes::<S>::WIDTH]);
    row
}

fn point(x_cm: &Row, y_cm: &Row, lane: usize) -> DVec2 {
    DVec2::new(f64::from(x_cm[lane]), f64::from(y_cm[lane]))
}
