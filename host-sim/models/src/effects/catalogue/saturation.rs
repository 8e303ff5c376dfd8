//! Commands above some value add nothing.

use super::{each_command, parameters};
use crate::effects::parameter::{ActsOn, Guesses, Report};
use crate::effects::scales::UNREACHED_SPEED;
use crate::effects::twist::{twist, wheels};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "saturation",
    name: "saturation",
    what: "Commands above some value add no speed.",
    in_logs: "Steps at high commands are too short and all alike; slower ones agree.",
    imitated_by: &["battery_sag", "slip"],
    check: "Time a straight metre at commands of 60, 80 and 100: where the time no longer falls, the drive is at its \
            limit.",
    place: Some(Place::Motor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "hard",
            parameters: Saturation::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let limit = context.command_for(Saturation::read(v).limit);
                each_command(commands, |c, _| c.min(limit));
            })],
        },
        Variant {
            id: "wheel",
            parameters: Saturation::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let most_cm = Saturation::read(v).limit * context.reference_cm();
                let (arc, track_cm) = (increment.arc(), context.robot.track_cm);
                let wheels = arc.wheels_cm(track_cm);
                let within = wheels.map(|covered_cm| covered_cm.clamp(-most_cm, most_cm));
                if within != wheels {
                    *increment = arc.with_wheels(within, track_cm).motion();
                }
            })],
        },
        Variant {
            id: "pair",
            parameters: PairSaturation::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let limit = context.command_for(PairSaturation::read(v).limit);
                for pair in commands {
                    let fastest = pair[0].abs().max(pair[1].abs());
                    if fastest > limit {
                        *pair = pair.map(|command| command * limit / fastest);
                    }
                }
            })],
        },
        Variant {
            id: "twist",
            parameters: TwistSaturation::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let TwistSaturation { limit, turn_limit } = TwistSaturation::read(v);
                let [limit, turn_limit] = [limit, turn_limit].map(|share| context.command_for(share));
                for pair in commands {
                    let [mean, turning] = twist(*pair);
                    *pair = wheels([mean.clamp(-limit, limit), turning.clamp(-turn_limit, turn_limit)]);
                }
            })],
        },
        Variant {
            id: "soft",
            parameters: Saturation::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let Saturation { limit } = Saturation::read(v);
                if limit < UNREACHED_SPEED {
                    each_command(commands, |c, _| softly_limited(c, context.command_for(limit)));
                }
            })],
        },
    ],
};

/// Share of the reference speed above which nothing is added. A regulated NXT motor under load is flat from half of its full
/// speed at the earliest; bases on ROS are often limited to a fifth of what robot.toml says.
const LIMIT: Parameter = Parameter::new("", UNREACHED_SPEED, [0.12, UNREACHED_SPEED])
    .scale(0.8)
    .from(Guesses::OfTopSpeed(&[0.35, 0.5, 0.65, 0.8]));

parameters! {
    /// Of each wheel.
    Saturation {
        /// See [`LIMIT`].
        limit: LIMIT.report(Report::SpeedLimit(ActsOn::Wheel)),
    }
}

parameters! {
    /// Of the faster wheel, to which the other one keeps its ratio.
    PairSaturation {
        /// See [`LIMIT`].
        limit: LIMIT.report(Report::SpeedLimit(ActsOn::Pair)),
    }
}

parameters! {
    /// Of forward speed and turn rate, as most bases on ROS have it.
    TwistSaturation {
        /// See [`LIMIT`].
        limit: LIMIT.report(Report::SpeedLimit(ActsOn::Twist)),
        /// The same for wheels that run in opposite directions, down to a fiftieth: skid-steered robots are turned slowly.
        turn_limit: Parameter::new("deg/s", UNREACHED_SPEED, [0.02, UNREACHED_SPEED])
            .scale(0.8)
            .from(Guesses::OfTopSpeed(&[0.15, 0.35, 0.65]))
            .report(Report::TurnLimit),
    }
}

/// Limits a command smoothly: between 75 and 125 % of the limit half of the excess over 75 % is lost, beyond that everything.
fn softly_limited(command: f64, limit: f64) -> f64 {
    let (begin, end) = (0.75 * limit, 1.25 * limit);
    let into = ((command - begin) / (end - begin)).clamp(0.0, 1.0);
    if command <= begin { command } else { begin + (end - begin) * (into - 0.5 * into * into) }
}
