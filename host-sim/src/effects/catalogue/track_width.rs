//! Turns are larger or smaller by one factor, straight runs are not.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Variant};

pub const EFFECT: Effect = Effect {
    id: "track_width",
    name: "track width",
    what: "Turns are larger or smaller by one factor, and straight runs are not: the wheels touch the floor farther \
           apart or nearer than thought.",
    check: "Measure the distance between the middles of the two tyres where they touch the floor, or command ten \
            full turns on the spot and see how many the robot makes.",
    variants: &[Variant {
        id: "turn",
        parameters: Track::PARAMETERS,
        hooks: &[Hook::Motion(&|v, _, increment| increment.turn_rad *= Track::read(v).factor)],
    }],
};

parameters! {
    Track {
        /// Factor on turns. Tyres 26 mm wide on a track of 12 cm touch the floor up to 10 % nearer or farther apart;
        /// a wheel mounted one stud over changes it by up to a third.
        factor: Parameter::new("", 1.0, [0.6, 1.5]).prior_sd(0.15).from(Guesses::At(&[1.03, 0.97])),
    }
}
