//! Fits the first-echo law to logs: the parameters of maximum posterior probability, with priors from other sensors.

use rand::RngExt;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::scans::{Heard, Offset, Scans, UNCHANGED};
use mindgap_foundations::random::generator;
use mindgap_foundations::statistics::maximise::{Bounds, Point, climb};
use mindgap_logs::Logs;
use mindgap_models::sonar::echo_law::{Surfaces, Target, reach_cm, targets_at};
use mindgap_models::sonar::{FirstEchoLaw, Perturbation};

/// Prior of a parameter.
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
/// Priors in the order of [`FirstEchoLaw`]'s fields: medians over eleven LEGO NXT sensors, with deviations wider than their
/// spread, so that the sensor's own logs decide; bounds are what is physically possible. Narrow priors on the first six,
/// which share the unit of the threshold's noise, would blur the beam.
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
/// Start of the first search: the medians, with a small probability of each kind of wrong reading.
const GHOST_AT_START: f64 = 0.01;
const GHOST: usize = 17;

/// Number of searches: one starts at the medians, the others at points drawn from the priors.
const STARTS: usize = 5;
/// Number of rounds of each search, then of the best one after each new fit of poses.
const FIRST_ROUNDS: usize = 12;
const LATER_ROUNDS: usize = 12;
/// Number of alternations between fitting the poses of scans and the parameters.
const TURNS: usize = 3;
/// Searches end when a round gains less than this, in nats.
const ENOUGH: f64 = 0.2;
/// Maximum number of rows for the first searches, enough to distinguish local maxima. They determine the beam's width no
/// better than the logs that a diagnosis compares with it, so the final climb uses all rows.
const MOST_ROWS: usize = 1000;
/// Minimum number of readings, as for a network: fewer add nothing to the priors.
const FEWEST: usize = 30;

/// Fits the law of the sensor that made these logs; `None` if they hold too few readings.
pub fn learn(logs: &Logs, seed: u64) -> Option<Found> {
    let all = Fit::new(logs, logs.robot.ultrasonic?.range_cm());
    let readings = all.scans.rows().filter(|row| row.echo_cm.is_some()).count();
    (readings >= FEWEST).then(|| all.most_probable(all.clone().sampled(seed).best_of(&starts(seed))))
}

/// Fits a law to logs, with poses as logged, starting the search at another law.
pub fn learn_from(start: &FirstEchoLaw, logs: &Logs) -> FirstEchoLaw {
    let range_cm = logs.robot.ultrasonic.map_or(start.range_cm, |sensor| sensor.range_cm());
    Fit::new(logs, range_cm).as_logged(&numbers(start))
}

/// The most probable law of a sensor. Without scans both variants are equal.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Found {
    /// With the poses of scans as nuisance parameters: the sensor itself.
    pub sensor: FirstEchoLaw,
    /// With poses as logged: it includes the effect of the pose errors of scans.
    pub as_logged: FirstEchoLaw,
}

#[derive(Clone)]
struct Fit {
    surfaces: Surfaces,
    scans: Scans,
    weight: f64,
    range_cm: [f64; 2],
}

/// The targets of a sensor at a row, and its reading.
struct Faced {
    targets: Vec<Target>,
    reach_cm: f64,
    echo_cm: Option<f64>,
}

impl Fit {
    fn new(logs: &Logs, range_cm: [f64; 2]) -> Self {
        let scans = Scans::new(logs);
        Fit { surfaces: Surfaces::new(logs.scene.sides()), weight: scans.weight(), scans, range_cm }
    }

    /// Returns a sample of at most [`MOST_ROWS`] rows.
    fn sampled(self, seed: u64) -> Self {
        Fit { scans: self.scans.sampled(MOST_ROWS, seed), ..self }
    }

    /// Returns the end of the best of several searches, with poses as logged.
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

    /// Returns the most probable law with poses as logged, starting the search at `start`.
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

    /// Returns the targets and the reading of every row, with an offset of the poses of each run.
    fn faced(&self, offsets: &[Offset]) -> Vec<Faced> {
        let faced = |(row, offset): &(&Heard, &Offset)| {
            let sensor = self.scans.sensor(&row.robot, offset);
            let targets = targets_at(&self.surfaces, &sensor);
            Faced { targets, reach_cm: reach_cm(&self.surfaces, &sensor), echo_cm: row.echo_cm }
        };
        self.scans.rows_with(offsets).par_iter().map(faced).collect()
    }

    /// Returns the weighted log-likelihoods of all rows, and the log prior of the parameters.
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

/// Returns the bounds of the search; the standard deviation of a prior is the scale of a parameter.
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

/// Returns the parameters of a law, the inverse of [`law`].
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

