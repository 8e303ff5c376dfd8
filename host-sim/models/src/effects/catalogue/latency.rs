//! Commands take effect late.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Late, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "latency",
    name: "latency",
    what: "Commands take effect late, by a fixed time.",
    in_logs: "Residuals appear only after a change of the command, and the motion is that of the command before.",
    imitated_by: &["inertia", "tracker_delay"],
    check: "Film the robot together with the screen that sends the command, and count the frames from the command to \
            the first motion.",
    place: Some(Place::Link),
    needs_known_robot: false,
    variants: &[
        Variant { id: "delay", parameters: Latency::PARAMETERS, hooks: &[Hook::DeadTime(&|v| Latency::read(v).ms)] },
        Variant {
            id: "drive_delay",
            parameters: Later::PARAMETERS,
            hooks: &[Hook::Delay(&|v| Late { drive_steps: late_steps(v), ..Late::default() })],
        },
        Variant {
            id: "pose_delay",
            parameters: Later::PARAMETERS,
            hooks: &[Hook::Delay(&|v| Late { poses_steps: late_steps(v), ..Late::default() })],
        },
    ],
};

fn late_steps(values: &[f64]) -> f64 {
    Later::read(values).ms
}

/// Delay between a command and the wheels, steps. A Bluetooth link to a brick takes 28 to 77 ms there and back, a camera's
/// frames as much again; what is late by more than a few steps cannot be steered.
const DELAY: Parameter = Parameter::new("ms", 0.0, [-8.0, 8.0])
    .prior_sd(1.0)
    .from(Guesses::At(&[0.1, 0.4, 0.9, 2.0]))
    .report(Report::Duration);

parameters! {
    Latency {
        /// See [`DELAY`]. It is negative for a robot that answers sooner than its simulator, whose drive filter it changes.
        ms: DELAY,
    }
}

parameters! {
    Later {
        /// See [`DELAY`].
        ms: Parameter { bounds: [0.0, 8.0], ..DELAY },
    }
}
