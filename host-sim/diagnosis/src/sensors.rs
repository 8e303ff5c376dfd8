//! Robots with several range sensors. Motion and the first sensor are diagnosed together, as on a robot with one. Each further
//! sensor is then diagnosed by its own readings, by the same stages: what was found before and acts on every sensor, such as a
//! turned frame of the tracker, is applied, and only what sits in a sensor competes. The results join one diagnosis.

mod join;

use super::diagnose::{Findings, findings};
use super::method::Method;
use super::scope::NotCompared;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::error::Result;
use mindgap_logs::Logs;
use mindgap_logs::heard::Heard;
use mindgap_logs::inspection::{Inspection, Part};
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::{Candidate, Place};
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::further_sensor::Matched;
use mindgap_models::simulator::{Simulator, kinematic};

const NO_READINGS: &str = "There are no readings: the sonar is not compared.";
const NO_MODEL: &str =
    "The simulator has no model of the sonar, since its training logs had too few readings: the sonar is not compared.";

/// What the readings of a further sensor show.
struct Further {
    sensor: String,
    /// What was found, or why nothing was compared.
    found: std::result::Result<Findings, String>,
}

/// What further sensors are compared with, and how.
pub struct Comparison<'a> {
    /// The simulator, or `None` for the textbook.
    pub simulator: Option<&'a Simulator>,
    /// The settings.
    pub method: Method,
    /// Resamples logs to the steps that are compared.
    pub in_steps: &'a dyn Fn(Logs) -> Result<Logs>,
}

/// Adds the further range sensors to what was found of the motion and the first sensor; `heard` has the first sensor first.
///
/// # Errors
/// When the first sensors of simulator and logs differ.
pub fn with_further(main: Findings, heard: &[Heard], comparison: &Comparison) -> Result<Findings> {
    let common = common_effects(&main);
    let of_sensor = |matched: Matched| {
        let compared = matched.compared.map_err(|why| format!("{why}."));
        let found = compared.and_then(|compared| diagnosed(Some(&compared.0), compared.1, &common, comparison));
        Further { sensor: matched.sensor, found }
    };
    let of_textbook = |Heard { sensor, logs }: &Heard| Further {
        sensor: sensor.clone(),
        found: diagnosed(None, logs, &common, comparison),
    };
    let further: Vec<Further> = match comparison.simulator {
        Some(simulator) => simulator.matched(heard)?.into_iter().map(of_sensor).collect(),
        None => heard[1..].iter().map(of_textbook).collect(),
    };
    Ok(further.into_iter().fold(join::named(main, &heard[0].sensor), join::joined))
}

/// Returns the effects that act on the readings of every sensor.
fn common_effects(main: &Findings) -> Vec<AppliedEffect> {
    let senses = |candidate: &Candidate| candidate.variant.senses();
    let is_common = |effect: &&AppliedEffect| {
        !effect.is_of_sensor() && effect.resolve(&main.robot).is_ok_and(|(candidate, _)| senses(&candidate))
    };
    main.applied.iter().filter(is_common).cloned().collect()
}

/// Diagnoses the readings alone, against the simulator of a robot with this sensor or against the textbook.
fn diagnosed(
    simulator: Option<&Simulator>,
    logs: &Logs,
    common: &[AppliedEffect],
    comparison: &Comparison,
) -> std::result::Result<Findings, String> {
    let mut inspected = Inspection::new(logs.clone());
    inspected.logs = (comparison.in_steps)(inspected.logs).map_err(|error| error.to_string())?;
    if let Some(why) = inspected.withheld(Part::Sonar) {
        return Err(why.into());
    }
    if inspected.logs.runs.iter().flat_map(|run| &run.rows).all(|row| row.echo_cm.is_none()) {
        return Err(NO_READINGS.into());
    }
    let learned = simulator.map(Baseline::learned).transpose().map_err(|error| error.to_string())?;
    let mut baseline = learned.unwrap_or_else(|| kinematic::baseline(&inspected.logs));
    if baseline.sonar.is_none() {
        return Err(NO_MODEL.into());
    }
    baseline.motion = None;
    baseline.applied.extend_from_slice(common);
    let method = Method { place: Some(Place::Sensor), ..comparison.method };
    findings(baseline, &inspected, method).map_err(|error| error.to_string())
}

/// The channels of a sensor that was not compared.
fn not_compared(sensor: &str, reason: &str) -> impl Iterator<Item = NotCompared> {
    let [sensor, reason] = [sensor, reason].map(str::to_owned);
    let of = move |channel| NotCompared { channel, reason: reason.clone(), sensor: Some(sensor.clone()) };
    Channel::SONAR.into_iter().map(of)
}
