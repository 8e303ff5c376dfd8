//! Which topics of a bag are the robot's commands, poses and readings.

use std::collections::HashMap;

use super::Stream;

/// What the user says of topics; what is left out is guessed.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// The topic of commands.
    pub commands: Option<String>,
    /// The topic of poses; of transforms with parent and child, as `/tf:map>base_link`.
    pub poses: Option<String>,
    /// The topic of readings; `none` for none.
    pub ranges: Option<String>,
}

/// The topics that are used.
#[derive(Clone, Debug, PartialEq)]
pub struct Topics {
    pub commands: String,
    pub poses: String,
    pub ranges: Option<String>,
    /// What was guessed, a sentence each.
    pub guessed: Vec<String>,
}

/// Frames that stay where they are.
const FIXED: [&str; 6] = ["map", "world", "mocap", "vicon", "optitrack", "earth"];
/// Frames of a robot's body.
const BODY: [&str; 3] = ["base_link", "base_footprint", "base"];
/// Poses that a robot should have rather than has.
const ASKED_FOR: [&str; 4] = ["goal", "target", "initialpose", "setpoint"];
/// So many topics are named in a message.
const NAMED: usize = 8;

/// Whether a frame stays where it is.
pub fn is_fixed(frame: &str) -> bool {
    FIXED.contains(&plain(frame))
}

/// Whether a frame is that of a robot's body.
pub fn is_body(frame: &str) -> bool {
    BODY.contains(&plain(frame))
}

/// A frame's own name: a robot's frames may have its name before them.
fn plain(frame: &str) -> &str {
    frame.rsplit('/').next().unwrap_or_default()
}

/// What a stream can be.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Commands,
    Poses,
    Readings,
}

impl Topics {
    /// Chooses among streams.
    ///
    /// # Errors
    /// When a topic that the user names is not there, or commands or poses are missing or could be several.
    pub fn choose(streams: &HashMap<String, Stream>, choice: &Choice) -> Result<Self, String> {
        let mut guessed = Vec::new();
        let mut choose = |role, said: &Option<String>, beside: &str| -> Result<Option<String>, String> {
            if let Some(name) = said {
                return found(streams, role, name).map(Some);
            }
            let one = guess(streams, role, beside)?;
            if let Some((name, others)) = &one
                && *others > 0
            {
                guessed.push(format!("{name} rather than {others} other topic(s): {} says another", role.option()));
            }
            Ok(one.map(|(name, _)| name))
        };
        let missing = |role: Role| {
            format!(
                "has no {}: its topics of interest are {}; {} says which",
                role.name(),
                list(streams, |_| true),
                role.option()
            )
        };
        let commands = choose(Role::Commands, &choice.commands, "")?.ok_or_else(|| missing(Role::Commands))?;
        let poses = choose(Role::Poses, &choice.poses, &commands)?.ok_or_else(|| missing(Role::Poses))?;
        let ranges = match choice.ranges.as_deref() {
            Some("none") => None,
            _ => choose(Role::Readings, &choice.ranges, &commands)?,
        };
        if streams[&poses].schema == "nav_msgs/msg/Odometry" {
            guessed.push(format!("{poses} may be the robot's own reckoning, which does not see its wheels slip"));
        }
        if let parts @ [_, ..] = streams[&poses].composed_of.as_slice() {
            guessed.push(format!("{poses} is composed of {}", parts.join(" and ")));
        }
        Ok(Topics { commands, poses, ranges, guessed })
    }

    /// The names of all of them.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        [&self.commands, &self.poses].into_iter().chain(&self.ranges).map(String::as_str)
    }
}

impl Role {
    fn of(schema: &str) -> Option<Self> {
        match schema.rsplit('/').next()? {
            "Twist" | "TwistStamped" => Some(Role::Commands),
            "PoseStamped" | "PoseWithCovarianceStamped" | "Odometry" | "TFMessage" => Some(Role::Poses),
            "Range" | "LaserScan" => Some(Role::Readings),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Role::Commands => "commands (geometry_msgs/Twist or TwistStamped)",
            Role::Poses => "poses (PoseStamped, Odometry or tf)",
            Role::Readings => "readings (Range or LaserScan)",
        }
    }

    fn option(self) -> &'static str {
        match self {
            Role::Commands => "--commands TOPIC",
            Role::Poses => "--poses TOPIC",
            Role::Readings => "--ranges TOPIC",
        }
    }

    /// How likely a stream is to be this one: the least is the likeliest; `None` if it is not.
    fn rank(self, name: &str, schema: &str) -> Option<u32> {
        let last = name.rsplit('/').next().unwrap_or_default();
        match (self, schema.rsplit('/').next()?) {
            (Role::Commands, _) => Some(if last == "cmd_vel" { 0 } else { 1 }),
            (Role::Poses, "TFMessage") => {
                let (parent, child) = name.rsplit_once(':')?.1.split_once('>')?;
                match (is_fixed(parent), is_body(child)) {
                    (true, true) => Some(1),
                    (true, false) if plain(child) != "odom" => Some(3),
                    (false, true) => (plain(parent) == "odom").then_some(4),
                    _ => None,
                }
            }
            (Role::Poses, "Odometry") => Some(2),
            (Role::Poses, _) => (!ASKED_FOR.iter().any(|word| name.contains(word))).then_some(0),
            (Role::Readings, "Range") => Some(0),
            (Role::Readings, _) => Some(1),
        }
    }
}

/// The stream that a user names.
fn found(streams: &HashMap<String, Stream>, role: Role, name: &str) -> Result<String, String> {
    let is_one = |schema: &str| Role::of(schema) == Some(role);
    match streams.get(name) {
        Some(stream) if is_one(&stream.schema) => Ok(name.to_owned()),
        _ => Err(format!(
            "{name} is no topic of {}: these are {}",
            role.name(),
            list(streams, |stream| is_one(&stream.schema))
        )),
    }
}

/// The likeliest stream of a role and the number of others; the robot whose commands are `beside` comes first.
fn guess(streams: &HashMap<String, Stream>, role: Role, beside: &str) -> Result<Option<(String, usize)>, String> {
    let of_role = streams.iter().filter(|(_, stream)| Role::of(&stream.schema) == Some(role));
    let mut ranked: Vec<(u32, &str)> =
        of_role.filter_map(|(name, stream)| Some((role.rank(name, &stream.schema)?, name.as_str()))).collect();
    ranked.sort_unstable();
    let Some((least, _)) = ranked.first() else { return Ok(None) };
    let likeliest: Vec<&str> = ranked.iter().filter(|(rank, _)| rank == least).map(|(_, name)| *name).collect();
    let robot = |name: &str| name.trim_start_matches('/').split(['/', ':']).next().unwrap_or_default().to_owned();
    let of_robot: Vec<&str> = likeliest.iter().copied().filter(|name| robot(name) == robot(beside)).collect();
    match (likeliest.as_slice(), of_robot.as_slice()) {
        ([one], _) | (_, [one]) => Ok(Some(((*one).to_owned(), ranked.len() - 1))),
        _ => Err(format!("{} could be several: {}; {} says which", role.name(), shortened(&likeliest), role.option())),
    }
}

fn list(streams: &HashMap<String, Stream>, of: impl Fn(&Stream) -> bool) -> String {
    let mut names: Vec<&str> = streams.iter().filter(|(_, s)| of(s)).map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    shortened(&names)
}

fn shortened(names: &[&str]) -> String {
    match names {
        [] => "none".into(),
        names if names.len() <= NAMED => names.join(", "),
        names => format!("{} and {} more", names[..NAMED].join(", "), names.len() - NAMED),
    }
}
