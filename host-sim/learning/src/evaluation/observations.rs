//! Logged rows joined with all that a prediction needs: what effects may depend on, what the sensor faces, and what the
//! simulator expects.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::dead_reckoning;
use mindgap_foundations::geometry::{Pose, first_hit};
use mindgap_foundations::motion::Motion;
use mindgap_logs::samples::{self, MotionSample};
use mindgap_logs::{Logs, Row, Run};
use mindgap_models::effects::StepContext;
use mindgap_models::effects::context::{RunHistory, Surroundings};
use mindgap_models::effects::drive_filter::{DriveFilter, FilteredDrive, StepSpeeds};
use mindgap_models::effects::pieces::Pieces;
use mindgap_models::simulator::baseline::MotionModel;
use mindgap_models::sonar::familiar::{FamiliarPoses, PoseMemory};
use mindgap_models::sonar::place::{Place, place_of};
use mindgap_models::sonar::{SensorLaw, View};

/// The rows of a folder of logs at which the robot was tracked.
pub struct Observations {
    /// The robot and the walls around it.
    pub surroundings: Surroundings,
    /// The law of the sensor, or `None` if the sensor is not compared.
    pub law: Option<SensorLaw>,
    /// What earlier readings showed at single poses of this room.
    pub recollection: Option<Arc<PoseMemory>>,
    /// Number of blocks. A block is a run, or a part of a run where there are few runs; blocks are treated as independent.
    pub blocks: usize,
    /// Number of places at which the sensor was.
    pub places: usize,
    /// All rows with a pose, block by block; all rows of a robot that was never tracked but measured its own motion.
    pub rows: Vec<Observation>,
}

/// A row at which the robot was tracked, or whose pose is dead-reckoned.
#[derive(Clone)]
pub struct Observation {
    /// Index of the run within the logs.
    pub run: usize,
    /// Index of the row within the run.
    pub at: usize,
    /// Index of the block.
    pub block: usize,
    /// Index of the sensor's place: poses so close to each other that the sensor receives much the same echoes.
    pub place: usize,
    /// Cross-validation fold of the step: its block, or all runs under the same commands.
    pub fold: usize,
    /// Weights of forward, lateral and turn, below one for steps that repeat each other.
    pub motion_weight: [f64; 3],
    /// Weights of echo rate and echo value, below one for readings that repeat each other.
    pub echo_weight: [f64; 2],
    /// Duration of the step that begins here over the nominal step.
    pub duration_ratio: f64,
    /// What effects may depend on.
    pub context: StepContext,
    /// The steps until the robot was tracked again, if all of them are compared as one. Their poses are not known.
    pub following_steps: Vec<StepContext>,
    /// The motion of the step, or of the steps that are compared as one, if its end was tracked.
    pub motion: Option<Motion<f64>>,
    /// How far the rims of the left and the right wheel turned in the step by their rotation counters, cm.
    pub wheels_cm: Option<[f64; 2]>,
    /// The turn of a step at the yaw rate that a gyro shows at this row, rad.
    pub gyro_rad: Option<f64>,
    /// What the simulator's filter makes of the commands of the step and of the one before.
    pub speeds: StepSpeeds,
    /// The motion that the simulator expects of the logged commands, if it has a model of motion.
    pub expected: Option<Motion<f64>>,
    /// The reading, or `None` for no echo.
    pub echo_cm: Option<f64>,
    /// What the sensor faces from here if no effect changes it.
    pub view: Option<View>,
    /// Ranges along rays to the right and to the left of the sensor's axis, cm.
    pub side_ray_ranges_cm: [f64; 2],
}

/// Angle between the side rays and the sensor's axis, degrees.
const SIDE_RAY_DEG: f64 = 5.0;

/// With fewer runs than this, runs are cut into parts, so that the variance between blocks can be estimated.
pub const FEWEST_BLOCKS: usize = 8;
/// Rows of a part of a long run: about one minute of steps of 400 ms.
const LONGEST_BLOCK: usize = 150;
/// Runs longer than this are cut however many there are. Only a few thousand rows are used, and those of two runs carry
/// less information than those of parts of all runs.
const LONGEST_RUN: usize = 2 * LONGEST_BLOCK;

