//! What the robot measures of its own motion: joints of the wheels, and an IMU.

use std::collections::BTreeMap;

use glam::DVec3;

use super::Stream;
use super::messages::{Decoded, of_part};
use super::roles::{Choice, NONE, Unused, near_to, of_type};
use crate::joints::{Wheels, wheels};

/// The streams of the wheels and of the gyro.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnStreams {
    /// Joints of the left and of the right wheels.
    pub wheels: Wheels,
    pub gyro: Option<String>,
}

const CHOOSE_JOINTS: &str = "choose joints with --left-joint and --right-joint";
/// Words in the names of topics with desired rather than measured angles.
const DESIRED: [&str; 4] = ["command", "cmd", "desired", "target"];
/// Acceleration of gravity with a margin for its calibration and the driving, m/s².
const GRAVITY_M_S2: std::ops::Range<f64> = 7.0..12.5;

impl OwnStreams {
    /// Returns the names of all streams.
    pub fn all(&self) -> impl Iterator<Item = &String> {
        self.wheels.iter().flatten().chain(&self.gyro)
    }
}

/// Chooses the streams; `commands` is the topic of the commands, whose robot is preferred. `unused` receives the others, with the
/// reason.
///
/// # Errors
/// When a topic or joint named by the user is missing.
pub fn choose(
    streams: &BTreeMap<String, Stream>,
    choice: &Choice,
    commands: &str,
    unused: &mut Unused,
) -> Result<OwnStreams, String> {
    let gyro = gyro(streams, choice.gyro.as_deref(), commands, unused)?;
    let joints = joints_by_topic(streams);
    let wheels = match &choice.wheels {
        [left, right] if left.is_empty() && right.is_empty() => guessed(&joints, commands, unused),
        [left, right] if left.is_empty() || right.is_empty() => {
            return Err("has joints of one side only: give both --left-joint and --right-joint".into());
        }
        [left, right] => [stated(left, &joints)?, stated(right, &joints)?],
    };
    let is_used = |name: &String| wheels.iter().flatten().any(|wheel| wheel == name);
    for (topic, names) in &joints {
        let others = names.iter().map(|joint| full_name(topic, joint)).filter(|name| !is_used(name));
        let is_reported = unused.iter().any(|(name, _)| name == topic);
        unused.extend(
            others
                .filter(|_| !is_reported)
                .map(|name| (name, format!("not taken for a driven wheel; {CHOOSE_JOINTS}"))),
        );
    }
    Ok(OwnStreams { wheels, gyro })
}

/// Returns the yaw rates of an IMU, rad/s, and what is unusual about its mounting. The accelerometer shows which of its axes
/// points upwards (REP 145: at rest it measures gravity as an acceleration upwards).
pub fn yaw_rates(samples: &[(f64, Decoded)]) -> (Vec<(f64, f64)>, Option<String>) {
    let inertial = samples.iter().filter_map(|(ms, value)| match value {
        Decoded::Inertial { rate_rad_s, acceleration_m_s2 } => Some((*ms, *rate_rad_s, *acceleration_m_s2)),
        _ => None,
    });
    let sum: DVec3 = inertial.clone().map(|(.., acceleration)| acceleration).sum();
    let mean = sum / samples.len().max(1) as f64;
    let shown = Some(mean).filter(|mean| GRAVITY_M_S2.contains(&mean.length()));
    let (axis, sign) = shown.map_or((2, 1.0), |up| {
        let axis = up.abs().max_position();
        (axis, up[axis].signum())
    });
    let rates = inertial.map(|(ms, rate, _)| (ms, sign * rate[axis])).collect();
    let name = ["x", "y", "z"][axis];
    let down = if sign < 0.0 { "downwards" } else { "upwards" };
    (
        rates,
        (axis != 2 || sign < 0.0).then(|| format!("the accelerometer shows that the IMU's {name} axis points {down}")),
    )
}

