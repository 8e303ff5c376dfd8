//! Fits the first-echo law to logs: the most probable parameters for what is known of such sensors.

use rand::RngExt;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::scans::{Heard, Offset, Scans, UNCHANGED};
use mindgap_foundations::chance::generator;
use mindgap_foundations::statistics::maximise::{Bounds, Point, climb};
use mindgap_logs::Logs;
use mindgap_models::sonar::echo_law::{Surfaces, Target, reach_cm, targets_at};
use mindgap_models::sonar::{FirstEchoLaw, Perturbation};

/// What is known of a parameter before any log is seen.
struct Prior {
    middle: f64,
    deviation: f64,
    low: f64,
    high: f64,
}

const fn prior(middle: f64, deviation: f64, low: f64, high: f64) -> Prior {
    Prior { middle, deviation, low, high }
}

/// Number of parameters.
const PARAMETERS: usize = 20;
/// In the order of [`FirstEchoLaw`]'s fields: medians over eleven LEGO NXT sensors, and wider than they spread, so that the
/// sensor's own logs decide; bounds are what is physically possible. Narrow priors on the first six, which share the unit of
/// the threshold's noise, would blur the beam.
const PRIORS: [Prior; PARAMETERS] = [
    prior(2.7, 2.0, -6.0, 20.0),
    prior(3.65, 1.3, 0.0, 12.0),
    prior(8.7, 3.0, 1.0, 40.0),
    prior(1.33, 0.4, 0.5, 4.0),
    prior(15.0, 4.0, 3.0, 60.0),
    prior(10.7, 3.0, 0.5, 40.0),
    prior(-0.9, 1.0, -12.0, 3.0),
    prior(-6.7, 1.5, -15.0, 3.0),
    prior(-1.4, 2.0, -15.0, 15.0),
    prior(1.0, 0.01, 0.8, 1.2),
    prior(0.17, 0.12, -0.5, 1.5),
    prior(0.57, 0.3, 0.3, 10.0),
    prior(0.3, 0.3, -1.0, 2.0),
    prior(0.2, 0.2, -0.5, 1.5),
    prior(0.007, 0.02, 0.0, 0.5),
    prior(0.25, 0.25, 0.0, 0.98),
    prior(0.6, 0.25, 0.02, 0.98),
    prior(0.0, 0.05, 0.0, 0.5),
    prior(21.5, 2.0, 5.0, 60.0),
    prior(0.02, 0.02, 0.004, 0.2),
];
/// Where the first search begins: the medians, with a little of each wrong reading.
const GHOST_AT_START: f64 = 0.01;
const GHOST: usize = 17;

/// Searches begin here: at the medians, and at points drawn from the priors.
const STARTS: usize = 5;
/// Rounds of each search, then of the best one after each new fit of poses.
const FIRST_ROUNDS: usize = 12;
const LATER_ROUNDS: usize = 12;
/// How often the poses of scans and parameters are fitted in turn.
const TURNS: usize = 3;
/// Searches end when a round gains less than this, in nats.
const ENOUGH: f64 = 0.2;
/// The first searches look at this many rows at most, which tell one hill from another. How wide a beam is they tell no better
/// than the logs that a diagnosis compares with it, so the climb goes on over all rows.
const MOST_ROWS: usize = 1000;
/// Fewer readings than this, the least for a network too, tell nothing beyond the priors.
const FEWEST: usize = 30;

/// The law of the sensor that made these logs; none where they hold too few readings.
pub fn learn(logs: &Logs, seed: u64) -> Option<Found> {
    let all = Fit::new(logs);
    let readings = all.scans.rows().filter(|row| row.echo_cm.is_some()).count();
    (readings >= FEWEST).then(|| all.most_probable(all.clone().sampled(seed).best_of(&starts(seed))))
}

/// The law of these logs, with poses as logged, sought from another on.
pub fn learn_from(start: &FirstEchoLaw, logs: &Logs) -> FirstEchoLaw {
    Fit::new(logs).as_logged(&numbers(start))
}

