//! Finds the range sensor that a name of a column, file, topic or frame names, and the sensors whose readings become columns.

use super::words::{contains, words};
use mindgap_logs::range_sensor::{RangeSensor, Sensors, column_of};

/// Returns the index of the sensor whose name a text contains; of `left` and `front_left`, the one with more words. `None` if
/// there is none, or if several are equally good.
pub fn named(sensors: &[RangeSensor], text: &str) -> Option<usize> {
    let found = || sensors.iter().enumerate().filter(|(_, sensor)| contains(text, &sensor.name));
    let length = |sensor: &RangeSensor| words(&sensor.name).len();
    let longest = found().map(|(_, sensor)| length(sensor)).max()?;
    let mut best = found().filter(|(_, sensor)| length(sensor) == longest);
    best.next().map(|(index, _)| index).filter(|_| best.next().is_none())
}

/// Keeps the further range sensors that were heard in `all` recordings, since an empty column would be one of a sensor that hears
/// nothing; `count` returns in how many the sensor of an index was. Returns the sensors that remain, and a line for each of the others.
pub fn heard_in_all(sensors: &Sensors, all: usize, count: impl Fn(usize) -> usize) -> (Sensors, Vec<String>) {
    let counted = || sensors.further().iter().zip(1..).map(|(sensor, index)| (count(index), sensor));
    let kept = counted().filter(|(count, _)| *count == all).map(|(_, sensor)| sensor.clone()).collect();
    let silent = counted().filter(|(count, _)| *count < all).map(|(count, RangeSensor { name, .. })| {
        let what =
            if count == 0 { "no readings".into() } else { format!("readings in {count} of {all} recordings only") };
        format!("range sensor {name} of robot.toml has {what}: {} is not written", column_of(name))
    });
    (Sensors::new(sensors.first_table().map(str::to_owned), kept), silent.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_logs::Ultrasonic;

    #[test]
    fn the_longest_name_decides() {
        let mount = Ultrasonic { x_cm: 0.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 4.0, max_cm: 250.0 };
        let sensors = ["ultrasonic", "left", "front_left", "right"].map(|name| RangeSensor::new(name.into(), mount));
        for (text, index) in [
            ("/sonar_left/range", Some(1)),
            ("/sonar/frontLeft", Some(2)),
            ("sonar_right_link", Some(3)),
            ("ultrasonic", Some(0)),
            ("range_m", None),
            ("leftover", None),
            ("left_to_right", None),
        ] {
            assert_eq!(named(&sensors, text), index, "{text}");
        }
    }
}
