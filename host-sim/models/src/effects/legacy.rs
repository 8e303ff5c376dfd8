//! Applied effects of older simulator files: those from before variants had ids, which name a variant by a sentence and
//! its parameters by their order, some in other units; and variants that are no longer there.

use serde::Deserialize;
use serde_json::Value;

use super::applied::AppliedEffect;
use super::catalogue::Candidate;
use super::parameter::Parameter;
use mindgap_logs::Robot;

/// The text of a simulator file with its applied effects by today's ids and units; none where they have them already, or
/// where one was never possible.
pub fn upgraded(text: &str) -> Option<Value> {
    let File { robot, added } = serde_json::from_str(text).ok()?;
    let added = added.into_iter().map(|entry| entry.upgrade(&robot)).collect::<Option<Vec<AppliedEffect>>>()?;
    let mut file: Value = serde_json::from_str(text).ok()?;
    let before = std::mem::replace(&mut file["added"], serde_json::to_value(added).ok()?);
    (file["added"] != before).then_some(file)
}

/// What is needed of such a file.
#[derive(Deserialize)]
struct File {
    robot: Robot,
    added: Vec<Entry>,
}

/// An entry of such a file.
#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Named(Box<AppliedEffect>),
    Sentence(LegacyEffect),
}

/// An entry from before variants had ids.
#[derive(Deserialize)]
struct LegacyEffect {
    effect: String,
    form: String,
    values: Vec<f64>,
}

/// The unit in which a parameter was written.
#[derive(Clone, Copy)]
enum Unit {
    /// Today's.
    Same,
    /// Radians for what is in degrees today.
    Radians,
    /// Steps for what is in milliseconds today.
    Steps,
    /// Commands for what is a wheel speed today.
    Command,
    /// It was not written, and always this.
    Constant(f64),
}

impl Entry {
    /// The same by today's ids and units; none where it was never possible.
    fn upgrade(self, robot: &Robot) -> Option<AppliedEffect> {
        match self {
            Entry::Sentence(effect) => effect.upgrade(robot),
            Entry::Named(effect) if effect.variant == EARLIER_READING => {
                let values = vec![*effect.parameters.get("steps")?];
                let form = "the reading before".into();
                LegacyEffect { effect: effect.effect, form, values }.upgrade(robot)
            }
            Entry::Named(mut effect) => {
                if (effect.effect.as_str(), effect.variant.as_str()) == WITHOUT_CREEP {
                    effect.parameters.entry("creep_ms".into()).or_insert(0.0);
                }
                Some(*effect)
            }
        }
    }
}

/// A variant that had no creep once.
const WITHOUT_CREEP: (&str, &str) = ("slip", "growing");

/// A variant that repeated a share of the readings before, which no sensor does. That share was their mean age in steps.
const EARLIER_READING: &str = "earlier_reading";

impl LegacyEffect {
    /// The same by today's ids and units; none where it was never possible.
    fn upgrade(&self, robot: &Robot) -> Option<AppliedEffect> {
        let (effect, _, variant, units) = TABLE.iter().find(|row| row.0 == self.effect && row.1 == self.form)?;
        let candidate = Candidate::named(effect, variant)?;
        let mut written = self.values.iter().copied();
        let today = |unit: &Unit| match unit {
            Unit::Same => written.next(),
            Unit::Radians => written.next().map(f64::to_degrees),
            Unit::Steps => written.next().map(|steps| steps * robot.step_ms),
            Unit::Command => written.next().map(|command| command / 100.0 * robot.full_speed_cm_s),
            Unit::Constant(value) => Some(*value),
        };
        let values = units.iter().map(today).collect::<Option<Vec<f64>>>()?;
        let whole = written.next().is_none() && values.iter().all(|v| v.is_finite());
        // What was a bound of commands may lie beyond today's bound of speeds, where nothing changes any more.
        let within = |(v, p): (f64, &Parameter)| v.clamp(p.bounds[0], p.bounds[1]);
        let values: Vec<f64> = values.into_iter().zip(candidate.variant.parameters).map(within).collect();
        whole.then(|| AppliedEffect::new(&candidate, &values))
    }
}

