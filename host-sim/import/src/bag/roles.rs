//! What the topics of a bag can be used for, and which of several is the best.

use std::collections::BTreeMap;

use super::Stream;

/// Topics selected by the user; the others are guessed.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// Topic of commands.
    pub commands: Option<String>,
    /// Topic of poses; for transforms with parent and child frame, as in `/tf:map>base_link`.
    pub poses: Option<String>,
    /// Topics of readings, each with the name of its range sensor unless it is the first; `none` for no readings.
    pub ranges: Vec<(Option<String>, String)>,
    /// Topic of the gyro; `none` for no gyro.
    pub gyro: Option<String>,
    /// Joints of the left and of the right wheels, possibly after their topic, as in `/joint_states:wheel_left`.
    pub wheels: [Vec<String>; 2],
}

/// The choice of no topic.
pub const NONE: &str = "none";
/// Names of streams that are not used, with the reason.
pub type Unused = Vec<(String, String)>;

/// Fixed frames.
const FIXED: [&str; 6] = ["map", "world", "mocap", "vicon", "optitrack", "earth"];
/// Frames of a robot's body.
const BODY: [&str; 3] = ["base_link", "base_footprint", "base"];
/// Words in the names of desired rather than actual poses.
const DESIRED: [&str; 4] = ["goal", "target", "initialpose", "setpoint"];
/// Words in the names of measured rather than commanded velocities.
const MEASURED: [&str; 11] =
    ["odom", "measured", "actual", "current", "feedback", "state", "estimate", "imu", "gps", "mocap", "ground_truth"];
/// Maximum number of topics named in a message.
const MAX_NAMED: usize = 8;

/// Returns whether a frame is fixed.
pub fn is_fixed(frame: &str) -> bool {
    FIXED.contains(&without_namespace(frame))
}

/// Returns whether a frame belongs to a robot's body.
pub fn is_body(frame: &str) -> bool {
    BODY.contains(&without_namespace(frame))
}

/// Returns a frame's name without the robot's namespace.
fn without_namespace(frame: &str) -> &str {
    frame.rsplit('/').next().unwrap_or_default()
}

/// What a stream can be used for.
#[derive(Clone, Copy, PartialEq)]
pub enum Role {
    Commands,
    Poses,
    Readings,
}

impl Role {
    fn of(schema: &str) -> Option<Self> {
        match schema.rsplit('/').next()? {
            "Twist" | "TwistStamped" => Some(Role::Commands),
            "PoseStamped" | "PoseWithCovarianceStamped" | "Odometry" | "TFMessage" | "tfMessage" => Some(Role::Poses),
            "Range" | "LaserScan" => Some(Role::Readings),
            _ => None,
        }
    }

    /// Returns its name, with the types of messages.
    pub fn name(self) -> &'static str {
        match self {
            Role::Commands => "commands (geometry_msgs/Twist or TwistStamped)",
            Role::Poses => "poses (PoseStamped, Odometry or tf)",
            Role::Readings => "readings (Range or LaserScan)",
        }
    }

    /// Returns the option with which the user chooses a topic.
    pub fn option(self) -> &'static str {
        match self {
            Role::Commands => "--commands TOPIC",
            Role::Poses => "--poses TOPIC",
            Role::Readings => "--ranges TOPIC",
        }
    }

    /// Ranks a stream for this role: the smallest rank is the best; `None` if it is unsuitable.
    fn rank(self, name: &str, schema: &str) -> Option<u32> {
        let last = name.rsplit('/').next().unwrap_or_default();
        match (self, schema.rsplit('/').next()?) {
            (Role::Commands, _) if last == "cmd_vel" => Some(0),
            (Role::Commands, _) => (!MEASURED.iter().any(|word| name.contains(word))).then_some(1),
            (Role::Poses, "TFMessage" | "tfMessage") => {
                let (parent, child) = name.rsplit_once(':')?.1.split_once('>')?;
                match (is_fixed(parent), is_body(child)) {
                    (true, true) => Some(1),
                    (true, false) if without_namespace(child) != "odom" => Some(3),
                    (false, true) => (without_namespace(parent) == "odom").then_some(4),
                    _ => None,
                }
            }
            (Role::Poses, "Odometry") => Some(2),
            (Role::Poses, _) => (!DESIRED.iter().any(|word| name.contains(word))).then_some(0),
            (Role::Readings, "Range") => Some(0),
            (Role::Readings, _) => Some(1),
        }
    }
}

/// Returns the stream named by the user.
pub fn selected(streams: &BTreeMap<String, Stream>, role: Role, name: &str) -> Result<String, String> {
    let has_role = |schema: &str| Role::of(schema) == Some(role);
    match streams.get(name) {
        Some(stream) if has_role(&stream.schema) => Ok(name.to_owned()),
        _ => Err(format!(
            "{name} is not a topic of {}: those are {}",
            role.name(),
            list(streams, |stream| has_role(&stream.schema))
        )),
    }
}

/// Returns the best stream of a role, and how it was chosen if there are others; ties go to the robot whose commands are `near`.
pub fn guess(
    streams: &BTreeMap<String, Stream>,
    role: Role,
    near: &str,
) -> Result<Option<(String, Option<String>)>, String> {
    let of_role = streams.iter().filter(|(_, stream)| Role::of(&stream.schema) == Some(role));
    let mut ranked: Vec<(u32, &str)> =
        of_role.filter_map(|(name, stream)| Some((role.rank(name, &stream.schema)?, name.as_str()))).collect();
    ranked.sort_unstable();
    let Some((least, _)) = ranked.first() else { return Ok(None) };
    let best_ranked: Vec<&str> = ranked.iter().filter(|(rank, _)| rank == least).map(|(_, name)| *name).collect();
    let best = near_to(&best_ranked, near).ok_or_else(|| {
        format!("{} could be any of {}; select one with {}", role.name(), shortened(&best_ranked), role.option())
    })?;
    let others = ranked.len() - 1;
    let how = format!("chose {best} over {others} other topic(s); select another with {}", role.option());
    Ok(Some((best.to_owned(), (others > 0).then_some(how))))
}

/// Returns the only stream among these, or the only one of the robot whose commands are `near`.
pub fn near_to<'a>(names: &[&'a str], near: &str) -> Option<&'a str> {
    let robot = |name: &str| name.trim_start_matches('/').split(['/', ':']).next().unwrap_or_default().to_owned();
    let same_robot: Vec<&str> = names.iter().copied().filter(|name| robot(name) == robot(near)).collect();
    match (names, same_robot.as_slice()) {
        ([one], _) | (_, [one]) => Some(one),
        _ => None,
    }
}

/// Returns the names of the streams whose type ends like this.
pub fn of_type<'a>(streams: &'a BTreeMap<String, Stream>, end: &'static str) -> impl Iterator<Item = &'a str> {
    streams.iter().filter(move |(_, stream)| stream.schema.ends_with(end)).map(|(name, _)| name.as_str())
}

/// Returns the names of the streams that match.
pub fn list(streams: &BTreeMap<String, Stream>, matches: impl Fn(&Stream) -> bool) -> String {
    let names: Vec<&str> = streams.iter().filter(|(_, s)| matches(s)).map(|(name, _)| name.as_str()).collect();
    shortened(&names)
}

fn shortened(names: &[&str]) -> String {
    match names {
        [] => "none".into(),
        names if names.len() <= MAX_NAMED => names.join(", "),
        names => format!("{} and {} more", names[..MAX_NAMED].join(", "), names.len() - MAX_NAMED),
    }
}
