//! The topics of range sensors, and their readings.

use std::collections::BTreeMap;

use super::Stream;
use super::messages::{Beam, Decoded, Reading, of_part};
use super::roles::{Choice, NONE, Role, Unused, guess, near_to, of_type, selected};
use crate::left_out::LeftOut;
use crate::range_sensors::named;
use crate::recording::Echoes;
use mindgap_logs::Ultrasonic;
use mindgap_logs::range_sensor::{RangeSensor, ULTRASONIC};

/// Range sensors with the names of their streams.
pub type Ranges = Vec<(usize, String)>;

/// Returns the beams of a laser scanner that stand in for range sensors.
pub fn beams(sensors: &[RangeSensor]) -> Vec<Beam> {
    match sensors {
        [] => vec![Beam { suffix: String::new(), yaw_rad: 0.0 }],
        [one] => vec![Beam { suffix: String::new(), yaw_rad: one.yaw_deg.to_radians() }],
        several => several
            .iter()
            .map(|sensor| Beam { suffix: of_part(&sensor.name), yaw_rad: sensor.yaw_deg.to_radians() })
            .collect(),
    }
}

/// Chooses the streams of the range sensors. `commands` is the topic of the commands, whose robot is preferred.
///
/// # Errors
/// When a topic or sensor named by the user is missing, or a sensor could have several topics.
pub fn choose(
    streams: &BTreeMap<String, Stream>,
    choice: &Choice,
    sensors: &[RangeSensor],
    commands: &str,
) -> Result<(Ranges, Vec<String>, Unused), String> {
    let is_unknown = |name: &&String| !sensors.iter().any(|sensor| sensor.name == **name);
    if let Some(name) = choice.ranges.iter().filter_map(|(sensor, _)| sensor.as_ref()).find(is_unknown) {
        return Err(format!("cannot be read with --ranges {name}=TOPIC: robot.toml has no range sensor {name:?}"));
    }
    if let [_, _, ..] = sensors {
        let ranges = of_several(streams, choice, sensors, commands)?;
        let others = of_type(streams, "/Range").filter(|name| !ranges.iter().any(|(_, used)| used == name));
        let reason = "names no range sensor of robot.toml; choose it with --ranges NAME=TOPIC";
        let unused = others.map(|name| (name.to_owned(), reason.to_owned())).collect();
        return Ok((ranges, Vec::new(), unused));
    }
    let found = match choice.ranges.first() {
        Some((_, topic)) if topic == NONE => None,
        Some((_, topic)) => Some((selected(streams, Role::Readings, topic)?, None)),
        None => guess(streams, Role::Readings, commands)?,
    };
    let (name, guessed) = found.unzip();
    let ranges = name.map(|name| (0, name)).into_iter().collect();
    Ok((ranges, guessed.flatten().into_iter().collect(), Vec::new()))
}