impl Observations {
    /// Reads the rows of logs, with what `motion` expects of each and what a sensor of this `law` faces.
    pub fn of(logs: &Logs, motion: Option<&MotionModel>, law: Option<&SensorLaw>) -> Self {
        let surroundings = Surroundings::new(&logs.robot, &logs.scene);
        let steps = samples::motion(logs);
        // Counters and gyro serve where nobody tracked the robot. Beside poses, which are a sixth as exact, they made causes of
        // what the forms of the true effects miss by a hundredth.
        let is_tracked = !is_untracked(logs);
        // Where no step has a pose at both ends, whole segments between poses are compared.
        let whole_segments = steps.is_empty() && is_tracked;
        let law = law.filter(|_| is_tracked);
        let mut steps = steps.iter().peekable();
        let drive = FilteredDrive::from(motion.map_or_else(DriveFilter::default, MotionModel::filter));
        let mut rows = Vec::new();
        let parts = parts_per_run(logs);
        let is_unpolled = unpolled_rows(logs);
        for (run, logged) in logs.runs.iter().enumerate() {
            let contexts =
                if is_tracked { contexts(logged, &surroundings) } else { reckoned_contexts(logged, &surroundings) };
            for (k, (row, context)) in logged.rows.iter().zip(&contexts).enumerate() {
                let Some(context) = context else { continue };
                let pose = context.pose;
                let step = steps.next_if(|s| (s.run, s.row) == (run, k));
                let increment = step.map(MotionSample::motion);
                let next_tracked = (k + 1..logged.rows.len()).find(|i| logged.rows.at(*i).pose.is_some());
                let segment_end = next_tracked.filter(|_| whole_segments);
                let segment = || Some(Motion::between(&pose, &logged.rows.at(segment_end?).pose?));
                let end_ms = logged.rows.get(k + 1).map_or(row.t_ms, |next| next.t_ms);
                let block = run * parts + k * parts / logged.rows.len();
                let speeds = drive.speeds_of(&context.commands, &context.pieces, &logs.robot);
                rows.push(Observation {
                    run,
                    at: k,
                    block,
                    place: 0,
                    fold: block,
                    motion_weight: [1.0; 3],
                    echo_weight: if is_unpolled(logged, k) { [0.0; 2] } else { [1.0; 2] },
                    duration_ratio: (end_ms - row.t_ms) / logs.robot.step_ms,
                    context: *context,
                    following_steps: segment_end.map_or_else(Vec::new, |end| untracked(logged, k + 1..end, context)),
                    motion: increment.or_else(segment),
                    wheels_cm: samples::wheels_cm(&logs.robot, logged, k).filter(|_| !is_tracked),
                    gyro_rad: gyro_rad(logs, logged, k).filter(|_| !is_tracked),
                    speeds,
                    expected: motion.map(|motion| motion.step(speeds.now, speeds.before)),
                    echo_cm: row.echo_cm,
                    view: law.map(|law| law.view(&surroundings.surfaces, &surroundings.sensor(&pose, 0.0), 1.0)),
                    side_ray_ranges_cm: side_ray_ranges_cm(&surroundings, &pose),
                });
            }
        }
        let places = number_places(&mut rows);
        let blocks = logs.runs.len() * parts;
        Observations { surroundings, law: law.cloned(), recollection: None, blocks, places, rows }
    }

    /// Adds what earlier readings showed at single poses, if those were of this room.
    pub fn recalling(self, familiar: Option<&FamiliarPoses>) -> Self {
        let recollection =
            familiar.and_then(|familiar| PoseMemory::for_room(familiar, self.surroundings.surfaces.walls()));
        Observations { recollection: recollection.map(Arc::new), ..self }
    }

