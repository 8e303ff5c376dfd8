//! Selects the topics of a bag that hold the robot's commands, poses and readings.

use std::collections::HashMap;

use super::Stream;

/// Topics selected by the user; the others are guessed.
#[derive(Clone, Debug, Default)]
pub struct Choice {
    /// Topic of commands.
    pub commands: Option<String>,
    /// Topic of poses; for transforms with parent and child frame, as in `/tf:map>base_link`.
    pub poses: Option<String>,
    /// Topic of readings; `none` for no readings.
    pub ranges: Option<String>,
}

/// The topics to use.
#[derive(Clone, Debug, PartialEq)]
pub struct Topics {
    pub commands: String,
    pub poses: String,
    pub ranges: Option<String>,
    /// The guesses made, one sentence each.
    pub guessed: Vec<String>,
}

/// Fixed frames.
const FIXED: [&str; 6] = ["map", "world", "mocap", "vicon", "optitrack", "earth"];
/// Frames of a robot's body.
const BODY: [&str; 3] = ["base_link", "base_footprint", "base"];
/// Words in the names of desired rather than actual poses.
const DESIRED: [&str; 4] = ["goal", "target", "initialpose", "setpoint"];
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
enum Role {
    Commands,
    Poses,
    Readings,
}

impl Topics {
    /// Selects topics among streams.
    ///
    /// # Errors
    /// When a topic named by the user is missing, or commands or poses are missing or ambiguous.
    pub fn choose(streams: &HashMap<String, Stream>, choice: &Choice) -> Result<Self, String> {
        let mut guessed = Vec::new();
        let mut choose = |role, named: &Option<String>, near: &str| -> Result<Option<String>, String> {
            if let Some(name) = named {
                return selected(streams, role, name).map(Some);
            }
            let best = guess(streams, role, near)?;
            if let Some((name, others)) = &best
                && *others > 0
            {
                guessed
                    .push(format!("chose {name} over {others} other topic(s); select another with {}", role.option()));
            }
            Ok(best.map(|(name, _)| name))
        };
        let missing = |role: Role| {
            format!(
                "has no {}: relevant topics are {}; select one with {}",
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
            guessed.push(format!("{poses} may be the robot's own odometry, which does not see wheel slip"));
        }
        if let parts @ [_, ..] = streams[&poses].composed_of.as_slice() {
            guessed.push(format!("{poses} is composed of {}", parts.join(" and ")));
        }
        Ok(Topics { commands, poses, ranges, guessed })
    }

    /// Returns the names of all selected topics.
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

    /// Ranks a stream for this role: the smallest rank is the best; `None` if it is unsuitable.
    fn rank(self, name: &str, schema: &str) -> Option<u32> {
        let last = name.rsplit('/').next().unwrap_or_default();
        match (self, schema.rsplit('/').next()?) {
            (Role::Commands, _) => Some(if last == "cmd_vel" { 0 } else { 1 }),
            (Role::Poses, "TFMessage") => {
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
fn selected(streams: &HashMap<String, Stream>, role: Role, name: &str) -> Result<String, String> {
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

/// Returns the best stream of a role and the number of others; ties go to the robot whose commands are `near`.
fn guess(streams: &HashMap<String, Stream>, role: Role, near: &str) -> Result<Option<(String, usize)>, String> {
    let of_role = streams.iter().filter(|(_, stream)| Role::of(&stream.schema) == Some(role));
    let mut ranked: Vec<(u32, &str)> =
        of_role.filter_map(|(name, stream)| Some((role.rank(name, &stream.schema)?, name.as_str()))).collect();
    ranked.sort_unstable();
    let Some((least, _)) = ranked.first() else { return Ok(None) };
    let best_ranked: Vec<&str> = ranked.iter().filter(|(rank, _)| rank == least).map(|(_, name)| *name).collect();
    let robot = |name: &str| name.trim_start_matches('/').split(['/', ':']).next().unwrap_or_default().to_owned();
    let same_robot: Vec<&str> = best_ranked.iter().copied().filter(|name| robot(name) == robot(near)).collect();
    match (best_ranked.as_slice(), same_robot.as_slice()) {
        ([best], _) | (_, [best]) => Ok(Some(((*best).to_owned(), ranked.len() - 1))),
        _ => Err(format!(
            "{} could be any of {}; select one with {}",
            role.name(),
            shortened(&best_ranked),
            role.option()
        )),
    }
}

fn list(streams: &HashMap<String, Stream>, matches: impl Fn(&Stream) -> bool) -> String {
    let mut names: Vec<&str> = streams.iter().filter(|(_, s)| matches(s)).map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    shortened(&names)
}

fn shortened(names: &[&str]) -> String {
    match names {
        [] => "none".into(),
        names if names.len() <= MAX_NAMED => names.join(", "),
        names => format!("{} and {} more", names[..MAX_NAMED].join(", "), names.len() - MAX_NAMED),
    }
}
