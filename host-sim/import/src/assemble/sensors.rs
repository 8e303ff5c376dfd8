//! The range sensors whose readings become columns.

use std::sync::Arc;

use crate::recording::Recording;
use mindgap_logs::range_sensor::{Sensors, column_of};

/// Keeps the further range sensors that were heard in all recordings, since an empty column would be one of a sensor that hears
/// nothing. Returns the sensors that remain, and a line for each of the others.
pub fn heard(recordings: &mut [Recording], sensors: Sensors) -> (Arc<Sensors>, Vec<String>) {
    let all = recordings.len();
    let (mut further, mut places, mut silent) = (Vec::new(), vec![Some(0)], Vec::new());
    for (index, sensor) in (1..).zip(sensors.further()) {
        let of_sensor = |recording: &&Recording| recording.readings.iter().any(|readings| readings.sensor == index);
        let count = recordings.iter().filter(of_sensor).count();
        if count == all {
            further.push(sensor.clone());
            places.push(Some(further.len()));
            continue;
        }
        places.push(None);
        let what =
            if count == 0 { "no readings".into() } else { format!("readings in {count} of {all} recordings only") };
        let (name, column) = (&sensor.name, column_of(&sensor.name));
        silent.push(format!("range sensor {name} of robot.toml has {what}: {column} is not written"));
    }
    for readings in recordings.iter_mut().map(|recording| &mut recording.readings) {
        readings.retain_mut(|readings| match places.get(readings.sensor) {
            Some(Some(place)) => {
                readings.sensor = *place;
                true
            }
            _ => false,
        });
    }
    (Arc::new(Sensors::new(sensors.first_table().map(str::to_owned), further)), silent)
}