/// The most probable law of a sensor; where no run is a scan both are the same.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Found {
    /// With the poses of scans as nuisances: what the sensor is like.
    pub sensor: FirstEchoLaw,
    /// With poses as they are logged: how readings lie about them, with what the poses of such scans are off by.
    pub as_logged: FirstEchoLaw,
}

#[derive(Clone)]
struct Fit {
    surfaces: Surfaces,
    scans: Scans,
    weight: f64,
    range_cm: [f64; 2],
}

/// What a sensor faced at a row, and what it said.
struct Faced {
    targets: Vec<Target>,
    reach_cm: f64,
    echo_cm: Option<f64>,
}

impl Fit {
    fn new(logs: &Logs) -> Self {
        let scans = Scans::of(logs);
        Fit {
            surfaces: Surfaces::new(logs.scene.sides()),
            weight: scans.weight(),
            scans,
            range_cm: [logs.robot.ultrasonic.min_cm, logs.robot.ultrasonic.max_cm],
        }
    }

    /// The same with [`MOST_ROWS`] rows at most.
    fn sampled(self, seed: u64) -> Self {
        Fit { scans: self.scans.sampled(MOST_ROWS, seed), ..self }
    }

    /// Where the highest of several searches ends, with poses as logged.
    fn best_of(&self, starts: &[[f64; PARAMETERS]]) -> Vec<f64> {
        let unchanged = self.unchanged();
        let search =
            |start: &[f64; PARAMETERS]| climb(&bounds(), start, FIRST_ROUNDS, ENOUGH, |at| self.terms(at, &unchanged));
        let mut best: Option<Point> = None;
        for found in starts.iter().map(search) {
            if best.as_ref().is_none_or(|best| found.value() > best.value()) {
                best = Some(found);
            }
        }
        best.expect("there are several starts").at
    }

    /// The most probable law with poses as logged, sought from here on.
    fn as_logged(&self, start: &[f64]) -> FirstEchoLaw {
        let unchanged = self.unchanged();
        let found = climb(&bounds(), start, TURNS * LATER_ROUNDS, ENOUGH, |at| self.terms(at, &unchanged));
        law(&found.at, self.range_cm)
    }

    fn most_probable(&self, start: Vec<f64>) -> Found {
        let as_logged = self.as_logged(&start);
        if !(0..self.scans.runs.len()).any(|run| self.scans.is_scan(run)) {
            return Found { sensor: as_logged.clone(), as_logged };
        }
        let mut at = start;
        for _ in 0..TURNS {
            let now = law(&at, self.range_cm);
            let log_likelihood = |sensor: &_, echo_cm| now.outcomes_at(&self.surfaces, sensor).log_likelihood(echo_cm);
            let faced = self.faced(&self.scans.offsets(log_likelihood));
            at = climb(&bounds(), &at, LATER_ROUNDS, ENOUGH, |at| self.terms(at, &faced)).at;
        }
        Found { sensor: law(&at, self.range_cm), as_logged }
    }

    fn unchanged(&self) -> Vec<Faced> {
        self.faced(&vec![UNCHANGED; self.scans.runs.len()])
    }

    /// What was faced at every row, with an offset to the poses of each run.
    fn faced(&self, offsets: &[Offset]) -> Vec<Faced> {
        let faced = |(row, offset): &(&Heard, &Offset)| {
            let sensor = self.scans.sensor(&row.robot, offset);
            let targets = targets_at(&self.surfaces, &sensor);
            Faced { targets, reach_cm: reach_cm(&self.surfaces, &sensor), echo_cm: row.echo_cm }
        };
        self.scans.rows_with(offsets).par_iter().map(faced).collect()
    }

    /// Log-likelihoods of all rows, weighted, and of the parameters before any row.
    fn terms(&self, at: &[f64], faced: &[Faced]) -> Vec<f64> {
        let law = law(at, self.range_cm);
        let term = |row: &Faced| {
            let outcomes = law.outcomes(&row.targets, row.reach_cm, &Perturbation::NONE);
            self.weight * outcomes.log_likelihood(row.echo_cm)
        };
        let mut terms: Vec<f64> = faced.par_iter().map(term).collect();
        terms.extend(PRIORS.iter().zip(at).map(|(prior, value)| {
            let off = (value - prior.middle) / prior.deviation;
            -0.5 * off * off
        }));
        terms
    }
}

