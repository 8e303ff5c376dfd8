//! Log-likelihood of held-out scans under the first-echo law.

use mindgap_learning::evaluation::sensor_models::nats;
use mindgap_learning::learn::echo_law;
use mindgap_learning::learn::scans::{Heard, Offset, Scans};
use mindgap_logs::Logs;
use mindgap_logs::inspection::Inspection;
use mindgap_models::sonar::FirstEchoLaw;
use mindgap_models::sonar::echo_law::Surfaces;

/// Mean log-likelihoods per reading over scans that are held out one by one, nats.
pub struct HeldOut {
    /// Number of readings.
    pub readings: usize,
    /// With offsets in x, y and heading that are fitted to the held-out scan itself.
    pub poses_refitted: f64,
    /// With an offset in heading only.
    pub heading_refitted: f64,
    /// With poses as logged.
    pub as_logged: f64,
}

/// Largest heading offset that is tried, in half degrees, and the prior standard deviation of the offset, degrees.
const HALF_DEGREES: i32 = 30;
const DEVIATION_DEG: f64 = 4.0;

impl HeldOut {
    /// Fits the law to all scans but one, for each scan in turn. Each run of the logs is the scan at one place.
    ///
    /// # Panics
    /// If the logs hold too few readings to fit the law.
    pub fn of(logs: Logs) -> Self {
        let logs = Inspection::new(logs).logs;
        let surfaces = Surfaces::new(logs.scene.sides());
        let mut sum = HeldOut { readings: 0, poses_refitted: 0.0, heading_refitted: 0.0, as_logged: 0.0 };
        for out in 0..logs.runs.len() {
            let mut others = logs.clone();
            let scan = Logs { runs: vec![others.runs.remove(out)], ..others.clone() };
            let law = echo_law::learn(&others, 1).expect("readings").sensor;
            let readings = Scans::new(&scan).rows().count();
            let judged = nats(&scan, |sensor| law.outcomes_at(&surfaces, sensor));
            sum.readings += readings;
            sum.poses_refitted += readings as f64 * judged.poses_refitted.expect("a scan");
            sum.heading_refitted += heading_refitted(&law, &surfaces, &scan);
            sum.as_logged += readings as f64 * judged.as_logged;
        }
        let mean = |nats: f64| nats / sum.readings as f64;
        HeldOut {
            poses_refitted: mean(sum.poses_refitted),
            heading_refitted: mean(sum.heading_refitted),
            as_logged: mean(sum.as_logged),
            ..sum
        }
    }
}

/// Returns the log-likelihood of a scan at its most probable heading offset, nats.
fn heading_refitted(law: &FirstEchoLaw, surfaces: &Surfaces, scan: &Logs) -> f64 {
    let scans = Scans::new(scan);
    let at = |half: i32| {
        let deg = 0.5 * f64::from(half);
        let offset: Offset = [0.0, 0.0, deg];
        let term =
            |row: &Heard| law.outcomes_at(surfaces, &scans.sensor(&row.robot, &offset)).log_likelihood(row.echo_cm);
        let log_likelihood: f64 = scans.rows().map(term).sum();
        let off = deg / DEVIATION_DEG;
        (scans.weight() * log_likelihood - 0.5 * off * off, log_likelihood)
    };
    let tried = (-HALF_DEGREES..=HALF_DEGREES).map(at);
    tried.fold((f64::NEG_INFINITY, 0.0), |best, tried| if tried.0 > best.0 { tried } else { best }).1
}