/// Chooses a stream for each sensor that has one: that named by the user, a topic or frame with the sensor's name, the only topic
/// that names no sensor, or the beam of a laser scanner.
fn of_several(
    streams: &BTreeMap<String, Stream>,
    choice: &Choice,
    sensors: &[RangeSensor],
    commands: &str,
) -> Result<Ranges, String> {
    let mut ranges = Ranges::new();
    let mut is_open = vec![true; sensors.len()];
    for (sensor, topic) in &choice.ranges {
        let index = sensors.iter().position(|s| sensor.as_ref().is_some_and(|name| s.name == *name)).unwrap_or(0);
        if topic == NONE && sensor.is_none() {
            return Ok(Ranges::new());
        }
        is_open[index] = false;
        if topic != NONE {
            let beam = topic.clone() + &of_part(&sensors[index].name);
            let name = if streams.contains_key(&beam) { &beam } else { topic };
            ranges.push((index, selected(streams, Role::Readings, name)?));
        }
    }
    let mut free: Vec<(Option<usize>, &str)> = of_type(streams, "/Range")
        .filter(|name| !ranges.iter().any(|(_, taken)| taken == name))
        .map(|name| (named(sensors, name).or_else(|| named(sensors, &streams[name].frame)), name))
        .collect();
    free.sort_unstable();
    for index in 0..sensors.len() {
        let own = free.iter().filter(|(sensor, _)| *sensor == Some(index)).map(|(_, name)| *name).collect::<Vec<_>>();
        if is_open[index] && !own.is_empty() {
            ranges.push((index, one_of(&own, &sensors[index], commands)?));
            is_open[index] = false;
        }
    }
    let unnamed: Vec<&str> = free.iter().filter(|(sensor, _)| sensor.is_none()).map(|(_, name)| *name).collect();
    let open: Vec<usize> = (0..sensors.len()).filter(|index| is_open[*index]).collect();
    let usual = open.iter().copied().find(|index| sensors[*index].name == ULTRASONIC);
    if let ([name], Some(index)) = (unnamed.as_slice(), usual.or(open.first().copied().filter(|_| open.len() == 1))) {
        ranges.push((index, (*name).to_owned()));
        is_open[index] = false;
    }
    for index in open {
        let suffix = of_part(&sensors[index].name);
        let beams: Vec<&str> = of_type(streams, "/LaserScan").filter(|name| name.ends_with(&suffix)).collect();
        if is_open[index] && !beams.is_empty() {
            ranges.push((index, one_of(&beams, &sensors[index], commands)?));
        }
    }
    ranges.sort_unstable();
    Ok(ranges)
}

/// Returns the only stream, or the only one of the robot whose commands these are.
fn one_of(names: &[&str], sensor: &RangeSensor, commands: &str) -> Result<String, String> {
    let name = near_to(names, commands).map(str::to_owned);
    name.ok_or_else(|| {
        let sensor = &sensor.name;
        format!("range sensor {sensor} could be any of {}; select one with --ranges {sensor}=TOPIC", names.join(", "))
    })
}

/// Returns the readings within their limits, which limits were used, and what was left out.
pub fn within_limits(samples: &[(f64, Decoded)], sensor: Option<&Ultrasonic>) -> (Echoes, Vec<String>, Vec<LeftOut>) {
    let (mut unlimited, mut beyond, mut outside) = (0, 0, 0);
    let of_robot = |cm: f64| sensor.is_none_or(|sensor| (sensor.min_cm..=sensor.max_cm).contains(&cm));
    let timed = samples.iter().filter_map(|(ms, value)| match value {
        Decoded::Range(Reading::Echo(cm)) => Some((*ms, Some(*cm))),
        Decoded::Range(Reading::None) => Some((*ms, None)),
        Decoded::Range(Reading::Outside(_)) => {
            outside += 1;
            Some((*ms, None))
        }
        Decoded::Range(Reading::Unlimited(cm)) => {
            unlimited += 1;
            beyond += usize::from(!of_robot(*cm));
            // Negative numbers may be bytes whose sign was misread, which is checked later.
            Some((*ms, Some(*cm).filter(|cm| of_robot(*cm) || *cm < 0.0)))
        }
        _ => None,
    });
    let timed: Echoes = timed.collect();
    let limits = match sensor {
        Some(sensor) => format!("those of robot.toml apply, {} to {} cm", sensor.min_cm, sensor.max_cm),
        None => "all readings were taken".into(),
    };
    let noted = (unlimited > 0).then(|| format!("{unlimited} messages set no limits (min_range, max_range): {limits}"));
    let counted = |count: usize, reason: &str| (count > 0).then(|| LeftOut::rows("reading", count, reason));
    let left_out = [
        counted(outside, "outside the limits that the messages state (min_range, max_range): no echo"),
        counted(beyond, "outside the limits of robot.toml: no echo"),
    ];
    (timed, noted.into_iter().collect(), left_out.into_iter().flatten().collect())
}
