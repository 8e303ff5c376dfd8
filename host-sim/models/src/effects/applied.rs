//! Effects that were applied to a simulator: what a diagnosis confirmed and its networks do not know.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::catalogue::{CATALOGUE, Candidate, place};
use super::own;
use super::own::definition::Definition;
use super::parameter::Settings;
use super::variant::Place;
use mindgap_files::did_you_mean;
use mindgap_logs::Robot;

/// One effect as files hold it: by the ids of the effect and its variant, and the names under which its parameters are
/// reported.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AppliedEffect {
    /// Its id in the table of docs/reference/effects.md.
    pub effect: String,
    /// Id of the variant.
    pub variant: String,
    /// Its parameters, as a diagnosis reports them but not rounded.
    pub parameters: Settings,
    /// The definition of a user's own effect.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub definition: Option<Definition>,
    /// Name of the further range sensor that it concerns; readings of the first sensor are then unchanged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

impl AppliedEffect {
    /// Returns a variant with values in the order of its parameters, applied to a robot.
    pub fn new(candidate: &Candidate, values: &[f64], robot: &Robot) -> Self {
        AppliedEffect {
            effect: candidate.effect.into(),
            variant: candidate.variant.id.into(),
            parameters: candidate.variant.settings(values, robot),
            definition: own::definition_of(candidate.variant),
            sensor: None,
        }
    }

    /// Returns whether it sits in a range sensor and nowhere else.
    pub fn is_of_sensor(&self) -> bool {
        place(&self.effect) == Some(Place::Sensor)
    }

    /// Returns the variant and its values.
    ///
    /// # Errors
    /// In one line, when this program does not know it, or one of its parameters is missing or not possible.
    pub fn resolve(&self, robot: &Robot) -> Result<(Candidate, Vec<f64>), String> {
        let own;
        let known = match &self.definition {
            None => CATALOGUE,
            Some(definition) => {
                own = [own::effect(definition)?];
                &own
            }
        };
        let ids = known.iter().map(|effect| effect.id);
        if ids.clone().all(|id| id != self.effect) {
            return Err(format!("it is not known to this program{}", did_you_mean(&self.effect, ids)));
        }
        let named = Candidate::named_in(known, &self.effect, &self.variant);
        let resolved =
            named.and_then(|candidate| Some((candidate, candidate.variant.values(&self.parameters, robot)?)));
        resolved.ok_or_else(|| "this program knows no such variant with these parameters and values".into())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::effects::parameter::{Report, Setting};

    /// Reads back what is written.
    fn round_trip(candidate: &Candidate, values: &[f64], robot: &Robot) -> Vec<f64> {
        let text = serde_json::to_string(&AppliedEffect::new(candidate, values, robot)).unwrap();
        let read: AppliedEffect = serde_json::from_str(&text).unwrap();
        let (resolved, values) = read.resolve(robot).unwrap_or_else(|why| panic!("{text}: {why}"));
        assert!(resolved == *candidate, "{text}");
        values
    }

    fn robots() -> impl Strategy<Value = Robot> {
        let robot = mindgap_built_in_robot::default_robot();
        (1.0..300.0, 10.0..2000.0).prop_map(move |(full_speed_cm_s, step_ms)| Robot {
            full_speed_cm_s,
            step_ms,
            ..robot
        })
    }

    proptest! {
        #[test]
        fn every_variant_reads_back_from_a_file(robot in robots(), shares in prop::array::uniform6(0.0..=1.0)) {
            for candidate in Candidate::all(CATALOGUE) {
                let parameters = candidate.variant.parameters;
                let value = |(p, share): (&super::super::Parameter, &f64)| p.bounds[0] + share * (p.bounds[1] - p.bounds[0]);
                let values: Vec<f64> = parameters.iter().zip(&shares).map(value).collect();
                for ((p, value), read) in parameters.iter().zip(&values).zip(round_trip(&candidate, &values, &robot)) {
                    // Directions that differ by whole turns are the same.
                    let turns = if let Report::Direction = p.report { 360.0 } else { f64::INFINITY };
                    let off = (value - read).abs() % turns;
                    let near = off.min(turns - off) <= 1e-9 * value.abs().max(1.0);
                    prop_assert!(near, "{} {} {}: {value} {read}", candidate.effect, candidate.variant.id, p.name);
                }
            }
        }

        #[test]
        fn nominal_values_and_bounds_read_back_exactly(robot in robots(), bounds in prop::array::uniform6(0..3usize)) {
            for candidate in Candidate::all(CATALOGUE) {
                let parameters = || candidate.variant.parameters.iter();
                let value = |(p, bound): (&super::super::Parameter, &usize)| match p.report {
                    Report::Direction => p.nominal,
                    _ => [p.bounds[0], p.bounds[1], p.nominal][*bound],
                };
                let values: Vec<f64> = parameters().zip(&bounds).map(value).collect();
                prop_assert_eq!(round_trip(&candidate, &values, &robot), values, "{}", candidate.effect);
            }
        }
    }

    /// What a diagnosis reports is in the file, by the same name.
    #[test]
    fn files_hold_the_names_that_a_diagnosis_reports() {
        let robot = mindgap_built_in_robot::default_robot();
        for candidate in Candidate::all(CATALOGUE) {
            let values = candidate.variant.initial_guesses(1.0).remove(0);
            let applied = AppliedEffect::new(&candidate, &values, &robot);
            for (name, reported) in candidate.variant.reported(&values, &robot) {
                match (applied.parameters[&name], reported.as_f64()) {
                    (Setting::Number(number), Some(rounded)) => {
                        assert!((number - rounded).abs() <= 0.05 + 0.005 * number.abs(), "{name}: {number} {rounded}");
                    }
                    (side, _) => assert_eq!(Some(side.to_string().as_str()), reported.as_str()),
                }
            }
        }
    }

    #[test]
    fn impossible_settings_are_refused() {
        let robot = mindgap_built_in_robot::default_robot();
        let resolve = |effect: &str, variant: &str, parameters: &str| {
            let parameters = serde_json::from_str(parameters).unwrap();
            AppliedEffect { effect: effect.into(), variant: variant.into(), parameters, definition: None, sensor: None }
                .resolve(&robot)
        };
        let latency = |parameters: &str| resolve("latency", "delay", parameters);
        assert!(latency(r#"{"ms": 100.0}"#).is_ok());
        for wrong in [r#"{"ms": -4000.0}"#, r#"{"ms": "left"}"#, "{}", r#"{"ms": 100.0, "s": 0.1}"#] {
            assert!(latency(wrong).is_err(), "{wrong}");
        }
        let weak = |parameters: &str| resolve("motor_asymmetry", "command", parameters).ok().map(|(_, values)| values);
        assert_eq!(weak(r#"{"side": "right", "factor": 0.75}"#), Some(vec![-0.25]));
        for wrong in
            [r#"{"factor": 0.75}"#, r#"{"side": "left"}"#, r#"{"side": 1.0, "factor": 0.75}"#, r#"{"loss": 0.25}"#]
        {
            assert_eq!(weak(wrong), None, "{wrong}");
        }
    }
}
