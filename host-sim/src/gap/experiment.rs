//! What to log next: the script that tells confused causes apart best, by expected evidence.

use glam::DVec2;
use rayon::prelude::*;

use super::explanation::Explanation;
use super::scripts::{self, Script};
use super::search::{Fitted, Given};
use crate::effects::effect::{HISTORY, StepContext};
use crate::evaluation::observations::{Observation, Observations};
use crate::evaluation::predictions;
use crate::geometry::{Pose, cast};
use crate::logs::{self, Run};
use crate::simulator::baseline::Baseline;
use crate::sonar::fan_at;

/// A script worth driving.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The causes that it tells apart.
    pub between: [&'static str; 2],
    /// The script in words.
    pub script: &'static str,
    /// Expected evidence of a run, nats.
    pub nats_a_run: f64,
    /// So many runs make it plain.
    pub runs: usize,
    /// Its commands, with the poses that are expected.
    pub commands: Run,
}

/// Two causes are told apart when they differ by so many standard errors.
const PLAIN_Z: f64 = 3.0;
/// More runs than this are no proposal.
const MOST_RUNS: f64 = 50.0;
/// Readings are tried on a grid of so many cm.
const GRID_CM: f64 = 4.0;
/// The robot keeps clear of everything by this, cm.
const CLEAR_CM: f64 = 3.0;
/// Places along each axis of the scene, and headings, from which a script may begin.
const PLACES: usize = 7;
const HEADINGS: usize = 4;

/// The best experiment between the explanation and the effect that is confused with it most, if any is.
pub fn next(explanation: &Explanation, given: &Given) -> Option<Experiment> {
    let (rival, between) = explanation.closest_rival()?;
    let chosen = &explanation.chosen;
    let bench = Bench { baseline: given.baseline, logs: given.evidence, chosen, rival };
    let scatter = chosen.hypothesis.scatter(given.baseline, given.evidence, &chosen.values);
    let scripts = scripts::all();
    let tried: Vec<(f64, &Script, Vec<Observation>)> = scripts
        .par_iter()
        .filter_map(|script| {
            let rows = bench.rows(script)?;
            Some((bench.evidence(&rows, scatter), script, rows))
        })
        .collect();
    let (nats_a_run, script, rows) = tried.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let runs = (PLAIN_Z * PLAIN_Z / nats_a_run).ceil().max(1.0);
    (runs <= MOST_RUNS).then(|| Experiment {
        between,
        script: script.name,
        nats_a_run,
        runs: runs as usize,
        commands: Run { name: "run-000".into(), rows: rows.iter().map(|row| logged(row, given)).collect() },
    })
}

/// Where scripts are tried.
struct Bench<'a> {
    baseline: &'a Baseline<'a>,
    logs: &'a Observations,
    chosen: &'a Fitted,
    rival: &'a Fitted,
}

