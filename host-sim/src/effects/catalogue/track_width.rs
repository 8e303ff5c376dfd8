//! Turns are larger or smaller by one factor, straight runs are not.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Variant};

pub const EFFECT: Effect = Effect {
    id: "track_width",
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
