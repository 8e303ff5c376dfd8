//! Options that take one of a few names.

use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Names, each with its help.
type Names = [(&'static str, &'static str)];

/// Names of [`SensorModel`](mindgap_models::simulator::environment::SensorModel).
pub const SENSOR_MODELS: &Names = &[
    ("beam", "The beam that the training logs show; the networks where they show none"),
    ("networks", "The two sonar networks"),
    ("first_echo", "The first-echo law"),
];

/// Names of [`Outside`](mindgap_applications::challenge::cases::Outside).
pub const OUTSIDE: &Names = &[
    ("usual", "Those that the thresholds of the diagnosis were fitted on as well, on cases of other seeds"),
    ("held-out", "Those that no part of the diagnosis was made or fitted on"),
];

/// Names of [`Time`](mindgap_import::units::Time).
pub const TIMES: &Names = &[("s", "Seconds"), ("ms", "Milliseconds"), ("us", "Microseconds")];

/// Names of [`Length`](mindgap_import::units::Length).
pub const LENGTHS: &Names = &[("m", "Metres"), ("cm", "Centimetres"), ("mm", "Millimetres")];

/// Names of [`Angle`](mindgap_import::units::Angle).
pub const ANGLES: &Names = &[("deg", "Degrees"), ("rad", "Radians")];

/// Returns a parser of one of `names` as a `T`, which reads them all.
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
    use mindgap_import::units::{Angle, Length, Time};
    use mindgap_models::simulator::environment::SensorModel;

    fn all_are_read<T: FromStr<Err = String>>(names: &Names) {
        names.iter().for_each(|(name, _)| assert!(name.parse::<T>().is_ok(), "{name}"));
        assert!("furlong".parse::<T>().is_err());
    }

    #[test]
    fn every_offered_name_is_read() {
        all_are_read::<SensorModel>(SENSOR_MODELS);
        all_are_read::<Outside>(OUTSIDE);
        all_are_read::<Time>(TIMES);
        all_are_read::<Length>(LENGTHS);
        all_are_read::<Angle>(ANGLES);
    }
}
