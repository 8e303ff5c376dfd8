//! Effective weights of steps and readings that repeat each other (design effect).
//!
//! If m rows at a place share the fraction ρ of their variance, each of them carries 1/(1 + (m − 1) ρ) of the information of a
//! single row, the design effect of clusters (Kish 1965, Survey Sampling). The shared part counts twice where rows are compared
//! with a simulator, since the simulator was learned in a room with a shared part of its own. At poses that are known from the
//! training room, only what earlier readings leave open is shared. Equal readings of an unmoved sensor count as one.
//!
//! A simulator makes the same error in every step under the same commands. Its training logs tell the size of that error; over
//! the noise of a step it is the fraction that these steps share. A controller that holds a command for thirty steps says
//! hardly more about the robot than one that holds it for ten. Runs of one controller all repeat the simulator's error, so one
//! of them predicts the residuals of the others. Only what runs under other commands predict is a property of the robot.

use std::collections::{BTreeMap, BTreeSet};

use super::observations::{Observation, Observations};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::ensemble::evidence::cell;

/// Number of rooms with a shared part: the room of the logs, and the one in which the simulator was learned.
const ROOMS: f64 = 2.0;
/// A sensor that moved by less than this counts as unmoved: a tracker cannot tell.
const UNMOVED_CM: f64 = 1.0;
const UNMOVED_DEG: f64 = 2.0;

/// A run repeats another one if it shares this fraction of its steps. Runs of one controller end some tuples earlier or later;
/// runs under random commands share hardly any step.
const MOSTLY: f64 = 0.5;

/// Commands now and before, rounded to cells within which commands count as the same.
type Cells = [[i32; 2]; 2];

/// Weights every row by what the simulator knows of its own error and of the variance that belongs to places.
pub fn weighted(mut observations: Observations, baseline: &Baseline) -> Observations {
    if let Some(motion) = baseline.motion.as_ref().filter(|motion| motion.is_learned()) {
        let cells = |row: &Observation| row.commands().map(|command| cell(motion.percent(command)));
        weight_motion(&mut observations.rows, motion.scatter().into_array(), cells, |now, before| {
            motion.own_error(now, before).into_array()
        });
        fold_together(&mut observations.rows, cells);
    }
    weight_echoes(&mut observations, baseline.place_bound);
    observations
}

/// Weights steps that repeat others of the same cells. `own_error` returns the mean squares of the error that the simulator
/// makes in all of them.
fn weight_motion(
    rows: &mut [Observation],
    noise: [f64; 3],
    cells: impl Fn(&Observation) -> Cells,
    own_error: impl Fn([f64; 2], [f64; 2]) -> [f64; 3],
) {
    let mut repeated: BTreeMap<Cells, Vec<usize>> = BTreeMap::new();
    for (i, row) in rows.iter().enumerate().filter(|(_, row)| row.motion.is_some() && row.following_steps.is_empty()) {
        repeated.entry(cells(row)).or_default().push(i);
    }
    for steps in repeated.into_values().filter(|steps| steps.len() > 1) {
        let [now, before] = rows[steps[0]].commands();
        let (own_error, others) = (own_error(now, before), (steps.len() - 1) as f64);
        let weight = [0, 1, 2].map(|i| 1.0 / (1.0 + others * own_error[i] / (noise[i] * noise[i])));
        steps.into_iter().for_each(|i| rows[i].motion_weight = weight);
    }
}

/// Joins runs that share most of their cells in one fold, unless that would leave a single fold.
fn fold_together(rows: &mut [Observation], cells: impl Fn(&Observation) -> Cells) {
    let mut steps: BTreeMap<usize, BTreeSet<Cells>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.motion.is_some()) {
        steps.entry(row.run).or_default().insert(cells(row));
    }
    let repeats = |one: &BTreeSet<_>, other: &BTreeSet<_>| {
        one.intersection(other).count() as f64 >= MOSTLY * one.len().min(other.len()) as f64
    };
    // Each run joins the group of the first run that it repeats.
    let mut groups: BTreeMap<usize, usize> = BTreeMap::new();
    for (run, of_run) in &steps {
        let first = steps.range(..run).find(|(_, of_other)| repeats(of_run, of_other));
        let group = first.map_or(*run, |(other, _)| groups[other]);
        groups.insert(*run, group);
    }
    let found: BTreeSet<usize> = groups.values().copied().collect();
    if found.len() == 1 || found.len() == groups.len() {
        return;
    }
    let number = |run: &usize| groups.get(run).map_or(0, |group| found.range(..group).count());
    rows.iter_mut().for_each(|row| row.fold = number(&row.run));
}