/// A step of one prior's standard deviation is a large one.
fn bounds() -> [Bounds; PARAMETERS] {
    PRIORS.map(|Prior { low, high, deviation, .. }| Bounds { low, high, scale: deviation })
}

fn starts(seed: u64) -> Vec<[f64; PARAMETERS]> {
    let start = |number: usize| {
        let mut rng = generator(seed, &[number as u64]);
        let mut start = PRIORS.map(|prior| {
            let off = if number == 0 { 0.0 } else { 2.0 * rng.random::<f64>() - 1.0 };
            (prior.middle + off * prior.deviation).clamp(prior.low, prior.high)
        });
        start[GHOST] = start[GHOST].max(GHOST_AT_START);
        start
    };
    (0..STARTS).map(start).collect()
}

fn law(at: &[f64], range_cm: [f64; 2]) -> FirstEchoLaw {
    FirstEchoLaw {
        gain: at[0],
        spreading: at[1],
        beam_deg: at[2],
        beam_power: at[3],
        specular_deg: at[4],
        oblique_loss: at[5],
        corner: at[6],
        edge: at[7],
        offset_cm: at[8],
        scale: at[9],
        off_axis_cm: at[10],
        scatter_cm: at[11],
        scatter_per_m: at[12],
        scatter_off_axis: at[13],
        p_dropout: at[14],
        p_other: at[15],
        p_long_given_other: at[16],
        p_ghost: at[GHOST],
        ghost_cm: at[18],
        p_stray: at[19],
        range_cm,
    }
}

