//! Selects the topics of a bag that hold the robot's commands, poses, readings and own motion.

use std::collections::BTreeMap;

use super::Stream;
use super::own_motion::{self, OwnStreams};
use super::ranges::{self, Ranges};
use super::roles::{Choice, Role, Unused, guess, list, selected};
use mindgap_logs::range_sensor::RangeSensor;

/// The topics to use.
#[derive(Clone, Debug, PartialEq)]
pub struct Topics {
    pub commands: String,
    /// Without one, the own motion shows how the robot moved.
    pub poses: Option<String>,
    pub ranges: Ranges,
    pub own_motion: OwnStreams,
    /// The guesses made, one sentence each.
    pub guessed: Vec<String>,
    /// Streams and topics that are not used, where there is more to say than that another was chosen.
    pub unused: Unused,
}

impl Topics {
    /// Selects topics among streams.
    ///
    /// # Errors
    /// When a topic named by the user is missing, or commands are missing or ambiguous, or so are poses and no own motion stands in
    /// for them.
    pub fn choose(
        streams: &BTreeMap<String, Stream>,
        choice: &Choice,
        sensors: &[RangeSensor],
    ) -> Result<Self, String> {
        let mut guessed = Vec::new();
        let mut choose = |role, named: &Option<String>, near: &str| -> Result<Option<String>, String> {
            if let Some(name) = named {
                return selected(streams, role, name).map(Some);
            }
            let (name, how) = guess(streams, role, near)?.unzip();
            guessed.extend(how.flatten());
            Ok(name)
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
        let poses = choose(Role::Poses, &choice.poses, &commands)?;
        let (ranges, how, mut unused) = ranges::choose(streams, choice, sensors, &commands)?;
        guessed.extend(how);
        let own_motion = own_motion::choose(streams, choice, &commands, &mut unused)?;
        if poses.is_none() && own_motion.all().next().is_none() {
            return Err(missing(Role::Poses) + "; wheels of a JointState or a gyro would do as well");
        }
        if let Some(poses) = &poses {
            if streams[poses].schema == "nav_msgs/msg/Odometry" {
                guessed.push(format!("{poses} may be the robot's own odometry, which does not see wheel slip"));
            }
            if let parts @ [_, ..] = streams[poses].composed_of.as_slice() {
                guessed.push(format!("{poses} is composed of {}", parts.join(" and ")));
            }
        }
        Ok(Topics { commands, poses, ranges, own_motion, guessed, unused })
    }

    /// Returns the names of all selected topics.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        let ranges = self.ranges.iter().map(|(_, name)| name);
        [&self.commands].into_iter().chain(&self.poses).chain(ranges).chain(self.own_motion.all()).map(String::as_str)
    }
}
