//! The range sensors whose readings become columns.

use std::sync::Arc;

use crate::range_sensors::heard_in_all;
use crate::recording::Recording;
use mindgap_logs::range_sensor::Sensors;

/// Keeps the range sensors that were heard in all recordings. Returns the sensors that remain, and a line for each of the others.
pub fn heard(recordings: &mut [Recording], sensors: &Sensors) -> (Arc<Sensors>, Vec<String>) {
    let heard = |index: usize| {
        let of_sensor = |recording: &&Recording| recording.readings.iter().any(|readings| readings.sensor == index);
        recordings.iter().filter(of_sensor).count()
    };
    let (kept, silent) = heard_in_all(sensors, recordings.len(), heard);
    let place = |index: usize| {
        let Some(further) = index.checked_sub(1) else { return Some(0) };
        let sensor = sensors.further().get(further)?;
        kept.further().iter().position(|kept| kept.name == sensor.name).map(|place| 1 + place)
    };
    for recording in recordings {
        recording.readings.retain_mut(|readings| {
            let place = place(readings.sensor);
            readings.sensor = place.unwrap_or_default();
            place.is_some()
        });
    }
    (Arc::new(kept), silent)
}