/// What [`law`] makes a law of.
fn numbers(law: &FirstEchoLaw) -> [f64; PARAMETERS] {
    [
        law.gain,
        law.spreading,
        law.beam_deg,
        law.beam_power,
        law.specular_deg,
        law.oblique_loss,
        law.corner,
        law.edge,
        law.offset_cm,
        law.scale,
        law.off_axis_cm,
        law.scatter_cm,
        law.scatter_per_m,
        law.scatter_off_axis,
        law.p_dropout,
        law.p_other,
        law.p_long_given_other,
        law.p_ghost,
        law.ghost_cm,
        law.p_stray,
    ]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use mindgap_built_in_robot::{default_robot, training_room};
    use mindgap_foundations::geometry::Pose;
    use mindgap_logs::{Row, Run};

    /// A sensor unlike the prior's middle.
    fn made_up() -> FirstEchoLaw {
        let mut at = PRIORS.map(|prior| prior.middle);
        at[0] = 4.0;
        at[2] = 11.0;
        at[8] = 1.5;
        at[GHOST] = 0.08;
        at[18] = 23.0;
        law(&at, [4.0, 240.0])
    }

    /// By how much headings are off, degrees.
    pub const MIXED_UP_DEG: [f64; 12] = [0.0, 3.0, -4.0, 6.0, -2.0, 1.0, 0.0, -5.0, 4.0, 2.0, -3.0, 0.0];

    /// Scans of a sensor that turns by 5 degrees a row at places of a room, with headings off by these.
    pub fn scans(seed: u64, off_deg: [f64; 12]) -> Logs {
        let scene = training_room();
        let surfaces = Surfaces::new(scene.sides());
        let robot = mindgap_logs::Robot {
            ultrasonic: mindgap_logs::Ultrasonic { x_cm: 0.0, ..default_robot().ultrasonic },
            ..default_robot()
        };
        let (sensor, mut rng) = (made_up(), generator(seed, &[]));
        let runs = off_deg.iter().enumerate().map(|(run, off_deg)| {
            let mut place = Pose::new(0.0, 0.0, 0.0);
            while !scene.has_room_for(place.position_cm, 10.0) {
                place = Pose::new(300.0 * rng.random::<f64>(), 220.0 * rng.random::<f64>(), 0.0);
            }
            let rows = (0..72).map(|at| {
                let heading = |deg: f64| Pose { heading_rad: (5.0 * f64::from(at) + deg).to_radians(), ..place };
                let outcomes = sensor.outcomes_at(&surfaces, &heading(*off_deg));
                let echo_cm = outcomes.draw(true, || rng.random()).map(f64::round);
                Row { t_ms: 400.0 * f64::from(at), pose: Some(heading(0.0)), echo_cm, ..Row::default() }
            });
            Run { name: format!("run-{run:03}"), rows: rows.collect() }
        });
        Logs { runs: runs.collect(), robot, scene: scene.clone() }
    }

    #[test]
    fn a_made_up_sensor_is_found_again() {
        let off_deg = MIXED_UP_DEG;
        let logs = scans(1, off_deg);
        let found = learn(&logs, 1).expect("readings").sensor;
        let truth = made_up();
        let near = |name: &str, found: f64, truth: f64, within: f64| {
            assert!((found - truth).abs() < within, "{name}: {found}, and {truth} in truth");
        };
        near("gain", found.gain, truth.gain, 1.0);
        near("spreading", found.spreading, truth.spreading, 1.0);
        near("beam_deg", found.beam_deg, truth.beam_deg, 2.5);
        near("offset_cm", found.offset_cm, truth.offset_cm, 0.7);
        near("p_ghost", found.p_ghost, truth.p_ghost, 0.04);
        near("ghost_cm", found.ghost_cm, truth.ghost_cm, 0.7);
        near("p_other", found.p_other, truth.p_other, 0.08);

        // Headings are found again, and readings of other scans are as likely as to the sensor itself.
        let (surfaces, others) = (Surfaces::new(logs.scene.sides()), scans(2, [0.0; 12]));
        let likely = |law: &FirstEchoLaw| {
            let scans = Scans::of(&others);
            let rows: Vec<f64> = scans
                .rows()
                .map(|row| {
                    law.outcomes_at(&surfaces, &scans.sensor(&row.robot, &UNCHANGED)).log_likelihood(row.echo_cm)
                })
                .collect();
            rows.iter().sum::<f64>() / rows.len() as f64
        };
        near("nats a reading", likely(&found), likely(&truth), 0.1);
        let offsets =
            Scans::of(&logs).offsets(|sensor, echo_cm| found.outcomes_at(&surfaces, sensor).log_likelihood(echo_cm));
        for ([x_cm, y_cm, deg], off_deg) in offsets.iter().zip(off_deg) {
            near("x_cm", *x_cm, 0.0, 2.0);
            near("y_cm", *y_cm, 0.0, 2.0);
            // Rows are 5 degrees apart, and the prior pulls towards none.
            near("heading", *deg, off_deg, 3.5);
        }
    }

    #[test]
    fn all_rows_tell_of_a_sensor() {
        let mut logs = scans(1, [0.0; 12]);
        logs.runs.extend(scans(2, [0.0; 12]).runs);
        let fit = Fit::new(&logs);
        assert!(fit.scans.rows().count() > MOST_ROWS);
        let likely = |law: &FirstEchoLaw| fit.terms(&numbers(law), &fit.unchanged()).iter().sum::<f64>();
        let found = [1, 2].map(|seed| likely(&learn(&logs, seed).expect("readings").as_logged));
        assert!((found[0] - found[1]).abs() < 2.0, "{found:?}");
        assert!(likely(&learn_from(&made_up(), &logs)) < found[0] + 2.0, "{found:?}");
        let by_some = likely(&fit.clone().sampled(1).as_logged(&numbers(&made_up())));
        assert!(by_some < found[0] - 2.0, "{by_some}, and {found:?} by all");
    }

    #[test]
    fn a_search_begins_at_the_law_that_it_is_given() {
        assert_eq!(law(&numbers(&made_up()), [4.0, 240.0]), made_up());
    }

    #[test]
    fn few_readings_tell_nothing() {
        let mut logs = scans(1, [0.0; 12]);
        logs.runs.truncate(1);
        logs.runs[0].rows.truncate(20);
        assert!(learn(&logs, 1).is_none());
    }
}
