//! How much a step and a reading count where others repeat them: rows are fewer than they look.
//!
//! Of m rows at a place that have a share ρ of their chance in common each tells 1/(1 + (m − 1) ρ) of what a row alone
//! would, the design effect of clusters (Kish 1965, Survey Sampling). What they have in common is twice as far off where
//! they are compared with a simulator: it was learned in a room that had its own. At poses that are familiar from the room
//! that it was learned in, only what earlier readings leave open is in common. Equal readings of an unmoved sensor are one.
//!
//! A simulator is off by the same in every step of the same commands. Its training logs say by how much about (`own_error`);
//! against the scatter of a step that is what these steps have in common. A controller that holds a command for thirty steps
//! says of the robot hardly more than one that holds it for ten. And what runs of one controller leave, all in the same steps,
//! other runs of it foretell, whatever the simulator is off by there: only what runs under other commands foretell is the robot's.

use std::collections::{BTreeMap, BTreeSet};

use super::observations::{Observation, Observations};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::ensemble::evidence::cell;

/// The room of the logs, and the one that the simulator was learned in.
const ROOMS: f64 = 2.0;
/// A sensor that is still within this of where it was, cm and degrees, has not moved as far as a tracker can tell.
const UNMOVED_CM: f64 = 1.0;
const UNMOVED_DEG: f64 = 2.0;

/// From this share of its steps on a run repeats another one: runs of one controller end some tuples earlier or later, and
/// those under commands at random share hardly any step.
const MOSTLY: f64 = 0.5;

/// Weighs every row by what the simulator knows of its chance and of its own error.
pub fn weighed(mut observations: Observations, baseline: &Baseline) -> Observations {
    if let Some(motion) = baseline.motion.as_ref().filter(|motion| motion.is_learned()) {
        let cells = |row: &Observation| commands(row).map(|command| cell(motion.percent(command)));
        weigh_motion(&mut observations.rows, motion.scatter(), cells, |now, before| motion.own_error(now, before));
        fold_together(&mut observations.rows, cells);
    }
    weigh_echoes(&mut observations, baseline.place_bound);
    observations
}

/// A step repeats others of the same commands, now and before: the simulator is off by the same in all of them, with these
/// mean squares where steps scatter so. Those of the same `cells` are the same.
fn weigh_motion(
    rows: &mut [Observation],
    scatter: [f64; 3],
    cells: impl Fn(&Observation) -> [[i32; 2]; 2],
    own_error: impl Fn([f64; 2], [f64; 2]) -> [f64; 3],
) {
    let mut repeated: BTreeMap<[[i32; 2]; 2], Vec<usize>> = BTreeMap::new();
    for (i, row) in rows.iter().enumerate().filter(|(_, row)| row.motion.is_some() && row.then.is_empty()) {
        repeated.entry(cells(row)).or_default().push(i);
    }
    for steps in repeated.into_values().filter(|steps| steps.len() > 1) {
        let [now, before] = commands(&rows[steps[0]]);
        let (own_error, others) = (own_error(now, before), (steps.len() - 1) as f64);
        let weight = [0, 1, 2].map(|i| 1.0 / (1.0 + others * own_error[i] / (scatter[i] * scatter[i])));
        steps.into_iter().for_each(|i| rows[i].motion_weight = weight);
    }
}

/// Runs most of whose steps are of the same `cells` are one fold, where there are others.
fn fold_together(rows: &mut [Observation], cells: impl Fn(&Observation) -> [[i32; 2]; 2]) {
    let mut steps: BTreeMap<usize, BTreeSet<[[i32; 2]; 2]>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.motion.is_some()) {
        steps.entry(row.run).or_default().insert(cells(row));
    }
    let repeats = |one: &BTreeSet<_>, other: &BTreeSet<_>| {
        one.intersection(other).count() as f64 >= MOSTLY * one.len().min(other.len()) as f64
    };
    // Each run is of the group of the first one that it repeats.
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

/// The commands of a row's step, now and before.
fn commands(row: &Observation) -> [[f64; 2]; 2] {
    let [now, before, ..] = row.context.commands;
    [now, before]
}

