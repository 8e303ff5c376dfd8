//! Turns are larger or smaller by one factor, straight runs are not.

use super::drive::Drive;
use super::{parameters, scrubbing};
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};
use mindgap_foundations::motion::{Arc, Motion};

pub const EFFECT: Effect = Effect {
    id: "track_width",
    name: "track width",
    what: "Turns are larger or smaller by one factor, and straight runs are not: the wheels touch the floor farther \
           apart or nearer than thought.",
    in_logs: "Turns are off by one factor; straight steps agree.",
    imitated_by: &["turn_loss", "compass_disturbance"],
    check: "Measure the distance between the middles of the two tyres where they touch the floor, or command ten \
            full turns on the spot and see how many the robot makes.",
    place: Some(Place::Ground),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "turn",
            parameters: Track::PARAMETERS,
            hooks: &[Hook::Motion(&|v, _, increment| turn_by(increment, increment.turn * Track::read(v).factor))],
        },
        Variant {
            id: "lever",
            parameters: LeverTrack::PARAMETERS,
            hooks: &[
                Hook::Commands(&|v, context, commands| {
                    let LeverTrack { factor, body_share, .. } = LeverTrack::read(v);
                    // Wheels that are nearer to each other need more force for the same torque, and turn the robot faster.
                    if factor != 1.0 {
                        let loaded = Drive::loaded(factor * factor, body_share, context);
                        Drive::slower(0.0, 0.0, context).imitate_turning(&loaded, commands);
                    }
                }),
                Hook::Motion(&|v, context, increment| {
                    let LeverTrack { factor, scrub_rad_s, .. } = LeverTrack::read(v);
                    let turn_rad = increment.turn;
                    let scrubbed_rad = scrub_rad_s * context.step_s() * scrubbing(turn_rad, context);
                    turn_by(increment, factor * (turn_rad - (factor - 1.0) * scrubbed_rad));
                }),
            ],
        },
    ],
};

/// Factor on turns. Tyres 26 mm wide on a track of 12 cm touch the floor up to 10 % nearer or farther apart; a wheel mounted
/// one stud over changes it by up to a third. Skid-steered robots make 0.3 to 0.6 of their turns on grass and asphalt, and
/// less on tracks.
const FACTOR: Parameter = Parameter::new("", 1.0, [0.05, 4.5]).prior_sd(0.4).from(Guesses::At(&[1.03, 0.97, 0.5]));

parameters! {
    Track {
        /// See [`FACTOR`].
        factor: FACTOR,
    }
}

parameters! {
    LeverTrack {
        /// See [`FACTOR`].
        factor: FACTOR,
        /// Share of the drive's time constant in turns that the robot's body makes; the motors' rotors make the rest.
        body_share: Parameter::new("", 0.5, [0.0, 1.0]).prior_sd(0.3).report(Report::Hidden),
        /// Rate of turn that scrubbing tyres cost on the track that is known.
        scrub_rad_s: Parameter::new("rad/s", 0.0, [0.0, 1.0]).prior_sd(0.4).from(Guesses::At(&[0.2])).report(Report::Hidden),
    }
}

/// Turns by another angle along an arc of the same length.
fn turn_by(increment: &mut Motion<f64>, turn_rad: f64) {
    *increment = Arc { turn_rad, ..increment.arc() }.motion();
}