/// Weights echo rate and echo value; `place_bound` are the fractions of their variance that belong to the place.
fn weight_echoes(observations: &mut Observations, place_bound: [f64; 2]) {
    let Observations { places, rows, recollection, surroundings, .. } = observations;
    let mut counts = vec![[0.0; 2]; *places];
    for row in rows.iter() {
        counts[row.place][0] += 1.0;
        counts[row.place][1] += f64::from(u8::from(row.echo_cm.is_some()));
    }
    for row in rows.iter_mut() {
        let others = counts[row.place].map(|rows| (rows - 1.0).max(0.0));
        let recalled = recollection.as_ref().filter(|r| r.at(&surroundings.sensor(&row.context.pose, 0.0)).is_some());
        let shared = recalled.map_or(place_bound.map(|share| ROOMS * share), |recollection| recollection.left_share);
        [0, 1].into_iter().for_each(|i| row.echo_weight[i] /= 1.0 + others[i] * shared[i]);
    }
    let mut begin = 0;
    for end in 1..=rows.len() {
        if end == rows.len() || !repeats(&rows[begin], &rows[end]) {
            let share = 1.0 / (end - begin) as f64;
            rows[begin..end].iter_mut().for_each(|row| row.echo_weight = row.echo_weight.map(|weight| share * weight));
            begin = end;
        }
    }
}