/// Effect, sentence, id of the variant, and the units of its parameters.
type Row = (&'static str, &'static str, &'static str, &'static [Unit]);

use Unit::{Command, Constant, Radians, Same, Steps};

const TABLE: &[Row] = &[
    ("battery_sag", "commands weaken", "command", &[Same]),
    ("battery_sag", "ways shorten", "distance", &[Same]),
    ("motor_asymmetry", "a weaker command", "command", &[Same]),
    ("motor_asymmetry", "a shorter way", "distance", &[Same]),
    ("drive_scale", "longer ways", "distance", &[Same]),
    ("drive_scale", "stronger commands", "command", &[Same]),
    ("track_width", "smaller turns", "turn", &[Same]),
    ("deadband", "small commands do nothing", "cut", &[Command]),
    ("deadband", "friction eats its part of every command", "subtracted", &[Command]),
    ("deadband", "full commands are as before", "stretched", &[Command]),
    ("saturation", "a limit", "hard", &[Command]),
    ("saturation", "a soft limit", "soft", &[Command]),
    ("latency", "part of the step still has the command before", "delay", &[Steps]),
    ("inertia", "the step lags, and what lags dies away", "first_order_lag", &[Steps, Same]),
    ("payload", "commands lose, more on one side", "command", &[Same, Same]),
    ("payload", "ways shorten, more on one side", "distance", &[Same, Same]),
    (
        "payload",
        "ways shorten on one side, and a heavy robot is slow to start and to turn",
        "heavy",
        &[Same, Same, Same, Constant(1.0), Same],
    ),
    (
        "payload",
        "a wheel rolls hard at any speed, and a heavy robot is slow to start",
        "rolling_resistance",
        &[Same, Same, Same, Same],
    ),
    ("slope", "a drift downhill while moving", "drift", &[Radians, Same]),
    (
        "slope",
        "a gain or loss that grows with speed in part, and sideways down in part",
        "gain_and_slide",
        &[Radians, Same, Same, Same],
    ),
    (
        "carpet_nap",
        "drag that grows with speed in part, and sets in softly in part",
        "against_the_nap",
        &[Radians, Same, Same, Same],
    ),
    ("carpet_nap", "drag along an axis", "along_an_axis", &[Radians, Same]),
    ("slip", "large commands lose grip", "fast", &[Command, Same]),
    ("slip", "large changes lose grip", "change", &[Command, Same]),
    ("slip", "large changes lose way", "distance", &[Command, Same]),
    (
        "slip",
        "large changes lose more than in proportion, and turns drag",
        "growing",
        &[Command, Same, Same, Constant(0.0)],
    ),
    ("sonar_scale", "a factor", "gain", &[Same]),
    ("sonar_offset", "a length", "length", &[Same]),
    ("sonar_yaw", "a turned axis", "axis", &[Radians]),
    ("sonar_beam", "another width", "width", &[Same]),
    ("sonar_beam", "another width, and another strength with it", "width_and_strength", &[Same, Same]),
    ("sonar_beam", "a beam where a ray was thought", "beam_for_ray", &[Same]),
    ("sonar_ghost", "in place of an echo", "for_an_echo", &[Same, Same]),
    ("sonar_ghost", "whether there is an echo or not", "always", &[Same, Same]),
    ("sonar_dropout", "a missing reading is followed by another", "two_states", &[Same, Same]),
    ("sonar_lag", "where the robot was", "earlier_pose", &[Steps]),
    ("sonar_lag", "the reading before", "earlier_pose", &[Steps]),
    ("sonar_absorption", "less comes back", "everywhere", &[Same]),
    ("sonar_absorption", "less comes back from afar", "with_distance", &[Same]),
    ("sonar_absorption", "less comes back from aslant", "with_incidence", &[Same]),
    ("sonar_crosstalk", "a random short reading", "short", &[Same]),
    ("sonar_noise", "more scatter", "normal", &[Same]),
    ("tracker_rotation", "about the scene's middle", "about_the_middle", &[Radians]),
    ("tracker_rotation", "about the origin", "about_the_origin", &[Radians]),
    ("tracker_rotation", "positions right, headings off", "heading", &[Radians]),
    ("tracker_scale", "about the scene's middle", "about_the_middle", &[Same]),
    ("tracker_scale", "about the origin", "about_the_origin", &[Same]),
    ("lens_distortion", "grows with the square of the distance", "quadratic", &[Same]),
    ("compass_disturbance", "one wave a turn", "hard_iron", &[Radians, Radians]),
    ("compass_disturbance", "two waves a turn", "soft_iron", &[Radians, Radians]),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::CATALOGUE;

    #[test]
    fn every_row_leads_to_a_variant_with_as_many_parameters() {
        for (effect, _, variant, units) in TABLE {
            let candidate = Candidate::named(effect, variant).expect(variant);
            assert_eq!(candidate.variant.parameters.len(), units.len(), "{effect} {variant}");
        }
        assert!(TABLE.len() <= Candidate::all(CATALOGUE).len());
    }

    #[test]
    fn the_reading_before_is_a_pose_earlier_by_its_mean_age() {
        let robot = mindgap_built_in_robot::default_robot();
        let file = |added: Value| serde_json::json!({ "robot": robot, "added": [added] }).to_string();
        let lag_ms = |added: Value| {
            let file = upgraded(&file(added))?;
            let effect: AppliedEffect = serde_json::from_value(file["added"][0].clone()).ok()?;
            effect.resolve().ok().map(|(_, values)| values[0])
        };
        let entry = |variant: &str, name: &str, value: f64| serde_json::json!({ "effect": "sonar_lag", "variant": variant, "parameters": { name: value } });
        assert_eq!(lag_ms(entry("earlier_reading", "steps", 0.5)), Some(0.5 * robot.step_ms));
        let sentence = serde_json::json!({ "effect": "sonar_lag", "form": "the reading before", "values": [0.5] });
        assert_eq!(lag_ms(sentence), Some(0.5 * robot.step_ms));
        assert_eq!(lag_ms(entry("earlier_pose", "lag_ms", 80.0)), None, "as it is today");
    }

    #[test]
    fn tyres_that_never_crept_do_not_creep() {
        let robot = mindgap_built_in_robot::default_robot();
        let parameters = serde_json::json!({ "onset_cm_s": 12.0, "loss": 0.4, "turn_drag_rad": 0.01 });
        let added = serde_json::json!([{ "effect": "slip", "variant": "growing", "parameters": parameters }]);
        let file = upgraded(&serde_json::json!({ "robot": robot, "added": added }).to_string()).unwrap();
        let effect: AppliedEffect = serde_json::from_value(file["added"][0].clone()).unwrap();
        assert_eq!(effect.resolve().map(|(_, values)| values), Ok(vec![12.0, 0.4, 0.01, 0.0]));
    }

    #[test]
    fn units_are_converted() {
        let robot = mindgap_built_in_robot::default_robot();
        let legacy = |effect: &str, form: &str, value| {
            let old = LegacyEffect { effect: effect.into(), form: form.into(), values: vec![value] };
            old.upgrade(&robot).and_then(|new| new.resolve().ok()).map(|(_, values)| values[0])
        };
        let part = "part of the step still has the command before";
        assert_eq!(legacy("latency", part, 0.5), Some(0.5 * robot.step_ms));
        assert_eq!(legacy("saturation", "a limit", 50.0), Some(0.5 * robot.full_speed_cm_s));
        assert_eq!(legacy("sonar_yaw", "a turned axis", 0.1), Some(0.1f64.to_degrees()));
        assert_eq!(legacy("latency", "another sentence", 0.5), None);
    }
}
