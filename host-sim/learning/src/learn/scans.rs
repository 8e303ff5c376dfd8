//! The readings of a sensor by run, how much of them is repetition, and the pose errors of runs at one place.

use glam::DVec2;
use rand::seq::SliceRandom;
use rayon::prelude::*;

use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_foundations::random::generator;
use mindgap_logs::{Logs, Robot};

/// The rows of logs that have a pose.
#[derive(Clone, Debug)]
pub struct Scans {
    robot: Robot,
    /// The rows of each run.
    pub runs: Vec<Vec<Heard>>,
}

/// The reading at a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard {
    /// Pose of the robot.
    pub robot: Pose,
    /// The reading, cm; `None` if there was none.
    pub echo_cm: Option<f64>,
}

/// A displacement below this is indistinguishable from rest for a tracker, cm.
const UNMOVED_CM: f64 = 1.0;
/// Offset of x and y, cm, and of the heading, degrees.
pub type Offset = [f64; 3];

/// No offset.
pub const UNCHANGED: Offset = [0.0; 3];
/// Prior standard deviations of the pose offset of a scan: the robot is placed by hand, its sensor's head is not tracked,
/// and readings taken while the head turns lag behind.
const DEVIATIONS: Offset = [1.5, 1.5, 4.0];
/// Heading offsets that are tried first, degrees; then steps along each coordinate, as shares of its deviation.
const COARSE_DEG: [f64; 13] = [0.0, -2.0, 2.0, -4.0, 4.0, -6.0, 6.0, -8.0, 8.0, -10.0, 10.0, -12.0, 12.0];
const FINE: [f64; 8] = [0.5, 0.5, 0.5, 0.25, 0.25, 0.25, 0.12, 0.06];
/// Number of offsets that are tried per scan.
pub const TRIED: usize = COARSE_DEG.len() + 2 * DEVIATIONS.len() * FINE.len();

impl Scans {
    /// Returns the rows of logs that have a pose.
    pub fn new(logs: &Logs) -> Self {
        let heard = |row: mindgap_logs::Row| Some(Heard { robot: row.pose?, echo_cm: row.echo_cm });
        let runs = logs.runs.iter().map(|run| run.rows.iter().filter_map(heard).collect()).collect();
        Scans { robot: logs.robot, runs }
    }

    /// Keeps a random sample of at most `most` rows, in order.
    pub fn sampled(mut self, most: usize, seed: u64) -> Self {
        let rows = self.rows().count();
        if rows > most {
            let mut is_kept: Vec<bool> = (0..rows).map(|row| row < most).collect();
            is_kept.shuffle(&mut generator(seed, &[]));
            let mut is_kept = is_kept.into_iter();
            self.runs.iter_mut().for_each(|run| run.retain(|_| is_kept.next() == Some(true)));
        }
        self
    }

    /// Returns all rows.
    pub fn rows(&self) -> impl Iterator<Item = &Heard> {
        self.runs.iter().flatten()
    }

    /// Returns all rows, each with the offset of its run.
    pub fn rows_with<'s>(&'s self, offsets: &'s [Offset]) -> Vec<(&'s Heard, &'s Offset)> {
        self.runs.iter().zip(offsets).flat_map(|(run, offset)| run.iter().map(move |row| (row, offset))).collect()
    }

    /// Returns the sensor pose of a robot whose pose is shifted by an offset.
    pub fn sensor(&self, robot: &Pose, [x_cm, y_cm, deg]: &Offset) -> Pose {
        let position_cm = robot.position_cm + DVec2::new(*x_cm, *y_cm);
        self.robot.sensor_pose(&Pose { position_cm, heading_rad: wrap_rad(robot.heading_rad + deg.to_radians()) })
    }

    /// Returns the weight of a row. A series of equal readings of a sensor at rest counts as one observation; all its rows
    /// are kept, since its ends indicate the width of the beam.
    pub fn weight(&self) -> f64 {
        let repeats = |pair: &[Heard]| {
            let [before, now] = pair else { return false };
            before.echo_cm == now.echo_cm && now.robot.position_cm.distance(before.robot.position_cm) < UNMOVED_CM
        };
        let repeated: usize = self.runs.iter().map(|run| run.windows(2).filter(|pair| repeats(pair)).count()).sum();
        let rows = self.rows().count();
        (rows - repeated) as f64 / rows.max(1) as f64
    }

    /// Returns whether a run is a scan: the robot stayed at one place.
    pub fn is_scan(&self, run: usize) -> bool {
        let rows = &self.runs[run];
        let first = rows.first().map(|row| row.robot.position_cm);
        rows.iter().all(|row| first.is_some_and(|first| row.robot.position_cm.distance(first) < UNMOVED_CM))
    }

    /// Fits the pose offset of each run that is a scan, by maximum posterior probability given a sensor's `log_likelihood`
    /// of a reading at a pose. Other runs have no offset.
    pub fn offsets(&self, log_likelihood: impl Fn(&Pose, Option<f64>) -> f64 + Sync) -> Vec<Offset> {
        let weight = self.weight();
        let score = |run: &[Heard], offset: &Offset| {
            let terms: Vec<f64> =
                run.par_iter().map(|row| log_likelihood(&self.sensor(&row.robot, offset), row.echo_cm)).collect();
            let prior: f64 =
                offset.iter().zip(DEVIATIONS).map(|(off, deviation)| off * off / (deviation * deviation)).sum();
            weight * terms.iter().sum::<f64>() - 0.5 * prior
        };
        let offset = |run: usize| {
            let mut best = (UNCHANGED, f64::NEG_INFINITY);
            if !self.is_scan(run) {
                return best.0;
            }
            let try_out = |offset: Offset, best: &mut (Offset, f64)| {
                let tried = score(&self.runs[run], &offset);
                if tried > best.1 {
                    *best = (offset, tried);
                }
            };
            COARSE_DEG.iter().for_each(|deg| try_out([0.0, 0.0, *deg], &mut best));
            for share in FINE {
                for (i, deviation) in DEVIATIONS.iter().enumerate() {
                    for step in [-share * deviation, share * deviation] {
                        let mut offset = best.0;
                        offset[i] += step;
                        try_out(offset, &mut best);
                    }
                }
            }
            best.0
        };
        (0..self.runs.len()).map(offset).collect()
    }
}
