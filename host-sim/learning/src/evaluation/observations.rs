//! What logs say, row by row, in the form that predictions are compared with.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use mindgap_foundations::geometry::{Pose, first_hit};
use mindgap_foundations::motion::Motion;
use mindgap_logs::samples::{self, MotionSample};
use mindgap_logs::{Logs, Run};
use mindgap_models::effects::StepContext;
use mindgap_models::effects::context::{RunHistory, Surroundings};
use mindgap_models::simulator::baseline::MotionModel;
use mindgap_models::sonar::familiar::{FamiliarPoses, PoseMemory};
use mindgap_models::sonar::place::{Place, place_of};
use mindgap_models::sonar::{SensorLaw, View};

/// A folder of logs, ready to be judged.
pub struct Observations {
    /// The robot, and the walls round it.
    pub surroundings: Surroundings,
    /// The law of the sensor; none where it is not judged.
    pub law: Option<SensorLaw>,
    /// What is known of single poses in this room.
    pub recollection: Option<Arc<PoseMemory>>,
    /// How many blocks of rows are judged together: the runs, or parts of them where there are few.
    pub blocks: usize,
    /// How many places its sensor was at.
    pub places: usize,
    /// All rows with a pose.
    pub rows: Vec<Observation>,
}

/// A row at which the tracker saw the robot.
#[derive(Clone)]
pub struct Observation {
    /// Which run of the folder,
    pub run: usize,
    /// and which row of that.
    pub at: usize,
    /// Which block.
    pub block: usize,
    /// Which place of the sensor: nearby poses, at which it hears much the same.
    pub place: usize,
    /// Which rows what its step leaves is foretold together with: of its block, or of runs under the same commands.
    pub fold: usize,
    /// How much the way forward, the way to the left and the turn of its step count among others that repeat them.
    pub motion_weight: [f64; 3],
    /// How much its echo or none, and its reading, count among others that repeat it.
    pub echo_weight: [f64; 2],
    /// Length of the step that begins here, against the usual one.
    pub stretch: f64,
    /// What effects may look at.
    pub context: StepContext,
    /// What effects may look at in the steps until the tracker saw the robot again, where these are judged as one; their
    /// poses are not known.
    pub then: Vec<StepContext>,
    /// What the step did, or those that are judged as one, where their end was seen too.
    pub motion: Option<Motion<f64>>,
    /// What the simulator expects of the commands as logged, once [`Observations::expect`] has asked it.
    pub expected: Option<Motion<f64>>,
    /// What the sensor said.
    pub echo_cm: Option<f64>,
    /// What the law of the sensor looks at from here if nothing is changed.
    pub view: Option<View>,
    /// How far rays reach that lie to the right and to the left of the sensor's axis, cm.
    pub beside_cm: [f64; 2],
}

/// Angle between those rays and the axis, degrees.
const BESIDE_DEG: f64 = 5.0;

/// With fewer runs than this each is cut into parts, so that there is a scatter between blocks.
pub const FEWEST_BLOCKS: usize = 8;
/// Parts of long runs have about this many rows: a minute of steps of 400 ms.
const LONGEST_BLOCK: usize = 150;
/// Longer runs than two of those are cut however many there are: of all rows a few thousand count, and those of two runs say
/// less than those of parts of all.
const LONGEST_RUN: usize = 2 * LONGEST_BLOCK;

