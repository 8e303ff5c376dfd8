//! Where a held command ends, for every threshold at once: runs that hold it until they touch something show where each
//! threshold would have ended it.

use glam::DVec2;
use mindgap_core::controller::{Controller, Tuple, When};

use super::task::EvolutionTask;
use mindgap_foundations::random::derive;
use mindgap_logs::Termination;
use mindgap_models::simulator::motion::MotionTable;
use mindgap_models::simulator::rollout::{REACHED_CM, RolloutRequest, TrajectoryPoint};

/// Spacing of thresholds, cm: about the scatter of a reading.
const APART_CM: usize = 4;
/// A tuple that no reading ends.
const NEVER: Tuple = Tuple { left: 0, right: 0, when: When::Larger, threshold_cm: 255 };
/// A tuple that any reading ends; without a reading the robot stays where it is.
const REST: Tuple = Tuple { left: 0, right: 0, when: When::Larger, threshold_cm: 0 };

/// Where the first tuples of a controller lead with one threshold of the last.
pub struct Stop {
    /// The last tuple with its threshold.
    pub tuple: Tuple,
    /// Mean position at which it ends, cm.
    pub place_cm: DVec2,
    /// Mean heading there, rad.
    pub heading_rad: f64,
    /// Root-mean-square distance from the mean position, cm.
    pub scatter_cm: f64,
    /// Circular standard deviation of the heading, rad.
    pub heading_scatter_rad: f64,
    /// Share of runs that are lost: they touch something, or the tuple does not end. Means and scatter are over the others.
    pub lost: f64,
    /// Share of all runs that reach the target.
    pub reached: f64,
    /// Nearness to the target, averaged over all runs: the target radius divided by the length of the route, at most 1.
    pub nearness: f64,
}

/// The record of a run that holds the last tuple.
#[derive(Default)]
struct Path {
    steps: usize,
    /// The steps whose readings are larger or smaller than all before; only these can end a tuple.
    steps_to_end: Vec<Step>,
    range_cm: Option<[f32; 2]>,
}

/// The state of a run after a step of the last tuple.
struct Step {
    number: usize,
    place_cm: DVec2,
    heading: DVec2,
    echo_cm: f32,
    nearness: f64,
    reaches: bool,
}

/// Completes the first tuples to a controller that rests after them.
pub fn controller(task: &EvolutionTask, first: &[Tuple]) -> Controller {
    task.decoder.with_tuples(std::array::from_fn(|i| first.get(i).copied().unwrap_or(REST)))
}

/// Returns for each prefix of a controller the stops of its last tuple: one for every threshold that ends it at other places
/// than the threshold before, from `runs` runs. A threshold that ends fewer than half of the runs has no stop. A prefix must
/// have at least one tuple.
pub fn stops(task: &EvolutionTask, prefixes: &[&[Tuple]], runs: usize, seed: u64) -> Vec<Vec<Stop>> {
    let held: Vec<Controller> = prefixes.iter().map(|first| holding(task, first)).collect();
    let motions: Vec<MotionTable> = held.iter().map(|controller| task.environment.motions(controller)).collect();
    let request = |number: usize| RolloutRequest {
        controller: &held[number / runs],
        motions: &motions[number / runs],
        seed: derive(seed, &[number as u64]),
    };
    let requests: Vec<RolloutRequest> = (0..runs * held.len()).map(request).collect();
    let mut paths: Vec<Path> = requests.iter().map(|_| Path::default()).collect();
    // The step that ends the tuple before does not belong to the last tuple.
    let mut has_begun: Vec<bool> = (0..requests.len()).map(|number| prefixes[number / runs].len() == 1).collect();
    let outcomes = task.environment.run_watched(&requests, |number, point| {
        if has_begun[number] {
            paths[number].record(&point, task);
        }
        has_begun[number] |= point.tuple + 1 == prefixes[number / runs].len();
    });
    for (path, outcome) in paths.iter_mut().zip(&outcomes) {
        if outcome.termination == Termination::Crashed {
            path.take_back();
        }
    }
    let [low, high] = task.decoder.thresholds_cm.map(|cm| cm as i16);
    let thresholds: Vec<i16> = (low..=high).step_by(APART_CM).collect();
    let of_each = paths.chunks(runs).zip(prefixes);
    of_each.map(|(paths, first)| of_paths(paths, first[first.len() - 1], &thresholds)).collect()
}

/// Returns the controller that holds the last of its first tuples.
fn holding(task: &EvolutionTask, first: &[Tuple]) -> Controller {
    let mut whole = controller(task, first);
    let last = &mut whole.tuples[first.len() - 1];
    *last = Tuple { left: last.left, right: last.right, ..NEVER };
    whole
}

/// Returns the stops of runs that hold a tuple, for each of the thresholds.
fn of_paths(paths: &[Path], tuple: Tuple, thresholds: &[i16]) -> Vec<Stop> {
    let mut stops = Vec::new();
    for when in [When::Larger, When::Smaller] {
        let ends: Vec<Vec<Option<usize>>> = paths.iter().map(|path| first_beyond(path, when, thresholds)).collect();
        let mut before = Vec::new();
        for (at, threshold_cm) in thresholds.iter().enumerate() {
            let ends: Vec<Option<usize>> = ends.iter().map(|ends| ends[at]).collect();
            if ends != before {
                let tuple = Tuple { when, threshold_cm: *threshold_cm, ..tuple };
                stops.extend(Stop::of(tuple, paths, &ends));
                before = ends;
            }
        }
    }
    stops
}

