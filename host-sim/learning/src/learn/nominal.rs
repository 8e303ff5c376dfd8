//! Learns the reference of a simulator: its nominal behaviour beyond the networks, relative to which the gap is measured.

use super::feature_regression::{self, fold};
use super::{beam, drive_filter, familiar, place_bound, sensor_law, wheels};
use mindgap_foundations::motion::Motion;
use mindgap_logs::{Logs, samples};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::ensemble::CommandScale;
use mindgap_models::simulator::nominal::NominalModel;
use mindgap_models::simulator::nominal::motion_bias::{MotionBias, Precision, features, products};
use mindgap_models::simulator::residuals::ConstantReading;
use mindgap_models::sonar::{FirstEchoLaw, SensorLaw};

/// Ratios of noise variance to prior variance that are tried. At the first, a thousand steps hold half a standard deviation
/// of the noise; at the last, the prior is wide even for bends that only slow wheels pass.
const STRENGTHS: [f64; 9] = [1000.0, 215.0, 46.0, 10.0, 2.15, 0.46, 0.1, 0.02, 0.004];
/// Minimum number of samples, about the number of features.
const FEWEST: usize = 100;

/// Learns the reference of a simulator with trained networks from its training logs; `first_echo` is the law of its sensor
/// with poses as logged.
pub fn learn(simulator: &Simulator, first_echo: Option<FirstEchoLaw>, logs: &Logs) -> NominalModel {
    let sonar = learn_sonar(simulator.constant_reading, first_echo, logs);
    NominalModel { motion: motion(simulator, logs), wheels: wheels::learn(simulator, logs), ..sonar }
}

/// Learns the same of a range sensor alone, whose networks show this constant reading.
pub fn learn_sonar(
    constant_reading: Option<ConstantReading>,
    first_echo: Option<FirstEchoLaw>,
    logs: &Logs,
) -> NominalModel {
    let sonar = beam::learn(constant_reading, logs);
    let with_seen = |law: SensorLaw| {
        let seen = place_bound::seen(&law, logs);
        (law, seen)
    };
    let by_beam = sonar.clone().map(|beam| with_seen(SensorLaw::Beam(beam)));
    let prefers_first_echo = |law: &FirstEchoLaw| {
        sonar.as_ref().zip(by_beam.as_ref()).is_some_and(|(beam, (_, seen))| {
            let [at_place, _] = place_bound::learn(seen);
            sensor_law::prefers_first_echo(law, beam, at_place, logs)
        })
    };
    let first_echo = first_echo.filter(prefers_first_echo);
    let (law, seen) = first_echo.clone().map(|law| with_seen(SensorLaw::FirstEcho(law))).or(by_beam).unzip();
    let seen = seen.unwrap_or_default();
    let familiar = law.as_ref().and_then(|law| familiar::learn(law, &seen, &logs.scene));
    let place_bound = place_bound::learn(&seen);
    NominalModel { motion: None, wheels: None, sonar, first_echo, place_bound, familiar }
}

fn motion(simulator: &Simulator, logs: &Logs) -> Option<MotionBias> {
    let networks = simulator.motion_networks()?;
    let steps: Vec<samples::MotionSample> = drive_filter::steps(simulator.filter, logs).collect();
    if steps.len() < FEWEST {
        return None;
    }
    let scale = CommandScale::of(simulator.commands);
    let rows: Vec<Vec<f64>> = steps.iter().map(|s| features(s.speeds, scale.share()).to_vec()).collect();
    let folds: Vec<usize> = steps.iter().map(|s| fold(logs, s.run, s.row)).collect();
    let residuals: Vec<Motion<f64>> = steps.iter().map(|s| networks.residual(s)).collect();
    let fits = Motion::from_fn(|axis| feature_regression::fit(&rows, &folds, &STRENGTHS, |i| residuals[i][axis]));
    // Absurd commands make the products overflow.
    let products = Some(products(&rows)).filter(|products| products.iter().all(|product| product.is_finite()));
    let precision = products.map(|products| Precision { products, prior: fits.each_ref().map(|fit| fit.strength) });
    let scatter = fits.each_ref().map(|fit| fit.scatter);
    Some(MotionBias { scale, scatter, precision, weights: fits.map(|fit| fit.weights) })
}