impl Observations {
    /// Takes all that counts out of logs, for a sensor that follows a law.
    pub fn of(logs: &Logs, law: Option<&SensorLaw>) -> Self {
        let surroundings = Surroundings::new(&logs.robot, &logs.scene);
        let steps = samples::motion(logs);
        // Where no step has a pose at both ends, whole ways between poses are judged.
        let whole_ways = steps.is_empty();
        let mut steps = steps.iter().peekable();
        let mut rows = Vec::new();
        let parts = parts_of_a_run(logs);
        let unread_ends = unread_ends(logs);
        for (run, logged) in logs.runs.iter().enumerate() {
            let contexts = contexts(logged, &surroundings);
            for (k, (row, context)) in logged.rows.iter().zip(&contexts).enumerate() {
                let (Some(pose), Some(context)) = (row.pose, context) else { continue };
                let step = steps.next_if(|s| (s.run, s.row) == (run, k));
                let motion = step.map(MotionSample::motion);
                let until = (k + 1..logged.rows.len()).find(|i| logged.rows.at(*i).pose.is_some());
                let way_until = until.filter(|_| whole_ways);
                let motion = motion.or_else(|| Some(Motion::between(&pose, &logged.rows.at(way_until?).pose?)));
                let until_ms = logged.rows.get(k + 1).map_or(row.t_ms, |next| next.t_ms);
                let block = run * parts + k * parts / logged.rows.len();
                rows.push(Observation {
                    run,
                    at: k,
                    block,
                    place: 0,
                    fold: block,
                    motion_weight: [1.0; 3],
                    echo_weight: if unread_ends(logged, k) { [0.0; 2] } else { [1.0; 2] },
                    stretch: (until_ms - row.t_ms) / logs.robot.step_ms,
                    context: *context,
                    then: way_until.map_or_else(Vec::new, |until| unseen(logged, k + 1..until, context)),
                    motion,
                    expected: None,
                    echo_cm: row.echo_cm,
                    view: law.map(|law| law.view(&surroundings.surfaces, &surroundings.sensor(&pose, 0.0), 1.0)),
                    beside_cm: beside_cm(&surroundings, &pose),
                });
            }
        }
        let places = number_places(&mut rows);
        let blocks = logs.runs.len() * parts;
        Observations { surroundings, law: law.cloned(), recollection: None, blocks, places, rows }
    }

    /// Recalls what is known of single poses, if this is their room.
    pub fn recalling(self, familiar: Option<&FamiliarPoses>) -> Self {
        let recollection =
            familiar.and_then(|familiar| PoseMemory::for_room(familiar, self.surroundings.surfaces.walls()));
        Observations { recollection: recollection.map(Arc::new), ..self }
    }

    /// Two parts of these: the blocks whose role is false, and those whose role is true; a block without a role is dropped.
    pub fn split(self, roles: &[Option<bool>]) -> [Self; 2] {
        let Observations { surroundings, law, recollection, places, rows, .. } = self;
        let mut parts = [false, true].map(|role| Observations {
            surroundings: surroundings.clone(),
            law: law.clone(),
            recollection: recollection.clone(),
            places,
            blocks: roles.iter().filter(|r| **r == Some(role)).count(),
            rows: Vec::new(),
        });
        let mut counts = [0; 2];
        let numbers: Vec<Option<(usize, usize)>> = roles
            .iter()
            .map(|role| {
                let part = usize::from((*role)?);
                counts[part] += 1;
                Some((part, counts[part] - 1))
            })
            .collect();
        for row in rows {
            if let Some((part, block)) = numbers[row.block] {
                parts[part].rows.push(Observation { block, fold: block, ..row });
            }
        }
        parts
    }

    /// Every so many rows of these, the first one first.
    pub fn every(&self, step: usize) -> Self {
        let Observations { surroundings, law, recollection, blocks, places, rows } = self;
        Observations {
            surroundings: surroundings.clone(),
            law: law.clone(),
            recollection: recollection.clone(),
            blocks: *blocks,
            places: *places,
            rows: rows.iter().step_by(step).cloned().collect(),
        }
    }

    /// Asks the simulator once what it expects of every row: most hypotheses leave the commands as they are.
    pub fn expect(mut self, drive: Option<&MotionModel>) -> Self {
        for row in &mut self.rows {
            let [now, before, ..] = row.context.commands;
            row.expected = drive.map(|drive| drive.step(now, before));
        }
        self
    }

    /// The rows of a block.
    pub fn of_block(&self, block: usize) -> Range<usize> {
        let begin = self.rows.partition_point(|row| row.block < block);
        begin..self.rows.partition_point(|row| row.block <= block)
    }

