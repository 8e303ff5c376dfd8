//! Log-likelihood of logged readings under each sensor model, in nats per reading: the two networks, the beam model fitted to
//! the training logs, the first-echo law, and the textbook's ideal ray.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use crate::learn::scans::{Heard, Offset, Scans, TRIED, UNCHANGED};
use mindgap_foundations::counter::Counter;
use mindgap_foundations::geometry::{Pose, cast};
use mindgap_logs::Logs;
use mindgap_models::simulator::{Simulator, kinematic};
use mindgap_models::sonar::SensorLaw;
use mindgap_models::sonar::echo_law::Surfaces;
use mindgap_models::sonar::model::{CONSTANT_SCATTER_CM, P_RAND};
use mindgap_models::sonar::outcomes::{Component, Distribution, Outcomes, Source};

/// Log-likelihood of the readings of logs under each model that the simulator has.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SensorModels {
    /// Number of readings: rows with a pose, with or without an echo.
    pub n: usize,
    /// The two networks with their learned residuals.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub networks: Option<Nats>,
    /// The beam model fitted to the training logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beam: Option<Nats>,
    /// The first-echo law.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_echo: Option<Nats>,
    /// The textbook's ideal ray, with noise and dropout rate taken from these logs themselves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ideal_ray: Option<Nats>,
}

/// Mean log-likelihood per reading: of its value per cm, or of no echo.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Nats {
    /// Mean with the poses as logged.
    pub as_logged: f64,
    /// Mean with an offset (x, y, heading) to the poses of each scan, fitted to that scan; null if no run is a scan.
    pub poses_refitted: Option<f64>,
}

/// Scores every sensor model that a simulator has by the readings of logs. Returns `None` if there are no readings with a pose.
/// `watch` receives the number of model evaluations so far and in all.
pub fn sensor_models(simulator: &Simulator, logs: &Logs, watch: impl Fn(usize, usize) + Sync) -> Option<SensorModels> {
    let scans = Scans::new(logs);
    let n = scans.rows().count();
    if n == 0 || scans.rows().all(|row| row.echo_cm.is_none()) {
        return None;
    }
    let surfaces = Surfaces::new(logs.scene.sides());
    let networks = network_outcomes(simulator, |sensor| {
        let hit = cast(surfaces.walls(), sensor.position_cm, sensor.direction())?;
        Some([hit.distance_cm, hit.incidence_rad.abs().to_degrees()].map(|x| x as f32))
    });
    let reference = simulator.reference.as_ref();
    let beam = reference.and_then(|reference| reference.sonar.clone()).map(SensorLaw::Beam);
    let law = simulator.first_echo.clone().map(SensorLaw::FirstEcho);
    let ideal_ray = kinematic::baseline(logs).sonar;
    let models = [networks.is_some(), beam.is_some(), law.is_some(), ideal_ray.is_some()];
    let counter = Counter::new(models.iter().filter(|is_there| **is_there).count() * evaluations(&scans), watch);
    let score = |at: &(dyn Fn(&Pose) -> Outcomes + Sync)| {
        nats(logs, |sensor| {
            counter.increment();
            at(sensor)
        })
    };
    let of_law = |law: &SensorLaw| score(&|sensor| law.outcomes_at(&surfaces, sensor));
    Some(SensorModels {
        n,
        networks: networks.map(|at| score(&at)),
        beam: beam.as_ref().map(of_law),
        first_echo: law.as_ref().map(of_law),
        ideal_ray: ideal_ray.as_ref().map(of_law),
    })
}

/// Returns how often [`nats`] evaluates a model.
fn evaluations(scans: &Scans) -> usize {
    let rows = scans.rows().count();
    let of_scans: Vec<usize> =
        (0..scans.runs.len()).filter(|run| scans.is_scan(*run)).map(|run| scans.runs[run].len()).collect();
    if of_scans.is_empty() { rows } else { 2 * rows + TRIED * of_scans.iter().sum::<usize>() }
}