fn gyro(
    streams: &BTreeMap<String, Stream>,
    named: Option<&str>,
    commands: &str,
    unused: &mut Unused,
) -> Result<Option<String>, String> {
    let imus: Vec<&str> = of_type(streams, "/Imu").collect();
    if let Some(named) = named {
        let is_found = named == NONE || imus.contains(&named);
        let is_other = |name: &&str| *name != named;
        unused.extend(imus.iter().copied().filter(is_other).map(|name| {
            let reason = "another topic is chosen with --gyro";
            (name.to_owned(), reason.to_owned())
        }));
        let what = || format!("{named} is not a topic of a gyro (sensor_msgs/Imu): those are {}", imus.join(", "));
        return if is_found { Ok(Some(named.to_owned()).filter(|name| name != NONE)) } else { Err(what()) };
    }
    let processed: Vec<&str> = imus.iter().copied().filter(|name| !name.contains("raw")).collect();
    let chosen = near_to(&imus, commands).or_else(|| near_to(&processed, commands));
    let others = imus.iter().copied().filter(|name| Some(*name) != chosen);
    let reason = match chosen {
        Some(chosen) => format!("{chosen} was chosen; select another with --gyro TOPIC"),
        None => format!("the gyro could be any of {}; select one with --gyro TOPIC", imus.join(", ")),
    };
    unused.extend(others.map(|name| (name.to_owned(), reason.clone())));
    Ok(chosen.map(str::to_owned))
}

/// Returns the wheels whose names show the side, of the topic that has some.
fn guessed(joints: &BTreeMap<&str, Vec<&str>>, commands: &str, unused: &mut Unused) -> Wheels {
    let found: BTreeMap<&str, Wheels> =
        joints.iter().filter_map(|(topic, names)| Some((*topic, wheels(names.iter().copied())?))).collect();
    let topics: Vec<&str> = found.keys().copied().collect();
    let measured: Vec<&str> =
        topics.iter().copied().filter(|topic| !DESIRED.iter().any(|word| topic.contains(word))).collect();
    let chosen = near_to(&topics, commands).or_else(|| near_to(&measured, commands));
    for (topic, names) in joints.iter().filter(|(topic, _)| Some(**topic) != chosen) {
        let reason = if !found.contains_key(topic) {
            format!(
                "no pair of left and right wheels by the names of its joints ({}); {CHOOSE_JOINTS}",
                names.join(", ")
            )
        } else if let Some(chosen) = chosen {
            format!("the wheels of {chosen} were chosen; {CHOOSE_JOINTS}, as in {topic}:{}", names[0])
        } else {
            format!("wheels are in several topics ({}); {CHOOSE_JOINTS}, as in {topic}:{}", topics.join(", "), names[0])
        };
        unused.push(((*topic).to_owned(), reason));
    }
    let of_topic =
        |topic: &str| found[topic].each_ref().map(|side| side.iter().map(|joint| full_name(topic, joint)).collect());
    chosen.map(of_topic).unwrap_or_default()
}

/// Returns the name of a joint's stream.
fn full_name(topic: &str, joint: &str) -> String {
    topic.to_owned() + &of_part(joint)
}

/// Returns the streams of joints that the user names, possibly after their topic.
fn stated(named: &[String], joints: &BTreeMap<&str, Vec<&str>>) -> Result<Vec<String>, String> {
    let all = || joints.iter().flat_map(|(topic, names)| names.iter().map(move |joint| (*topic, *joint)));
    let stream = |name: &String| {
        let full = |(topic, joint)| full_name(topic, joint);
        let found: Vec<String> =
            all().filter(|(topic, joint)| joint == name || full((topic, joint)) == *name).map(full).collect();
        match found.as_slice() {
            [one] => Ok(one.clone()),
            [] => Err(format!(
                "has no joint {name}: those with positions are {}",
                if joints.is_empty() { "none".into() } else { all().map(full).collect::<Vec<_>>().join(", ") }
            )),
            several => Err(format!("has joint {name} in several topics: write one of {}", several.join(", "))),
        }
    };
    named.iter().map(stream).collect()
}

/// Returns the names of the joints by topic, sorted.
fn joints_by_topic(streams: &BTreeMap<String, Stream>) -> BTreeMap<&str, Vec<&str>> {
    let mut joints: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (topic, joint) in of_type(streams, "/JointState").filter_map(|name| name.split_once(':')) {
        joints.entry(topic).or_default().push(joint);
    }
    joints
}