/// Returns whether two rows of a run have the same reading of an unmoved sensor.
fn repeats(one: &Observation, other: &Observation) -> bool {
    let (here, there) = (one.context.pose, other.context.pose);
    one.run == other.run
        && one.echo_cm == other.echo_cm
        && here.position_cm.distance(there.position_cm) < UNMOVED_CM
        && wrap_rad(here.heading_rad - there.heading_rad).abs() < UNMOVED_DEG.to_radians()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::{default_robot, training_room};
    use mindgap_foundations::geometry::Pose;
    use mindgap_logs::{Logs, Row, Run};
    use mindgap_models::simulator::ensemble::command_scale::Percent;
    use mindgap_models::simulator::kinematic;

    /// Returns the weighted rows of two runs of twelve rows; `row` gives the place and the reading of a row.
    fn rows_of(place_bound: [f64; 2], row: impl Fn(usize) -> (f64, Option<f64>)) -> Vec<Observation> {
        let row = |at: usize| {
            let (x_cm, echo_cm) = row(at);
            Row { t_ms: 400.0 * at as f64, pose: Some(Pose::new(x_cm, 100.0, 0.0)), echo_cm, ..Row::default() }
        };
        let run = |run: usize| Run { name: format!("run-{run:03}"), rows: (0..12).map(row).collect() };
        let logs = Logs { robot: default_robot(), scene: training_room(), runs: (0..2).map(run).collect() };
        let baseline = Baseline { place_bound, ..kinematic::baseline(&logs) };
        weighted(Observations::of(&logs, None, None), &baseline).rows
    }

    /// Returns the cells of a robot whose commands are percentages.
    fn in_percent(row: &Observation) -> [[i32; 2]; 2] {
        row.commands().map(|command| cell(Percent(command)))
    }

    /// Returns one of three distant places.
    fn place_cm(at: usize) -> f64 {
        20.0 + 65.0 * (at % 3) as f64
    }

    #[test]
    fn rows_at_one_place_have_the_weight_of_their_effective_number() {
        // Eight rows at each place: 1 + 2 * 7 / 2, and 1 + 2 * 7.
        let rows = rows_of([0.5, 1.0], |at| (place_cm(at), Some(at as f64)));
        assert!(rows.iter().all(|row| row.echo_weight == [1.0 / 8.0, 1.0 / 15.0]));
        assert_eq!(rows.iter().map(|row| row.place).collect::<Vec<_>>()[..4], [0, 1, 2, 0]);
        let free = rows_of([0.0; 2], |at| (place_cm(at), Some(at as f64)));
        assert!(free.iter().all(|row| row.echo_weight == [1.0; 2]));
    }

    /// Two runs of twelve rows hold one command, interrupted by one step of another command.
    #[test]
    fn steps_under_the_same_commands_have_the_weight_of_their_effective_number() {
        let command = |at: usize| if at == 6 { [30.0, 50.0] } else { [50.0, 50.0] };
        let row = |at: usize| {
            let pose = Some(Pose::new(20.0 + 5.0 * at as f64, 100.0, 0.0));
            let [left, right] = command(at);
            Row { t_ms: 400.0 * at as f64, left, right, pose, ..Row::default() }
        };
        let run = |run: usize| Run { name: format!("run-{run:03}"), rows: (0..12).map(row).collect() };
        let logs = Logs { robot: default_robot(), scene: training_room(), runs: (0..2).map(run).collect() };
        let mut rows = Observations::of(&logs, None, None).rows;
        weight_motion(
            &mut rows,
            [2.0; 3],
            in_percent,
            |now, before| if now == before { [1.0, 2.0, 0.0] } else { [4.0; 3] },
        );
        // Eight steps per run continue the command: 1 + 15 / 4 and 1 + 15 / 2. Each other step is repeated by the other run.
        assert_eq!(rows[3].motion_weight, [1.0 / 4.75, 1.0 / 8.5, 1.0]);
        assert_eq!(
            (rows[0].motion_weight, rows[6].motion_weight, rows[7].motion_weight),
            ([0.5; 3], [0.5; 3], [0.5; 3])
        );
        assert_eq!(rows[11].motion_weight, [1.0; 3], "no step begins there");
        assert!(
            weighted(Observations::of(&logs, None, None), &kinematic::baseline(&logs)).rows[3].motion_weight
                == [1.0; 3]
        );
    }

    /// Returns the folds of nine runs whose command changes half-way, each run under one of `commands` pairs of commands.
    fn folds(commands: usize) -> Vec<usize> {
        let row = |run: usize, at: usize| {
            let command = 30.0 + 8.0 * (run % commands) as f64 + if at < 6 { 0.0 } else { 4.0 };
            let pose = Some(Pose::new(20.0 + 5.0 * at as f64, 100.0, 0.0));
            Row { t_ms: 400.0 * at as f64, left: command, right: command, pose, ..Row::default() }
        };
        let run = |run: usize| Run { name: format!("run-{run:03}"), rows: (0..12).map(|at| row(run, at)).collect() };
        let logs = Logs { robot: default_robot(), scene: training_room(), runs: (0..9).map(run).collect() };
        let mut rows = Observations::of(&logs, None, None).rows;
        fold_together(&mut rows, in_percent);
        rows.iter().filter(|row| row.at == 0).map(|row| row.fold).collect()
    }

    #[test]
    fn runs_of_one_controller_share_a_fold() {
        assert_eq!(folds(2), [0, 1, 0, 1, 0, 1, 0, 1, 0]);
        assert_eq!(folds(4), [0, 1, 2, 3, 0, 1, 2, 3, 0]);
        let each_alone: Vec<usize> = (0..9).collect();
        assert_eq!((folds(9), folds(1)), (each_alone.clone(), each_alone));
    }

    #[test]
    fn missing_readings_repeat_no_value() {
        assert!(rows_of([0.0, 1.0], |at| (place_cm(at), None)).iter().all(|row| row.echo_weight == [1.0; 2]));
    }

    #[test]
    fn unpolled_first_and_last_rows_have_no_weight() {
        let weights = |is_read: fn(usize) -> bool| {
            let rows = rows_of([0.0; 2], |at| (place_cm(at), is_read(at).then_some(at as f64)));
            [0, 1, 10, 11, 12].map(|row| rows[row].echo_weight[0])
        };
        assert_eq!(weights(|at| at > 0 && at < 11), [0.0, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(weights(|at| at != 1 && at != 10), [1.0; 5]);
    }

    #[test]
    fn equal_readings_of_an_unmoved_sensor_count_as_one() {
        let rows = rows_of([0.0; 2], |at| (50.0, Some((at / 3) as f64)));
        assert!(rows.iter().all(|row| (row.echo_weight[0] - 1.0 / 3.0).abs() < 1e-12));
    }
}
