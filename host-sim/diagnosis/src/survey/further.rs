//! What logs of several range sensors hold of each further one.

use super::holdings::Heard;
use super::{Survey, advice, enough_of, in_steps_that_motion_shows_in};
use crate::diagnose::{Prospect, prospect};
use crate::method::Method;
use mindgap_learning::learn::train;
use mindgap_logs::heard;
use mindgap_logs::inspection::Inspection;
use mindgap_models::effects::{Place, catalogue};
use mindgap_models::simulator::{Missing, kinematic};

/// Puts the name of the first sensor on what concerns it.
pub fn name_first(survey: &mut Survey, sensor: &str) {
    let is_own = |id: &str| catalogue::place(id) == Some(Place::Sensor);
    let own = survey.holds.detectable.iter_mut().filter(|of| is_own(of.id));
    own.for_each(|of| of.sensor = Some(sensor.into()));
}

/// Adds a further sensor.
pub fn add(survey: &mut Survey, of: heard::Heard) {
    let heard::Heard { sensor, logs } = of;
    let named = |sentence: String| format!("Range sensor {sensor}: {sentence}");
    let mut inspected = Inspection::new(logs);
    if survey.refused.is_none() {
        survey.refused = inspected.refusal().map(|why| named(why.into()));
    }
    let holds = Heard::of(&inspected.logs, sensor.clone());
    if let (Some(mount), Some(distance_cm), Some(alpha_deg)) =
        (&inspected.logs.robot.ultrasonic, holds.distance_cm, holds.alpha_deg)
    {
        survey.drive_more.extend(advice::of_sensor(mount, distance_cm, alpha_deg).into_iter().map(named));
    }
    survey.holds.sensors.push(holds);
    let enough = enough_of(&inspected.logs);
    let missing = train::unsupported(&enough).into_iter().filter(|missing| missing.network.starts_with("echo"));
    let missing = missing.map(|of| Missing { network: Missing::network_of(&of.network, &sensor), ..of });
    survey.missing_networks.extend(missing);
    inspected.logs = in_steps_that_motion_shows_in(&inspected.logs).map_or(enough, |coarse| enough_of(&coarse));
    let found = std::mem::take(&mut inspected.findings);
    if let Some(Prospect { untestable, detectable, .. }) = shown(inspected) {
        let of_sensor = detectable.into_iter().map(|mut of| {
            of.sensor = Some(sensor.clone());
            of
        });
        survey.holds.detectable.extend(of_sensor);
        if !untestable.is_empty() {
            survey.drive_more.push(named(format!("not excited: {}.", untestable.join(", "))));
        }
    }
    let is_new = |known: &Survey, finding: &_| !known.findings.contains(finding);
    let found: Vec<_> = found.into_iter().filter(|finding| is_new(survey, finding)).collect();
    survey.findings.extend(found.into_iter().map(|finding| finding.of_sensor(&sensor)));
}

/// What a diagnosis of the readings alone could show; `None` without readings.
fn shown(inspected: Inspection) -> Option<Prospect> {
    let mut baseline = kinematic::baseline(&inspected.logs);
    baseline.motion = None;
    let method = Method { place: Some(Place::Sensor), ..Method::default() };
    prospect(baseline, &inspected, method).ok()
}