    /// Returns a sensor that differs from the prior mean.
    fn made_up() -> FirstEchoLaw {
        let mut at = PRIORS.map(|prior| prior.middle);
        at[0] = 4.0;
        at[2] = 11.0;
        at[8] = 1.5;
        at[GHOST] = 0.08;
        at[18] = 23.0;
        law(&at, [4.0, 240.0])
    }

    /// Errors of the headings, degrees.
    pub const MIXED_UP_DEG: [f64; 12] = [0.0, 3.0, -4.0, 6.0, -2.0, 1.0, 0.0, -5.0, 4.0, 2.0, -3.0, 0.0];

    /// Returns scans of a sensor that turns by 5 degrees per row at places of a room, with these errors of the headings.
    pub fn scans(seed: u64, off_deg: [f64; 12]) -> Logs {
        let scene = training_room();
        let surfaces = Surfaces::new(scene.sides());
        let robot = mindgap_logs::Robot {
            ultrasonic: default_robot().ultrasonic.map(|sensor| mindgap_logs::Ultrasonic { x_cm: 0.0, ..sensor }),
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
    fn made_up_sensor_is_recovered() {
        let off_deg = MIXED_UP_DEG;
        let logs = scans(1, off_deg);
        let found = learn(&logs, 1).expect("readings").sensor;
        let truth = made_up();
        let near = |name: &str, found: f64, truth: f64, within: f64| {
            assert!((found - truth).abs() < within, "{name}: {found}, true value {truth}");
        };
        near("gain", found.gain, truth.gain, 1.0);
        near("spreading", found.spreading, truth.spreading, 1.0);
        near("beam_deg", found.beam_deg, truth.beam_deg, 2.5);
        near("offset_cm", found.offset_cm, truth.offset_cm, 0.7);
        near("p_ghost", found.p_ghost, truth.p_ghost, 0.04);
        near("ghost_cm", found.ghost_cm, truth.ghost_cm, 0.7);
        near("p_other", found.p_other, truth.p_other, 0.08);

        // Headings are recovered, and readings of other scans are as likely as under the true law.
        let (surfaces, others) = (Surfaces::new(logs.scene.sides()), scans(2, [0.0; 12]));
        let likely = |law: &FirstEchoLaw| {
            let scans = Scans::new(&others);
            let rows: Vec<f64> = scans
                .rows()
                .map(|row| {
                    law.outcomes_at(&surfaces, &scans.sensor(&row.robot, &UNCHANGED)).log_likelihood(row.echo_cm)
                })
                .collect();
            rows.iter().sum::<f64>() / rows.len() as f64
        };
        near("nats per reading", likely(&found), likely(&truth), 0.1);
        let offsets =
            Scans::new(&logs).offsets(|sensor, echo_cm| found.outcomes_at(&surfaces, sensor).log_likelihood(echo_cm));
        for ([x_cm, y_cm, deg], off_deg) in offsets.iter().zip(off_deg) {
            near("x_cm", *x_cm, 0.0, 2.0);
            near("y_cm", *y_cm, 0.0, 2.0);
            // Rows are 5 degrees apart, and the prior pulls towards zero.
            near("heading", *deg, off_deg, 3.5);
        }
    }

    #[test]
    fn all_rows_are_used_for_the_fit() {
        let mut logs = scans(1, [0.0; 12]);
        logs.runs.extend(scans(2, [0.0; 12]).runs);
        let fit = Fit::new(&logs, [4.0, 240.0]);
        assert!(fit.scans.rows().count() > MOST_ROWS);
        let likely = |law: &FirstEchoLaw| fit.terms(&numbers(law), &fit.unchanged()).iter().sum::<f64>();
        let found = [1, 2].map(|seed| likely(&learn(&logs, seed).expect("readings").as_logged));
        assert!((found[0] - found[1]).abs() < 2.0, "{found:?}");
        assert!(likely(&learn_from(&made_up(), &logs)) < found[0] + 2.0, "{found:?}");
        let by_some = likely(&fit.clone().sampled(1).as_logged(&numbers(&made_up())));
        assert!(by_some < found[0] - 2.0, "{by_some}, and {found:?} by all");
    }

    #[test]
    fn search_starts_at_the_given_law() {
        assert_eq!(law(&numbers(&made_up()), [4.0, 240.0]), made_up());
    }

    #[test]
    fn few_readings_give_no_law() {
        let mut logs = scans(1, [0.0; 12]);
        logs.runs.truncate(1);
        logs.runs[0].rows.truncate(20);
        assert!(learn(&logs, 1).is_none());
    }
}
