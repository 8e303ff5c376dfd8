//! Engines of simulators, and the tags that they accept and ignore.
//!
//! Measured with the same files in MuJoCo 4.0.0, PyBullet 3.2.7, Drake 1.51 and 1.58, DART 6.20, Genesis 1.4.5 and Newton 1.8.0;
//! Gazebo, Webots and Isaac Sim by their documentation.

use std::str::FromStr;

/// An engine that reads a model file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// MuJoCo.
    MuJoCo,
    /// Bullet, by PyBullet.
    PyBullet,
    /// Drake.
    Drake,
    /// DART.
    Dart,
    /// Genesis.
    Genesis,
    /// Newton with MuJoCo's solver.
    Newton,
    /// Gazebo, classic or new.
    Gazebo,
    /// Webots.
    Webots,
    /// Isaac Sim.
    Isaac,
}

/// A tag that not every engine obeys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tag {
    /// `dynamics friction` of a URDF joint, and the friction of an SDF axis.
    JointFriction,
    /// `limit velocity` of a URDF joint.
    VelocityLimit,
    /// `frictionloss` of an MJCF joint.
    FrictionLoss,
    /// `armature` of an MJCF joint.
    Armature,
    /// `delay` of an MJCF actuator or sensor.
    Delay,
}

/// Names for `--engine`, each with its engine.
pub const ENGINES: [(&str, Engine); 9] = [
    ("mujoco", Engine::MuJoCo),
    ("pybullet", Engine::PyBullet),
    ("drake", Engine::Drake),
    ("dart", Engine::Dart),
    ("genesis", Engine::Genesis),
    ("newton", Engine::Newton),
    ("gazebo", Engine::Gazebo),
    ("webots", Engine::Webots),
    ("isaac", Engine::Isaac),
];

impl Engine {
    /// Returns its name, as of `--engine`.
    pub fn name(self) -> &'static str {
        ENGINES.iter().find(|(_, engine)| *engine == self).map_or("", |(name, _)| name)
    }

    /// Returns what makes a change of this tag useless: the engine reads it and does not act on it. `None` if it obeys, or if
    /// that is not known.
    pub fn ignores(self, tag: Tag) -> Option<&'static str> {
        use Engine::{Dart, Drake, Genesis, Newton, PyBullet};
        match (tag, self) {
            (Tag::JointFriction, PyBullet) => Some("PyBullet ignores the friction of joints: set it in the driver"),
            (Tag::JointFriction | Tag::FrictionLoss, Drake) => {
                Some("Drake ignores the friction of joints: add it in the driver, as a torque against the motion")
            }
            (Tag::VelocityLimit, _) => Some("no engine acts on limit velocity: limit the speed in the driver"),
            (Tag::Armature, Dart) => Some("DART ignores armature: add the inertia of the rotor to the wheel's link"),
            (Tag::Delay, Drake | Dart | PyBullet | Genesis | Newton) => {
                Some("only MuJoCo from 3.5 on delays by this attribute: hold commands back in the driver")
            }
            _ => None,
        }
    }

    /// Returns how it combines the friction of a wheel and of the floor.
    pub fn combined_friction(self) -> &'static str {
        match self {
            Engine::MuJoCo | Engine::Genesis => {
                "the larger of wheel and floor counts, so lowering the wheel's below the floor's changes nothing"
            }
            Engine::PyBullet => "the product of wheel and floor counts",
            Engine::Drake => "2ab/(a + b) of wheel and floor counts",
            Engine::Dart => "the smaller of wheel and floor counts",
            Engine::Newton | Engine::Gazebo | Engine::Webots | Engine::Isaac => "wheel and floor both count",
        }
    }
}

impl FromStr for Engine {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let known = ENGINES.iter().find(|(known, _)| *known == name);
        known.map(|(_, engine)| *engine).ok_or_else(|| format!("{name} is not an engine"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_engines_are_read_back() {
        for (name, engine) in ENGINES {
            assert_eq!((name.parse(), engine.name()), (Ok(engine), name));
        }
        assert!("ode".parse::<Engine>().is_err());
    }

    #[test]
    fn speed_limits_of_joints_are_ignored_by_all() {
        assert!(ENGINES.iter().all(|(_, engine)| engine.ignores(Tag::VelocityLimit).is_some()));
        assert_eq!(Engine::MuJoCo.ignores(Tag::FrictionLoss), None);
        assert!(Engine::Drake.ignores(Tag::FrictionLoss).is_some());
    }
}