impl Bench<'_> {
    /// What a script is expected to do, from the first place where it leads the robot nowhere against a wall.
    fn rows(&self, script: &Script) -> Option<Vec<Observation>> {
        self.starts().into_iter().find_map(|start| self.drive(script, start))
    }

    /// Where the robot stands free, the freest place first.
    fn starts(&self) -> Vec<Pose> {
        let ends = || self.logs.sides.iter().flat_map(|s| [s.from_cm, s.to_cm]);
        let low = ends().fold(DVec2::INFINITY, DVec2::min);
        let high = ends().fold(DVec2::NEG_INFINITY, DVec2::max);
        let share = |i: usize| (i as f64 + 0.5) / PLACES as f64;
        let places =
            (0..PLACES * PLACES).map(|i| low + (high - low) * DVec2::new(share(i % PLACES), share(i / PLACES)));
        let mut places: Vec<(f64, DVec2)> = places.map(|at| (self.clearance_cm(at), at)).collect();
        places.sort_by(|a, b| b.0.total_cmp(&a.0));
        let heading = |i: usize| std::f64::consts::TAU * i as f64 / HEADINGS as f64;
        places.iter().flat_map(|(_, at)| (0..HEADINGS).map(move |h| Pose::new(at.x, at.y, heading(h)))).collect()
    }

    fn clearance_cm(&self, at_cm: DVec2) -> f64 {
        self.logs.sides.iter().map(|side| side.nearest(at_cm).distance(at_cm)).fold(f64::INFINITY, f64::min)
    }

    /// The rows of a script from a pose; none when the robot would touch something.
    fn drive(&self, script: &Script, start: Pose) -> Option<Vec<Observation>> {
        let least_cm = self.logs.robot.body_radius_cm + CLEAR_CM;
        let mut rows: Vec<Observation> = Vec::with_capacity(script.commands.len());
        let mut pose = start;
        let effects = self.chosen.effects();
        for at in 0..script.commands.len() {
            if self.clearance_cm(pose.position_cm) < least_cm {
                return None;
            }
            let row = self.row(script, at, pose, &rows);
            if let Some(drive) = &self.baseline.motion {
                let motion = predictions::step(&effects, drive, &row.context);
                pose = pose.compose(&Pose::new(motion.forward_cm, motion.lateral_cm, motion.turn_rad));
            }
            rows.push(row);
        }
        Some(rows)
    }

    fn row(&self, script: &Script, at: usize, pose: Pose, before: &[Observation]) -> Observation {
        let sensor = self.logs.robot.ultrasonic.pose_on(&pose);
        let hit = cast(&self.logs.sides, sensor.position_cm, sensor.direction());
        let earlier = |back: usize| before.get(at.wrapping_sub(back)).map(|row| row.context.pose);
        let context = StepContext {
            elapsed_min: at as f64 * self.logs.robot.step_ms / 60_000.0,
            commands: std::array::from_fn::<_, HISTORY, _>(|back| {
                at.checked_sub(back).map_or([0.0; 2], |i| script.commands[i])
            }),
            pose,
            earlier: [earlier(1), earlier(2)],
            faced: hit.map(|hit| [hit.distance_cm, hit.incidence_rad]),
            faced_before: before.last().and_then(|row| row.context.faced),
            echo_before: Some(true),
            middle_cm: self.logs.rows[0].context.middle_cm,
            track_cm: self.logs.robot.track_cm,
        };
        let fan = fan_at(&self.logs.sides, &sensor, self.logs.fan_width);
        Observation {
            run: 0,
            at,
            block: 0,
            stretch: 1.0,
            context,
            then: Vec::new(),
            motion: None,
            expected: None,
            echo_cm: None,
            previous_echo_cm: None,
            fan,
        }
    }

    /// By how many nats the chosen effects are expected to be likelier than the rival where they are there.
    fn evidence(&self, rows: &[Observation], scatter: [f64; 3]) -> f64 {
        rows.iter().map(|row| self.of_motion(row, scatter) + self.of_reading(row)).sum()
    }

    fn of_motion(&self, row: &Observation, scatter: [f64; 3]) -> f64 {
        let Some(drive) = &self.baseline.motion else { return 0.0 };
        let [a, b] = [self.chosen, self.rival].map(|fit| {
            let m = predictions::step(&fit.effects(), drive, &row.context);
            [m.forward_cm, m.lateral_cm, m.turn_rad]
        });
        (0..3).map(|c| 0.5 * ((a[c] - b[c]) / scatter[c]) * ((a[c] - b[c]) / scatter[c])).sum()
    }

    /// The divergence between the readings that either expects.
    fn of_reading(&self, row: &Observation) -> f64 {
        let Some(sonar) = &self.baseline.sonar else { return 0.0 };
        let likelihood = |fit: &Fitted| {
            let (fan, change) = predictions::facing(&fit.effects(), self.logs, row);
            let outcomes = sonar.outcomes(&fan, &change, None);
            move |echo_cm: Option<f64>| outcomes.log_likelihood(echo_cm)
        };
        let (a, b) = (likelihood(self.chosen), likelihood(self.rival));
        let divergence = |echo_cm: Option<f64>, width: f64| {
            let log = a(echo_cm);
            width * libm::exp(log) * (log - b(echo_cm))
        };
        let [low, high] = sonar.range_cm;
        let cells = ((high - low) / GRID_CM) as usize;
        let readings = (0..cells).map(|i| low + (i as f64 + 0.5) * GRID_CM);
        divergence(None, 1.0) + readings.map(|z| divergence(Some(z), GRID_CM)).sum::<f64>()
    }
}

/// A row of the proposal as a row of a log.
fn logged(row: &Observation, given: &Given) -> logs::Row {
    let [left, right] = row.context.commands[0];
    let t_ms = row.at as f64 * given.evidence.robot.step_ms;
    logs::Row { t_ms, left, right, pose: Some(row.context.pose), ..logs::Row::default() }
}