    /// Sums a number of each row by block.
    pub fn by_block(&self, terms: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.blocks];
        self.rows.iter().zip(terms).for_each(|(row, t)| sums[row.block] += t);
        sums
    }

    /// Sums a number of each row by place.
    pub fn by_place(&self, terms: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.places];
        self.rows.iter().zip(terms).for_each(|(row, t)| sums[row.place] += t);
        sums
    }

    /// The largest wheel speed that is commanded, cm/s.
    pub fn top_speed_cm_s(&self) -> f64 {
        let speeds =
            self.rows.iter().flat_map(|row| row.context.commands[0].map(|c| row.context.wheel_speed_cm_s(c).abs()));
        speeds.fold(0.0, f64::max)
    }
}

/// How far rays beside the axis of the sensor of a robot at a pose reach.
pub fn beside_cm(surroundings: &Surroundings, robot: &Pose) -> [f64; 2] {
    [-BESIDE_DEG, BESIDE_DEG].map(|deg| {
        let ray = surroundings.sensor(robot, deg.to_radians());
        let met = first_hit(surroundings.surfaces.walls(), ray.position_cm, ray.direction());
        met.map_or(f64::INFINITY, |(met_cm, _)| met_cm)
    })
}

/// Which rows nobody read the sensor at: a controller looks once it has driven a step, and no more when it has stopped. So it
/// is where no run at all has a reading in its first row, or in its last, though there are others; and what is left out where
/// chance made it so is no more than that one row of each.
fn unread_ends(logs: &Logs) -> impl Fn(&Run, usize) -> bool {
    let last = |run: &Run| run.rows.len() - 1;
    let is_read = logs.runs.iter().flat_map(|run| &run.rows).any(|row| row.echo_cm.is_some());
    let is_unread =
        |at: fn(&Run) -> usize| is_read && logs.runs.iter().all(|run| run.rows.at(at(run)).echo_cm.is_none());
    let (first_is_unread, last_is_unread) = (is_unread(|_| 0), is_unread(last));
    move |run, row| (first_is_unread && row == 0) || (last_is_unread && row == last(run))
}

/// Into how many blocks a run is cut: one where there are enough runs that are short enough.
fn parts_of_a_run(logs: &Logs) -> usize {
    let runs = logs.runs.len();
    let rows = logs.rows();
    let is_one = runs >= FEWEST_BLOCKS && rows <= runs * LONGEST_RUN;
    if is_one { 1 } else { FEWEST_BLOCKS.div_ceil(runs).max(rows / runs / LONGEST_BLOCK) }
}

/// Numbers the places of rows in the order in which they are visited, and returns how many there are.
pub fn number_places(rows: &mut [Observation]) -> usize {
    let mut known: BTreeMap<Place, usize> = BTreeMap::new();
    for row in rows.iter_mut() {
        let StepContext { robot, pose, .. } = row.context;
        let next = known.len();
        row.place = *known.entry(place_of(&robot.sensor_pose(&pose))).or_insert(next);
    }
    known.len()
}

/// The context of every row at which the robot was seen.
fn contexts(run: &Run, surroundings: &Surroundings) -> Vec<Option<StepContext>> {
    let mut history = RunHistory::default();
    let begin_ms = run.rows.at(0).t_ms;
    let context = |row: mindgap_logs::Row| {
        history.command(row.command());
        let context = row.pose.map(|pose| surroundings.context(&history, row.t_ms - begin_ms, pose));
        history.leave(context.as_ref(), row.echo_cm);
        context
    };
    run.rows.iter().map(context).collect()
}

/// The contexts of rows at which the robot was not seen, as if it had stayed where it was seen last.
fn unseen(run: &Run, rows: Range<usize>, seen: &StepContext) -> Vec<StepContext> {
    let mut commands = seen.commands;
    let context = |i: usize| {
        commands.rotate_right(1);
        commands[0] = run.rows.at(i).command();
        let elapsed_min = (run.rows.at(i).t_ms - run.rows.at(0).t_ms) / 60_000.0;
        StepContext { elapsed_min, commands, ..*seen }
    };
    rows.map(context).collect()
}
