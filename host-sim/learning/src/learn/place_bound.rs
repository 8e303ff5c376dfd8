//! Learns how much of the chance in echoes belongs to the place: whether a grazing wall answers may be drawn anew for every
//! reading, or be decided by where the sensor is. In the second case readings tell less of a sensor than their number.

use rayon::prelude::*;

use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::intraclass::{self, Deviation};
use mindgap_foundations::statistics::summary::{QUARTILE, mean, median, root_mean_square};
use mindgap_logs::{Logs, Row};
use mindgap_models::sonar::SensorLaw;
use mindgap_models::sonar::echo_law::Surfaces;
use mindgap_models::sonar::place::{Place, place_of};

/// A reading that is farther off counts as this many standard deviations: wrong readings say nothing of readings.
const FARTHEST: f64 = 3.0;

/// A row at which the robot was seen.
pub struct Seen {
    /// Where the sensor was.
    pub sensor: Pose,
    /// Which run.
    pub run: usize,
    /// Probability of no reading.
    pub none: f64,
    /// What was read, cm.
    pub echo_cm: Option<f64>,
    /// Reading minus what was expected, if there is one.
    pub off_cm: Option<f64>,
}

/// The shares of the echo rate and of the readings.
pub fn learn(seen: &[Seen]) -> [f64; 2] {
    [rate(seen), value(seen)]
}

/// What the sensor said in its training logs, beside what its model expects.
pub fn seen(law: &SensorLaw, logs: &Logs) -> Vec<Seen> {
    let surfaces = Surfaces::new(logs.scene.sides());
    let rows: Vec<(usize, Row)> =
        logs.runs.iter().enumerate().flat_map(|(run, logged)| logged.rows.iter().map(move |row| (run, row))).collect();
    let seen = |(run, row): &(usize, Row)| {
        let sensor = logs.robot.ultrasonic.pose_on(&row.pose?);
        let outcomes = law.outcomes_at(&surfaces, &sensor);
        let off_cm = outcomes.off_cm(row.echo_cm);
        Some(Seen { sensor, run: *run, none: outcomes.none, echo_cm: row.echo_cm, off_cm })
    };
    rows.par_iter().filter_map(seen).collect()
}

fn rate(seen: &[Seen]) -> f64 {
    let deviation = |row: &Seen| {
        let [off, scatter] = row.rate();
        Deviation { group: place_of(&row.sensor), run: row.run, off, scatter }
    };
    intraclass::share(&seen.iter().map(deviation).collect::<Vec<_>>())
}

fn value(seen: &[Seen]) -> f64 {
    let Some(scatter_cm) = scatter_cm(seen) else { return 0.0 };
    let within = |off_cm: f64| (off_cm / scatter_cm).clamp(-FARTHEST, FARTHEST);
    let off: Vec<(Place, usize, f64)> =
        seen.iter().filter_map(|row| Some((place_of(&row.sensor), row.run, within(row.off_cm?)))).collect();
    let middle = mean(off.iter().map(|(.., off)| *off));
    let scatter = root_mean_square(off.iter().map(|(.., off)| off - middle));
    let deviation =
        |(place, run, off): &(Place, usize, f64)| Deviation { group: *place, run: *run, off: off - middle, scatter };
    intraclass::share(&off.iter().map(deviation).collect::<Vec<_>>())
}

/// The scatter of what is read about what was expected; none where there is none.
fn scatter_cm(seen: &[Seen]) -> Option<f64> {
    let scatter_cm = median(seen.iter().filter_map(|row| row.off_cm).map(f64::abs)) / QUARTILE;
    (scatter_cm > 0.0).then_some(scatter_cm)
}

impl Seen {
    /// Reading or none minus the probability of one, and the standard deviation of that.
    fn rate(&self) -> [f64; 2] {
        let off = if self.echo_cm.is_some() { self.none } else { self.none - 1.0 };
        [off, (self.none * (1.0 - self.none)).sqrt()]
    }
}

#[cfg(test)]
mod tests {
    use crate::learn::train::{TABLE_ONE, Trainer, train};
    use mindgap_built_in_robot::{default_robot, record, training_room};

    /// The share of the echo rate that a simulator learns of the built-in robot's sensor.
    fn learned(sensor: &str) -> f64 {
        let effects: Vec<_> = sensor.split_whitespace().map(|text| text.parse().expect("an effect")).collect();
        let logs = record(&default_robot(), &training_room(), 40, 60, &effects, 3).expect("room to drive");
        let simulator = train(&logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        simulator.reference.expect("a reference").place_bound[0]
    }

    #[test]
    fn chance_that_belongs_to_the_place_is_told_from_chance_that_does_not() {
        let (free, bound) = (learned(""), learned("place_bound=0.95@7"));
        assert!(free < 0.06 && bound > 0.12, "{free} {bound}");
    }
}
