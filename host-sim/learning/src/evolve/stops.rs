//! Where a command ends that is held, for every threshold at once: runs that hold it until something is touched show where
//! each threshold would have ended it.

use glam::DVec2;
use mindgap_core::controller::{Controller, Tuple, When};

use super::task::EvolutionTask;
use mindgap_foundations::chance::derive;
use mindgap_models::simulator::motion::MotionTable;
use mindgap_models::simulator::rollout::{REACHED_CM, RolloutRequest, Termination, TrajectoryPoint};

/// Thresholds lie this far apart, cm: about the scatter of a reading.
const APART_CM: usize = 4;
/// No reading is larger, and thus none ends a tuple.
const NEVER: Tuple = Tuple { left: 0, right: 0, when: When::Larger, threshold_cm: 255 };
/// Any reading ends this one, and without one the robot stays where it is.
const REST: Tuple = Tuple { left: 0, right: 0, when: When::Larger, threshold_cm: 0 };

/// Where the first tuples of a controller lead with one threshold of the last.
pub struct Stop {
    /// The last tuple with its threshold.
    pub tuple: Tuple,
    /// Mean place where it ends, cm.
    pub place_cm: DVec2,
    /// Mean heading there, rad.
    pub heading_rad: f64,
    /// Root mean square distance from the mean place, cm.
    pub scatter_cm: f64,
    /// The same of the heading, rad.
    pub heading_scatter_rad: f64,
    /// Share of runs that do not get there: they touch something, or the tuple does not end. The rest is of the others.
    pub lost: f64,
    /// Share of all runs that reach the target.
    pub reached: f64,
    /// Mean of what ending there is worth to all runs: the radius of the target over the way to it, at most 1.
    pub nearness: f64,
}

/// What a run shows that holds the last tuple.
#[derive(Default)]
struct Path {
    steps: usize,
    /// The steps whose readings are larger or smaller than all before: others end no tuple that has not ended.
    steps_to_end: Vec<Step>,
    range_cm: Option<[f32; 2]>,
}

/// Where a run is after a step of the last tuple.
struct Step {
    number: usize,
    place_cm: DVec2,
    heading: DVec2,
    echo_cm: f32,
    nearness: f64,
    reaches: bool,
}

/// The whole controller of its first tuples: after them it rests.
pub fn controller(task: &EvolutionTask, first: &[Tuple]) -> Controller {
    task.decoder.with_tuples(std::array::from_fn(|i| first.get(i).copied().unwrap_or(REST)))
}

/// For each of some beginnings of controllers, of a tuple at least, the thresholds of its last tuple that end it at different
/// places, in as many runs. Fewer than half of the runs tell nothing of a place.
pub fn stops(task: &EvolutionTask, beginnings: &[&[Tuple]], runs: usize, seed: u64) -> Vec<Vec<Stop>> {
    let held: Vec<Controller> = beginnings.iter().map(|first| holding(task, first)).collect();
    let motions: Vec<MotionTable> = held.iter().map(|controller| task.environment.motions(controller)).collect();
    let request = |number: usize| RolloutRequest {
        controller: &held[number / runs],
        motions: &motions[number / runs],
        seed: derive(seed, &[number as u64]),
    };
    let requests: Vec<RolloutRequest> = (0..runs * held.len()).map(request).collect();
    let mut paths: Vec<Path> = requests.iter().map(|_| Path::default()).collect();
    // The step that ends the tuple before is not one of the last.
    let mut has_begun: Vec<bool> = (0..requests.len()).map(|number| beginnings[number / runs].len() == 1).collect();
    let outcomes = task.environment.run_watched(&requests, |number, point| {
        if has_begun[number] {
            paths[number].go_on(&point, task);
        }
        has_begun[number] |= point.tuple + 1 == beginnings[number / runs].len();
    });
    for (path, outcome) in paths.iter_mut().zip(&outcomes) {
        if outcome.termination == Termination::Crashed {
            path.take_back();
        }
    }
    let [low, high] = task.decoder.thresholds_cm.map(|cm| cm as i16);
    let thresholds: Vec<i16> = (low..=high).step_by(APART_CM).collect();
    let of_each = paths.chunks(runs).zip(beginnings);
    of_each.map(|(paths, first)| of_paths(paths, first[first.len() - 1], &thresholds)).collect()
}

/// The controller that holds the last of its first tuples.
fn holding(task: &EvolutionTask, first: &[Tuple]) -> Controller {
    let mut whole = controller(task, first);
    let last = &mut whole.tuples[first.len() - 1];
    *last = Tuple { left: last.left, right: last.right, ..NEVER };
    whole
}

/// Where these runs that hold a tuple would end with each of the thresholds.
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

/// The first step whose reading is beyond each threshold; these rise.
fn first_beyond(path: &Path, when: When, thresholds: &[i16]) -> Vec<Option<usize>> {
    let mut first = vec![None; thresholds.len()];
    // Those that were passed are the lowest or the highest.
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
    fn go_on(&mut self, point: &TrajectoryPoint, task: &EvolutionTask) {
        self.steps += 1;
        let Some(echo_cm) = point.echo_cm else { return };
        let [smallest_cm, largest_cm] = self.range_cm.unwrap_or([f32::INFINITY, f32::NEG_INFINITY]);
        if echo_cm < smallest_cm || echo_cm > largest_cm {
            self.range_cm = Some([smallest_cm.min(echo_cm), largest_cm.max(echo_cm)]);
            self.steps_to_end.push(Step::of(self.steps, echo_cm, point, task));
        }
    }

    /// Takes back the last step, which touched something.
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
            nearness: REACHED_CM / task.way.cm(place_cm).max(REACHED_CM),
            reaches: place_cm.distance(task.target_cm) <= REACHED_CM,
        }
    }
}

impl Stop {
    /// Of the step in which each run ends.
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
            // Of a normal distribution wrapped round the circle (Mardia and Jupp 2000, section 3.4).
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
    use mindgap_foundations::chance::generator;

    const SEED: u64 = 5;
    const RUNS: usize = 8;

    /// Where the runs of a controller end that are not lost, with the seeds of a single beginning.
    fn ends(task: &EvolutionTask, controller: &Controller) -> Vec<DVec2> {
        let motions = &task.environment.motions(controller);
        let request = |run: usize| RolloutRequest { controller, motions, seed: derive(SEED, &[run as u64]) };
        let outcomes = task.environment.run(&(0..RUNS).map(request).collect::<Vec<_>>());
        let finished = outcomes.iter().filter(|outcome| outcome.termination == Termination::Finished);
        finished.map(|outcome| outcome.end_cm).collect()
    }

    /// With a threshold, the same runs end where that is foretold.
    #[test]
    fn thresholds_end_a_command_where_runs_that_hold_it_say() {
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
    fn a_beginning_is_a_controller_that_then_rests() {
        with_task(|task| {
            let tuple = Tuple { left: 40, right: 50, when: When::Larger, threshold_cm: 60 };
            let whole = controller(task, &[tuple, tuple]);
            assert_eq!(whole.tuples, [tuple, tuple, REST, REST, REST, REST]);
            assert_eq!(whole.check(), Ok(()));
        });
    }
}
