//! How much a reading counts where others repeat it: rows are fewer than they look.
//!
//! Of m rows at a place that have a share ρ of their chance in common each tells 1/(1 + (m − 1) ρ) of what a row alone
//! would, the design effect of clusters (Kish 1965, Survey Sampling). What they have in common is twice as far off where
//! they are compared with a simulator: it was learned in a room that had its own. At poses that are familiar from the room
//! that it was learned in, only what earlier readings leave open is in common. Equal readings of an unmoved sensor are one.

use super::observations::{Observation, Observations};
use crate::geometry::wrap_rad;

/// The room of the logs, and the one that the simulator was learned in.
const ROOMS: f64 = 2.0;
/// A sensor that is still within this of where it was, cm and degrees, has not moved as far as a tracker can tell.
const UNMOVED_CM: f64 = 1.0;
const UNMOVED_DEG: f64 = 2.0;

/// Weighs the echo rate and the reading of every row; `place_bound` are the shares of their chance that belong to the place.
pub fn weighed(mut observations: Observations, place_bound: [f64; 2]) -> Observations {
    let Observations { places, rows, recollection, surroundings, .. } = &mut observations;
    let mut heard = vec![[0.0; 2]; *places];
    for row in rows.iter() {
        heard[row.place][0] += 1.0;
        heard[row.place][1] += f64::from(u8::from(row.echo_cm.is_some()));
    }
    for row in rows.iter_mut() {
        let others = heard[row.place].map(|rows| (rows - 1.0).max(0.0));
        let recalled = recollection.as_ref().filter(|r| r.at(&surroundings.sensor(&row.context.pose, 0.0)).is_some());
        let common = recalled.map_or(place_bound.map(|share| ROOMS * share), |recollection| recollection.left_share);
        row.echo_weight = [0, 1].map(|i| 1.0 / (1.0 + others[i] * common[i]));
    }
    let mut begin = 0;
    for end in 1..=rows.len() {
        if end == rows.len() || !repeats(&rows[begin], &rows[end]) {
            let share = 1.0 / (end - begin) as f64;
            rows[begin..end].iter_mut().for_each(|row| row.echo_weight = row.echo_weight.map(|weight| share * weight));
            begin = end;
        }
    }
    observations
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
    use crate::built_in_robot::{default_robot, training_room};
    use crate::geometry::Pose;
    use crate::logs::{Logs, Row, Run};

    /// Two runs of twelve rows: the places and readings of their rows.
    fn rows_of(place_bound: [f64; 2], row: impl Fn(usize) -> (f64, Option<f64>)) -> Vec<Observation> {
        let row = |at: usize| {
            let (x_cm, echo_cm) = row(at);
            Row { t_ms: 400.0 * at as f64, pose: Some(Pose::new(x_cm, 100.0, 0.0)), echo_cm, ..Row::default() }
        };
        let run = |run: usize| Run { name: format!("run-{run:03}"), rows: (0..12).map(row).collect() };
        let logs = Logs { robot: default_robot(), scene: training_room(), runs: (0..2).map(run).collect() };
        weighed(Observations::of(&logs, 1.0), place_bound).rows
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

    #[test]
    fn where_nothing_is_read_no_reading_repeats() {
        assert!(rows_of([0.0, 1.0], |at| (place_cm(at), None)).iter().all(|row| row.echo_weight == [1.0; 2]));
    }

    #[test]
    fn equal_readings_of_an_unmoved_sensor_are_one() {
        let rows = rows_of([0.0; 2], |at| (50.0, Some((at / 3) as f64)));
        assert!(rows.iter().all(|row| (row.echo_weight[0] - 1.0 / 3.0).abs() < 1e-12));
    }
}
