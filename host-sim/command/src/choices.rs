//! Options that accept one of a few names.

use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Names, each with its help text.
type Names = [(&'static str, &'static str)];

/// Names of [`SensorModel`](mindgap_models::simulator::environment::SensorModel).
pub const SENSOR_MODELS: &Names = &[
    ("beam", "The beam model fitted to the training logs; the networks if there is none"),
    ("networks", "The two sonar networks"),
    ("first_echo", "The first-echo law"),
];

/// Names of [`Outside`](mindgap_applications::challenge::cases::Outside).
pub const OUTSIDE: &Names = &[
    ("usual", "Effects that were also used, with other seeds, to fit the thresholds of the diagnosis"),
    ("held-out", "Effects that were used neither to design nor to fit any part of the diagnosis"),
];

/// Names of [`Engine`](mindgap_patch::engine::Engine).
pub const ENGINES: &Names = &[
    ("mujoco", "MuJoCo"),
    ("pybullet", "Bullet, by PyBullet"),
    ("drake", "Drake"),
    ("dart", "DART"),
    ("genesis", "Genesis"),
    ("newton", "Newton with MuJoCo's solver"),
    ("gazebo", "Gazebo, classic or new"),
    ("webots", "Webots"),
    ("isaac", "Isaac Sim"),
];

/// Names of [`Format`](mindgap_applications::export::Format).
pub const FORMATS: &Names = &[
    ("nxc", "NXC source for the LEGO NXT's standard firmware"),
    ("rxe", "Executable for the brick, without log and display"),
    ("rust", "Constants for the crate `mindgap-core`"),
    ("c", "C99 header with the controller's state machine"),
    ("arduino", "Arduino sketch; for a simulator, a header to include in one"),
    (
        "pybricks",
        "MicroPython program for an NXT, EV3, SPIKE or Technic hub with Pybricks firmware; for a simulator, a module to import in \
         one",
    ),
    ("nxc-collect", "NXC source of a program that drives at random or by a script, and logs"),
    (
        "pybricks-collect",
        "MicroPython program for hubs with Pybricks firmware that drives at random or by a script, and prints a log",
    ),
];

/// Names of [`Time`](mindgap_import::units::Time).
pub const TIMES: &Names = &[("s", "Seconds"), ("ms", "Milliseconds"), ("us", "Microseconds")];

/// Names of [`Length`](mindgap_import::units::Length).
pub const LENGTHS: &Names = &[("m", "Metres"), ("cm", "Centimetres"), ("mm", "Millimetres")];

/// Names of [`Angle`](mindgap_import::units::Angle).
pub const ANGLES: &Names = &[("deg", "Degrees"), ("rad", "Radians")];

/// Returns a parser that accepts one of `names` and converts it to `T`.
pub fn one_of<T>(names: &'static Names) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = String> + Clone + Send + Sync + 'static,
{
    let values = names.iter().map(|(name, help)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(values).try_map(|name| name.parse::<T>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_applications::challenge::cases::Outside;
    use mindgap_applications::export::Format;
    use mindgap_import::units::{Angle, Length, Time};
    use mindgap_models::simulator::environment::SensorModel;
    use mindgap_patch::engine::Engine;

    fn assert_all_parse<T: FromStr<Err = String>>(names: &Names) {
        names.iter().for_each(|(name, _)| assert!(name.parse::<T>().is_ok(), "{name}"));
        assert!("furlong".parse::<T>().is_err());
    }

    #[test]
    fn every_offered_name_parses() {
        assert_all_parse::<SensorModel>(SENSOR_MODELS);
        assert_all_parse::<Outside>(OUTSIDE);
        assert_all_parse::<Engine>(ENGINES);
        assert_all_parse::<Format>(FORMATS);
        assert_all_parse::<Time>(TIMES);
        assert_all_parse::<Length>(LENGTHS);
        assert_all_parse::<Angle>(ANGLES);
    }
}
