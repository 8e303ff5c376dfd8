//! Learns how much of the randomness of echoes belongs to the place. Whether a grazing wall returns an echo may be drawn for
//! every reading, or be determined by where the sensor is. In the second case the effective sample size of readings is
//! smaller than their number.

use rayon::prelude::*;

use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::intraclass::{self, Deviation};
use mindgap_foundations::statistics::summary::{QUARTILE, mean, median, root_mean_square};
use mindgap_logs::{Logs, Row};
use mindgap_models::sonar::SensorLaw;
use mindgap_models::sonar::echo_law::Surfaces;
use mindgap_models::sonar::place::{Place, place_of};

/// Residuals are clamped to this many standard deviations, since wrong readings say nothing about the others.
const LARGEST_RESIDUAL: f64 = 3.0;

/// A row with a pose.
pub struct Seen {
    /// Pose of the sensor.
    pub sensor: Pose,
    /// Index of the run.
    pub run: usize,
    /// Probability of no reading.
    pub none: f64,
    /// The reading, cm; `None` if there was none.
    pub echo_cm: Option<f64>,
    /// Reading minus expected reading, cm, if there is one.
    pub off_cm: Option<f64>,
}

/// Returns the shares of the variance that belong to the place: of the echo rate, and of the readings.
pub fn learn(seen: &[Seen]) -> [f64; 2] {
    [rate(seen), value(seen)]
}

/// Returns the rows of training logs with the expectations of the sensor's law.
pub fn seen(law: &SensorLaw, logs: &Logs) -> Vec<Seen> {
    let surfaces = Surfaces::new(logs.scene.sides());
    let rows: Vec<(usize, Row)> =
        logs.runs.iter().enumerate().flat_map(|(run, logged)| logged.rows.iter().map(move |row| (run, row))).collect();
    let seen = |(run, row): &(usize, Row)| {
        let sensor = logs.robot.sensor_pose(&row.pose?);
        let outcomes = law.outcomes_at(&surfaces, &sensor);
        let off_cm = outcomes.off_cm(row.echo_cm);
        Some(Seen { sensor, run: *run, none: outcomes.none, echo_cm: row.echo_cm, off_cm })
    };
    rows.par_iter().filter_map(seen).collect()
}

fn rate(seen: &[Seen]) -> f64 {
    let deviation = |row: &Seen| {
        let [off, scatter] = row.rate();
        Deviation { group: place_of(&row.sensor), run: row.run, residual: off, standard_deviation: scatter }
    };
    intraclass::correlation(&seen.iter().map(deviation).collect::<Vec<_>>())
}

fn value(seen: &[Seen]) -> f64 {
    let Some(scatter_cm) = scatter_cm(seen) else { return 0.0 };
    let within = |off_cm: f64| (off_cm / scatter_cm).clamp(-LARGEST_RESIDUAL, LARGEST_RESIDUAL);
    let off: Vec<(Place, usize, f64)> =
        seen.iter().filter_map(|row| Some((place_of(&row.sensor), row.run, within(row.off_cm?)))).collect();
    let middle = mean(off.iter().map(|(.., off)| *off));
    let scatter = root_mean_square(off.iter().map(|(.., off)| off - middle));
    let deviation = |(place, run, off): &(Place, usize, f64)| Deviation {
        group: *place,
        run: *run,
        residual: off - middle,
        standard_deviation: scatter,
    };
    intraclass::correlation(&off.iter().map(deviation).collect::<Vec<_>>())
}

/// Returns the scatter of readings about their expectations, cm; `None` if there is none.
fn scatter_cm(seen: &[Seen]) -> Option<f64> {
    let scatter_cm = median(seen.iter().filter_map(|row| row.off_cm).map(f64::abs)) / QUARTILE;
    (scatter_cm > 0.0).then_some(scatter_cm)
}

impl Seen {
    /// Returns the residual of the detection (1 for a reading, else 0, minus its probability), and its standard deviation.
    fn rate(&self) -> [f64; 2] {
        let off = if self.echo_cm.is_some() { self.none } else { self.none - 1.0 };
        [off, (self.none * (1.0 - self.none)).sqrt()]
    }
}

#[cfg(test)]
mod tests {
    use crate::learn::train::{TABLE_ONE, Trainer, train};
    use mindgap_built_in_robot::{default_robot, record, training_room};
    use mindgap_foundations::executor::Serial;

    /// Returns the share of the echo rate that a simulator learns for the built-in robot's sensor.
    fn learned(sensor: &str) -> f64 {
        let effects: Vec<_> = sensor.split_whitespace().map(|text| text.parse().expect("an effect")).collect();
        let logs = record(&default_robot(), &training_room(), 40, 60, &effects, 3).expect("room to drive");
        let simulator = train(&Serial, &logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        simulator.reference.expect("a reference").place_bound[0]
    }

    #[test]
    fn place_dependent_noise_is_distinguished_from_independent_noise() {
        let (free, bound) = (learned(""), learned("place_bound=0.95@7"));
        assert!(free < 0.06 && bound > 0.12, "{free} {bound}");
    }
}
