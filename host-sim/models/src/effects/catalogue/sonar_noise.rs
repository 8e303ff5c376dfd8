//! Readings scatter more.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_noise",
    name: "sonar noise",
    what: "Readings scatter more than the simulator assumes.",
    in_logs: "Readings scatter around the right value more than expected, at all distances.",
    imitated_by: &["sonar_crosstalk", "sonar_lag"],
    check: "Let the robot stand one metre before a wall, log a hundred readings, and compare their range with that \
            of the earlier logs.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[Variant {
        id: "normal",
        parameters: Noise::PARAMETERS,
        hooks: &[Hook::Sensor(&|v, _, sensor| {
            let (own_cm, more_cm) = (sensor.perturbation.scatter_cm, Noise::read(v).cm);
            sensor.perturbation.scatter_cm = (own_cm * own_cm + more_cm * more_cm).sqrt();
        })],
    }],
};

parameters! {
    Noise {
        /// Further scatter of readings, standard deviation. NXT sensors are within 3 cm when new.
        cm: Parameter::new("cm", 0.0, [0.0, 15.0]).prior_sd(4.0).from(Guesses::At(&[1.0, 3.0])),
    }
}