/// The echo rate and the reading; `place_bound` are the shares of their chance that belong to the place.
fn weigh_echoes(observations: &mut Observations, place_bound: [f64; 2]) {
    let Observations { places, rows, recollection, surroundings, .. } = observations;
    let mut heard = vec![[0.0; 2]; *places];
    for row in rows.iter() {
        heard[row.place][0] += 1.0;
        heard[row.place][1] += f64::from(u8::from(row.echo_cm.is_some()));
    }
    for row in rows.iter_mut() {
        let others = heard[row.place].map(|rows| (rows - 1.0).max(0.0));
        let recalled = recollection.as_ref().filter(|r| r.at(&surroundings.sensor(&row.context.pose, 0.0)).is_some());
        let common = recalled.map_or(place_bound.map(|share| ROOMS * share), |recollection| recollection.left_share);
        [0, 1].into_iter().for_each(|i| row.echo_weight[i] /= 1.0 + others[i] * common[i]);
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

/// Whether a row of the same run has the same reading of a sensor that has not moved.
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

    /// Two runs of twelve rows: the places and readings of their rows.
    fn rows_of(place_bound: [f64; 2], row: impl Fn(usize) -> (f64, Option<f64>)) -> Vec<Observation> {
        let row = |at: usize| {
            let (x_cm, echo_cm) = row(at);
            Row { t_ms: 400.0 * at as f64, pose: Some(Pose::new(x_cm, 100.0, 0.0)), echo_cm, ..Row::default() }
        };
        let run = |run: usize| Run { name: format!("run-{run:03}"), rows: (0..12).map(row).collect() };
        let logs = Logs { robot: default_robot(), scene: training_room(), runs: (0..2).map(run).collect() };
        let baseline = Baseline { place_bound, ..kinematic::baseline(&logs) };
        weighed(Observations::of(&logs, None), &baseline).rows
    }

    /// The cells of a robot whose commands are percent.
    fn in_percent(row: &Observation) -> [[i32; 2]; 2] {
        commands(row).map(|command| cell(Percent(command)))
    }

    /// One of three places, far from one another.
    fn place_cm(at: usize) -> f64 {
        20.0 + 65.0 * (at % 3) as f64
    }

    #[test]
    fn rows_of_a_place_count_as_many_as_they_tell() {
        // Eight rows at each place: 1 + 2 * 7 / 2, and 1 + 2 * 7.
        let rows = rows_of([0.5, 1.0], |at| (place_cm(at), Some(at as f64)));
        assert!(rows.iter().all(|row| row.echo_weight == [1.0 / 8.0, 1.0 / 15.0]));
        assert_eq!(rows.iter().map(|row| row.place).collect::<Vec<_>>()[..4], [0, 1, 2, 0]);
        let free = rows_of([0.0; 2], |at| (place_cm(at), Some(at as f64)));
        assert!(free.iter().all(|row| row.echo_weight == [1.0; 2]));
    }

    /// Two runs of twelve rows under two commands, of which one is held and one comes after another and again before it.
    #[test]
    fn steps_of_the_same_commands_count_as_many_as_they_tell() {
        let command = |at: usize| if at == 6 { [30.0, 50.0] } else { [50.0, 50.0] };
        let row = |at: usize| {
            let pose = Some(Pose::new(20.0 + 5.0 * at as f64, 100.0, 0.0));
            let [left, right] = command(at);
            Row { t_ms: 400.0 * at as f64, left, right, pose, ..Row::default() }
        };
        let run = |run: usize| Run { name: format!("run-{run:03}"), rows: (0..12).map(row).collect() };
        let logs = Logs { robot: default_robot(), scene: training_room(), runs: (0..2).map(run).collect() };
        let mut rows = Observations::of(&logs, None).rows;
        weigh_motion(
            &mut rows,
            [2.0; 3],
            in_percent,
            |now, before| if now == before { [1.0, 2.0, 0.0] } else { [4.0; 3] },
        );
        // Eight steps of a run go on with the command: 1 + 15 / 4 and 1 + 15 / 2. Its others are like that of the other run.
        assert_eq!(rows[3].motion_weight, [1.0 / 4.75, 1.0 / 8.5, 1.0]);
        assert_eq!(
            (rows[0].motion_weight, rows[6].motion_weight, rows[7].motion_weight),
            ([0.5; 3], [0.5; 3], [0.5; 3])
        );
        assert_eq!(rows[11].motion_weight, [1.0; 3], "no step begins there");
        assert!(weighed(Observations::of(&logs, None), &kinematic::baseline(&logs)).rows[3].motion_weight == [1.0; 3]);
    }

    /// Nine runs of a command that changes half-way, each under one of so many.
    fn folds(commands: usize) -> Vec<usize> {
        let row = |run: usize, at: usize| {
            let command = 30.0 + 8.0 * (run % commands) as f64 + if at < 6 { 0.0 } else { 4.0 };
            let pose = Some(Pose::new(20.0 + 5.0 * at as f64, 100.0, 0.0));
            Row { t_ms: 400.0 * at as f64, left: command, right: command, pose, ..Row::default() }
        };
        let run = |run: usize| Run { name: format!("run-{run:03}"), rows: (0..12).map(|at| row(run, at)).collect() };
        let logs = Logs { robot: default_robot(), scene: training_room(), runs: (0..9).map(run).collect() };
        let mut rows = Observations::of(&logs, None).rows;
        fold_together(&mut rows, in_percent);
        rows.iter().filter(|row| row.at == 0).map(|row| row.fold).collect()
    }

    #[test]
    fn what_one_controller_leaves_another_one_foretells() {
        assert_eq!(folds(2), [0, 1, 0, 1, 0, 1, 0, 1, 0]);
        assert_eq!(folds(4), [0, 1, 2, 3, 0, 1, 2, 3, 0]);
        let each_alone: Vec<usize> = (0..9).collect();
        assert_eq!((folds(9), folds(1)), (each_alone.clone(), each_alone));
    }

    #[test]
    fn where_nothing_is_read_no_reading_repeats() {
        assert!(rows_of([0.0, 1.0], |at| (place_cm(at), None)).iter().all(|row| row.echo_weight == [1.0; 2]));
    }

    #[test]
    fn rows_at_an_end_that_no_run_reads_tell_nothing_of_the_sensor() {
        let weights = |is_read: fn(usize) -> bool| {
            let rows = rows_of([0.0; 2], |at| (place_cm(at), is_read(at).then_some(at as f64)));
            [0, 1, 10, 11, 12].map(|row| rows[row].echo_weight[0])
        };
        assert_eq!(weights(|at| at > 0 && at < 11), [0.0, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(weights(|at| at != 1 && at != 10), [1.0; 5]);
    }

    #[test]
    fn equal_readings_of_an_unmoved_sensor_are_one() {
        let rows = rows_of([0.0; 2], |at| (50.0, Some((at / 3) as f64)));
        assert!(rows.iter().all(|row| (row.echo_weight[0] - 1.0 / 3.0).abs() < 1e-12));
    }
}