    /// Splits these into the blocks whose role is false and those whose role is true. Blocks without a role are dropped.
    pub fn split(self, roles: &[Option<bool>]) -> [Self; 2] {
        let count = |role| roles.iter().filter(|r| **r == Some(role)).count();
        let mut parts = [false, true].map(|role| self.with_rows(count(role), Vec::new()));
        let mut counts = [0; 2];
        let mut number = |role: &Option<bool>| {
            let part = usize::from((*role)?);
            counts[part] += 1;
            Some((part, counts[part] - 1))
        };
        let numbers: Vec<Option<(usize, usize)>> = roles.iter().map(&mut number).collect();
        for row in self.rows {
            if let Some((part, block)) = numbers[row.block] {
                parts[part].rows.push(Observation { block, fold: block, ..row });
            }
        }
        parts
    }

    /// Returns every `step`-th row, beginning with the first.
    pub fn every(&self, step: usize) -> Self {
        self.with_rows(self.blocks, self.rows.iter().step_by(step).cloned().collect())
    }

    fn with_rows(&self, blocks: usize, rows: Vec<Observation>) -> Self {
        let Observations { surroundings, law, recollection, places, .. } = self;
        let (surroundings, law, recollection) = (surroundings.clone(), law.clone(), recollection.clone());
        Observations { surroundings, law, recollection, blocks, places: *places, rows }
    }

    /// Returns the indices of a block's rows.
    pub fn of_block(&self, block: usize) -> Range<usize> {
        let begin = self.rows.partition_point(|row| row.block < block);
        begin..self.rows.partition_point(|row| row.block <= block)
    }

    /// Sums one number per row over the rows of each place.
    pub fn by_place(&self, terms: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.places];
        self.rows.iter().zip(terms).for_each(|(row, t)| sums[row.place] += t);
        sums
    }

    /// Returns the largest commanded wheel speed, as a share of the effects' reference speed.
    pub fn top_speed(&self) -> f64 {
        self.rows
            .iter()
            .flat_map(|row| row.context.commands[0].map(|c| row.context.share_of(c.abs())))
            .fold(0.0, f64::max)
    }
}

impl Observation {
    /// Returns the weights of forward, lateral, turn, echo rate and echo value, of both rotation counters and of the gyro.
    pub fn weights(&self) -> [f64; 8] {
        let ([forward, lateral, turn], [rate, value]) = (self.motion_weight, self.echo_weight);
        [forward, lateral, turn, rate, value, forward, forward, turn]
    }

    /// Returns the number of steps that are compared as one.
    pub fn steps(&self) -> usize {
        1 + self.following_steps.len()
    }

    /// Returns the commands of the step and of the one before.
    pub fn commands(&self) -> [[f64; 2]; 2] {
        let [now, before, ..] = self.context.commands;
        [now, before]
    }
}

/// Returns the ranges along the side rays of a robot's sensor, cm; infinite where a ray meets nothing.
pub fn side_ray_ranges_cm(surroundings: &Surroundings, robot: &Pose) -> [f64; 2] {
    [-SIDE_RAY_DEG, SIDE_RAY_DEG].map(|deg| {
        let ray = surroundings.sensor(robot, deg.to_radians());
        let met = first_hit(surroundings.surfaces.walls(), ray.position_cm, ray.direction());
        met.map_or(f64::INFINITY, |(range_cm, _)| range_cm)
    })
}

/// Returns a test of the rows at which the sensor was not polled. A controller reads its sensor only after the first step and
/// not after the last. That is assumed of the first or last rows if no run has a reading there although there are readings
/// elsewhere; if chance made it so, only that one row per run is lost.
fn unpolled_rows(logs: &Logs) -> impl Fn(&Run, usize) -> bool {
    let last = |run: &Run| run.rows.len() - 1;
    let has_readings = logs.runs.iter().flat_map(|run| &run.rows).any(|row| row.echo_cm.is_some());
    let is_silent =
        |at: fn(&Run) -> usize| has_readings && logs.runs.iter().all(|run| run.rows.at(at(run)).echo_cm.is_none());
    let (first_is_silent, last_is_silent) = (is_silent(|_| 0), is_silent(last));
    move |run, row| (first_is_silent && row == 0) || (last_is_silent && row == last(run))
}