/// Returns the mean log-likelihood of the readings of logs, which need a row with a pose. `at` gives the distribution of the
/// reading for a pose of the sensor.
pub fn nats(logs: &Logs, at: impl Fn(&Pose) -> Outcomes + Sync) -> Nats {
    let scans = &Scans::new(logs);
    let log_likelihood = |sensor: &Pose, echo_cm: Option<f64>| at(sensor).log_likelihood(echo_cm);
    let mean = |offsets: &[Offset]| {
        let rows = scans.rows_with(offsets);
        let term = |(row, offset): &(&Heard, &Offset)| log_likelihood(&scans.sensor(&row.robot, offset), row.echo_cm);
        let terms: Vec<f64> = rows.par_iter().map(term).collect();
        terms.iter().sum::<f64>() / terms.len() as f64
    };
    let runs = scans.runs.len();
    let has_scans = (0..runs).any(|run| scans.is_scan(run));
    Nats {
        as_logged: mean(&vec![UNCHANGED; runs]),
        poses_refitted: has_scans.then(|| mean(&scans.offsets(log_likelihood))),
    }
}

/// Returns the distribution of readings of the two networks, as simulated runs draw them: an echo with the probability of the
/// first network; its value from the second plus one of the residuals; or the constant reading. Values drawn without noise get
/// that of rounding to centimetres, and random readings have the probability that the beam model gives them.
fn network_outcomes(
    simulator: &Simulator,
    axis: impl Fn(&Pose) -> Option<[f32; 2]> + Sync,
) -> Option<impl Fn(&Pose) -> Outcomes + Sync> {
    let (probability, value) = simulator.echo_probability.as_ref().zip(simulator.echo_value.as_ref())?;
    let range_cm = simulator.robot.ultrasonic?.range_cm();
    let constant = simulator.constant_reading;
    Some(move |sensor: &Pose| {
        let known = 1.0 - P_RAND;
        let mut components = Vec::new();
        let mut echo = 0.0;
        let about = |source, probability, middle_cm: f32| {
            let distribution = Distribution::Student { middle_cm: f64::from(middle_cm), scale_cm: CONSTANT_SCATTER_CM };
            Component { source, probability, distribution }
        };
        if let Some(context) = axis(sensor) {
            echo = f64::from(probability.network.evaluate(context)).clamp(0.0, 1.0);
            let p_constant = constant.map_or(0.0, |constant| f64::from(constant.probability));
            let residuals = &value.residuals.quantiles[value.residuals.cell(context)];
            let each = known * echo * (1.0 - p_constant) / residuals.len() as f64;
            let middle_cm = value.network.evaluate(context);
            components.extend(residuals.iter().map(|off_cm| about(Source::Hit, each, middle_cm + off_cm)));
            components.extend(constant.map(|c| about(Source::Constant, known * echo * p_constant, c.value_cm)));
        }
        let [low_cm, high_cm] = range_cm;
        let distribution = Distribution::Uniform { low_cm, high_cm };
        components.push(Component { source: Source::Stray, probability: 0.5 * P_RAND, distribution });
        Outcomes { none: known * (1.0 - echo) + 0.5 * P_RAND, components, range_cm }
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use mindgap_built_in_robot::{default_robot, record, training_room};
    use mindgap_logs::Row;

    #[test]
    fn progress_counts_every_model_evaluation() {
        let driven = record(&default_robot(), &training_room(), 3, 8, &[], 1).expect("logs");
        let mut scanned = driven.clone();
        let place = driven.runs[0].rows.iter().find_map(|row| row.pose);
        scanned.runs[0].rows = driven.runs[0].rows.iter().map(|row| Row { pose: place, ..row }).collect();
        for logs in [driven, scanned] {
            let times = AtomicUsize::new(0);
            nats(&logs, |_| {
                times.fetch_add(1, Ordering::Relaxed);
                Outcomes { none: 0.5, components: Vec::new(), range_cm: [5.0, 240.0] }
            });
            assert_eq!(times.into_inner(), evaluations(&Scans::new(&logs)));
        }
    }
}
