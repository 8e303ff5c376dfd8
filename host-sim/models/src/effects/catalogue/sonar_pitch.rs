//! The sensor points at the floor.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_pitch",
    name: "sensor pointing at the floor",
    what: "The sensor points at the floor and sees nothing beyond it.",
    in_logs: "Beyond one distance readings are missing, or all are of that distance; nearer ones agree.",
    imitated_by: &["sonar_absorption", "sonar_ghost"],
    check: "Stand the robot two metres from a wall on a bare floor and lift its front until the reading jumps to the wall's.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[Variant {
        id: "floor",
        parameters: Pitch::PARAMETERS,
        hooks: &[Hook::Sensor(&|v, _, sensor| {
            let Pitch { cm, floor_echo } = Pitch::read(v);
            if cm < UNREACHED_CM {
                sensor.perturbation.floor_cm = cm;
                sensor.perturbation.p_floor = floor_echo;
            }
        })],
    }],
};

/// A distance from which no ultrasonic sensor hears an echo.
const UNREACHED_CM: f64 = 600.0;

parameters! {
    Pitch {
        /// Distance along the floor at which the beam meets it. A sensor 10 cm above the floor that is pitched by one degree meets it
        /// at 570 cm, and one pitched by 45 at 10 cm.
        cm: Parameter::new("cm", UNREACHED_CM, [8.0, UNREACHED_CM]).scale(40.0).from(Guesses::At(&[30.0, 60.0, 120.0, 240.0])),
        /// Probability that the floor itself is heard: a carpet returns sound, tiles mirror it away.
        floor_echo: Parameter::new("", 0.5, [0.0, 1.0]).report(Report::Hidden),
    }
}