/// Returns for each threshold the first step whose reading is beyond it; thresholds must be ascending.
fn first_beyond(path: &Path, when: When, thresholds: &[i16]) -> Vec<Option<usize>> {
    let mut first = vec![None; thresholds.len()];
    // The thresholds that were passed are the lowest or the highest ones.
    let mut waiting: Vec<usize> = (0..thresholds.len()).collect();
    if when == When::Larger {
        waiting.reverse();
    }
    for (number, step) in path.steps_to_end.iter().enumerate() {
        let is_beyond = |at: &usize| Tuple { when, threshold_cm: thresholds[*at], ..NEVER }.ends_at(step.echo_cm);
        while let Some(at) = waiting.pop_if(|at| is_beyond(at)) {
            first[at] = Some(number);
        }
    }
    first
}

impl Path {
    fn record(&mut self, point: &TrajectoryPoint, task: &EvolutionTask) {
        self.steps += 1;
        let Some(echo_cm) = point.echo_cm else { return };
        let [smallest_cm, largest_cm] = self.range_cm.unwrap_or([f32::INFINITY, f32::NEG_INFINITY]);
        if echo_cm < smallest_cm || echo_cm > largest_cm {
            self.range_cm = Some([smallest_cm.min(echo_cm), largest_cm.max(echo_cm)]);
            self.steps_to_end.push(Step::of(self.steps, echo_cm, point, task));
        }
    }

    /// Removes the last step, which touched something.
    fn take_back(&mut self) {
        self.steps_to_end.pop_if(|step| step.number == self.steps);
    }
}

impl Step {
    fn of(number: usize, echo_cm: f32, point: &TrajectoryPoint, task: &EvolutionTask) -> Self {
        let place_cm = point.pose.position_cm;
        Step {
            number,
            place_cm,
            heading: DVec2::from_angle(point.pose.heading_rad),
            echo_cm,
            nearness: REACHED_CM / task.routes.length_cm(place_cm).max(REACHED_CM),
            reaches: place_cm.distance(task.target_cm) <= REACHED_CM,
        }
    }
}

impl Stop {
    /// Summarises the steps in which the runs end; `None` if fewer than half of them end.
    fn of(tuple: Tuple, paths: &[Path], ends: &[Option<usize>]) -> Option<Self> {
        let ended: Vec<&Step> =
            paths.iter().zip(ends).filter_map(|(path, end)| Some(&path.steps_to_end[(*end)?])).collect();
        if 2 * ended.len() < paths.len() {
            return None;
        }
        let (runs, count) = (paths.len() as f64, ended.len() as f64);
        let place_cm = ended.iter().map(|step| step.place_cm).sum::<DVec2>() / count;
        let heading = ended.iter().map(|step| step.heading).sum::<DVec2>() / count;
        let variance = ended.iter().map(|step| step.place_cm.distance_squared(place_cm)).sum::<f64>() / count;
        Some(Stop {
            tuple,
            place_cm,
            heading_rad: heading.to_angle(),
            scatter_cm: variance.sqrt(),
            // Wrapped normal distribution (Mardia and Jupp 2000, section 3.4).
            heading_scatter_rad: (-2.0 * libm::log(heading.length().clamp(f64::EPSILON, 1.0))).sqrt(),
            lost: 1.0 - count / runs,
            reached: ended.iter().filter(|step| step.reaches).count() as f64 / runs,
            nearness: ended.iter().map(|step| step.nearness).sum::<f64>() / runs,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evolve::test_support::with_task;
    use mindgap_foundations::random::generator;

    const SEED: u64 = 5;
    const RUNS: usize = 8;

    /// Returns where the runs of a controller end that are not lost, with the seeds of a single prefix.
    fn ends(task: &EvolutionTask, controller: &Controller) -> Vec<DVec2> {
        let motions = &task.environment.motions(controller);
        let request = |run: usize| RolloutRequest { controller, motions, seed: derive(SEED, &[run as u64]) };
        let outcomes = task.environment.run(&(0..RUNS).map(request).collect::<Vec<_>>());
        let finished = outcomes.iter().filter(|outcome| outcome.termination == Termination::Finished);
        finished.map(|outcome| outcome.end_cm).collect()
    }

    /// With a threshold, the same runs end where the held runs predict.
    #[test]
    fn stops_are_where_runs_with_that_threshold_end() {
        with_task(|task| {
            let mut compared = 0;
            for number in 0..200 {
                let drawn = task.decoder.controller(&task.decoder.random(&mut generator(SEED, &[number])));
                // Turns that end at once, so that six tuples do not mostly end at a wall.
                let turn = Tuple { left: 20, right: -20, when: When::Larger, threshold_cm: 0 };
                let tuples = [turn, turn, turn, turn, turn, drawn.tuples[0]];
                for stop in &stops(task, &[&tuples], RUNS, SEED)[0] {
                    let tuples = [turn, turn, turn, turn, turn, stop.tuple];
                    let ends = ends(task, &Controller { tuples, ..drawn });
                    let count = ends.len() as f64;
                    assert!((stop.lost - (1.0 - count / RUNS as f64)).abs() < 1e-9, "{:?}", stop.tuple);
                    assert!(stop.place_cm.distance(ends.iter().sum::<DVec2>() / count) < 1e-9, "{:?}", stop.tuple);
                    compared += 1;
                }
            }
            assert!(compared > 500, "{compared}");
        });
    }

    #[test]
    fn prefix_is_completed_by_rest() {
        with_task(|task| {
            let tuple = Tuple { left: 40, right: 50, when: When::Larger, threshold_cm: 60 };
            let whole = controller(task, &[tuple, tuple]);
            assert_eq!(whole.tuples, [tuple, tuple, REST, REST, REST, REST]);
            assert_eq!(whole.check(), Ok(()));
        });
    }
}
