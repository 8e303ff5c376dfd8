//! The textbook as a baseline: the differential drive and an ideal ray sonar from robot.toml alone, their scatter
//! estimated from the logs.

use crate::simulator::baseline::{Baseline, MotionModel};
use crate::sonar::{FirstEchoLaw, SensorLaw};
use mindgap_foundations::statistics::summary::QUARTILE;
use mindgap_logs::{Logs, samples};

/// The least scatter of forward (cm), lateral (cm) and turn (rad): that of a good tracker. The logs' own is refitted
/// upwards from here.
const LEAST_SCATTER: [f64; 3] = [0.1, 0.1, 0.005];
/// The same where whole ways are compared: the tracker's error is there at both ends alone, the robot's own adds up from
/// step to step.
const LEAST_OWN_SCATTER: [f64; 3] = [0.1, 0.1, 0.001];
/// Bounds of the estimated scatter of readings, cm.
const READING_SCATTER_CM: [f64; 2] = [0.5, 4.0];

/// The baseline of a robot that nobody has logged before.
pub fn baseline(logs: &Logs) -> Baseline<'static> {
    let scatter = if samples::motion(logs).is_empty() { LEAST_OWN_SCATTER } else { LEAST_SCATTER };
    Baseline {
        motion: Some(MotionModel::Kinematic { robot: logs.robot, scatter }),
        sonar: sonar(logs),
        place_bound: [0.0; 2],
        familiar: None,
        applied: Vec::new(),
    }
}

fn sonar(logs: &Logs) -> Option<SensorLaw> {
    let seen = samples::sonar(logs);
    let mount = &logs.robot.ultrasonic;
    let mut errors_cm: Vec<f64> = seen.iter().filter_map(|s| Some((s.echo_cm? - s.distance_cm).abs())).collect();
    if errors_cm.is_empty() {
        return None;
    }
    errors_cm.sort_by(f64::total_cmp);
    let scatter_cm = errors_cm[errors_cm.len() / 2] / QUARTILE;
    let [least, most] = READING_SCATTER_CM;
    let within = seen.iter().filter(|s| s.distance_cm < mount.max_cm);
    let (echoes, all) = within.fold((0.0, 0.0), |(e, n), s| (e + f64::from(u8::from(s.echo_cm.is_some())), n + 1.0));
    let p_dropout = 1.0 - echoes / f64::max(all, 1.0);
    let range_cm = [mount.min_cm, mount.max_cm];
    Some(SensorLaw::FirstEcho(FirstEchoLaw::ideal_ray(scatter_cm.clamp(least, most), p_dropout, range_cm)))
}