/// Returns the number of blocks per run: one if there are enough runs and they are short.
fn parts_per_run(logs: &Logs) -> usize {
    let runs = logs.runs.len();
    let rows = logs.rows();
    let is_one = runs >= FEWEST_BLOCKS && rows <= runs * LONGEST_RUN;
    if is_one { 1 } else { FEWEST_BLOCKS.div_ceil(runs).max(rows / runs / LONGEST_BLOCK) }
}

/// Numbers the places of rows in the order in which they are visited. Returns the number of places.
pub fn number_places(rows: &mut [Observation]) -> usize {
    let mut known: BTreeMap<Place, usize> = BTreeMap::new();
    for row in rows.iter_mut() {
        let StepContext { robot, pose, .. } = row.context;
        let next = known.len();
        row.place = *known.entry(place_of(&robot.sensor_pose(&pose))).or_insert(next);
    }
    known.len()
}

/// Returns the context of every row at which the robot was tracked.
fn contexts(run: &Run, surroundings: &Surroundings) -> Vec<Option<StepContext>> {
    let mut history = RunHistory::default();
    let begin_ms = run.rows.at(0).t_ms;
    let context = |(k, row): (usize, Row)| {
        history.command_of(&run.rows, k);
        let context = row.pose.map(|pose| surroundings.context(&history, row.t_ms - begin_ms, pose));
        history.leave(context.as_ref(), row.echo_cm);
        context
    };
    run.rows.iter().enumerate().map(context).collect()
}

/// Returns whether the robot was never tracked, but measured its own motion.
pub fn is_untracked(logs: &Logs) -> bool {
    let rows = || logs.runs.iter().flat_map(|run| &run.rows);
    let measures_itself = |row: &Row| row.gyro_deg_s.is_some() || row.rot_left_deg.and(row.rot_right_deg).is_some();
    rows().all(|row| row.pose.is_none()) && rows().any(|row| measures_itself(&row))
}

/// Returns the contexts of all rows of a robot that was never tracked, at dead-reckoned poses; what its sensor faced is unknown.
fn reckoned_contexts(run: &Run, surroundings: &Surroundings) -> Vec<Option<StepContext>> {
    let mut history = RunHistory::default();
    let begin_ms = run.rows.at(0).t_ms;
    let poses = dead_reckoning::poses(&surroundings.robot, run);
    let context = |(k, (row, pose)): (usize, (Row, Pose))| {
        history.command_of(&run.rows, k);
        let context = surroundings.unseen(&history, row.t_ms - begin_ms, pose);
        history.leave(Some(&context), row.echo_cm);
        Some(context)
    };
    run.rows.iter().zip(poses).enumerate().map(context).collect()
}

/// Returns the turn of a step at the yaw rate at a row; `None` where the commands that led to it are unknown.
fn gyro_rad(logs: &Logs, run: &Run, row: usize) -> Option<f64> {
    let rate = run.rows.at(row).gyro_deg_s?;
    let step_ms = logs.robot.step_ms;
    let follows_gap = samples::follows_gap(step_ms, run, row) || row > 0 && samples::follows_gap(step_ms, run, row - 1);
    (!follows_gap).then_some(rate.to_radians() * step_ms / 1000.0)
}

/// Returns the contexts of rows at which the robot was not tracked, with its last tracked pose.
fn untracked(run: &Run, rows: Range<usize>, last_tracked: &StepContext) -> Vec<StepContext> {
    let mut commands = last_tracked.commands;
    let context = |i: usize| {
        commands.rotate_right(1);
        commands[0] = run.rows.at(i).command();
        let elapsed_min = (run.rows.at(i).t_ms - run.rows.at(0).t_ms) / 60_000.0;
        StepContext { elapsed_min, commands, pieces: Pieces::of(&run.rows, i), ..*last_tracked }
    };
    rows.map(context).collect()
}
