//! The effects that a diagnosis knows, one file a family, each effect in every functional form that it may take.

pub mod applied;
pub mod chain;
pub mod drive;
pub mod effect;
pub mod floor;
pub mod frame;
pub mod motor;
pub mod sonar;

use serde_json::{Value, json};

use crate::geometry::wrap_rad;
use effect::{CommandHistory, Variant};

/// All forms of all effects.
pub fn all() -> Vec<&'static Variant> {
    [drive::VARIANTS, motor::VARIANTS, floor::VARIANTS, sonar::VARIANTS, frame::VARIANTS]
        .into_iter()
        .flatten()
        .collect()
}

/// Changes the magnitude of every command and keeps its sign.
fn magnitude(window: &mut CommandHistory, change: impl Fn(f64) -> f64) {
    magnitude_each(window, |c, _| change(c));
}

/// The same with the motor: 0 left, 1 right.
fn magnitude_each(window: &mut CommandHistory, change: impl Fn(f64, usize) -> f64) {
    for commands in window {
        for (motor, c) in commands.iter_mut().enumerate() {
            *c = change(c.abs(), motor) * c.signum();
        }
    }
}

/// Three significant digits.
fn rounded(value: f64) -> Value {
    let text = format!("{value:.2e}");
    json!(text.parse::<f64>().unwrap_or(value))
}

fn degrees(angle_rad: f64) -> Value {
    json!((wrap_rad(angle_rad).to_degrees() * 10.0).round() / 10.0)
}

/// Which side a signed strength means: the left one when positive.
fn side_of(signed: f64) -> Value {
    json!(if signed > 0.0 { "left" } else { "right" })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::effect::{Hook, Parameter, PoseIncrement, Sensor, StepContext};
    use super::*;
    use crate::geometry::Pose;
    use crate::sonar::Perturbation;

    /// The 26 effects of the contracts' table.
    const TABLE: usize = 26;

    /// What comes of a moment: commands, motion, sensor.
    fn applied(form: &Variant, values: &[f64], moment: &StepContext) -> (CommandHistory, PoseIncrement, Sensor) {
        let mut window = moment.commands;
        let mut motion = PoseIncrement { forward_cm: 7.0, lateral_cm: -0.4, turn_rad: 0.3 };
        let mut sensor = Sensor { robot: moment.pose, yaw_rad: 0.0, width: 1.0, change: Perturbation::NONE };
        for act in form.acts {
            match act {
                Hook::Commands(change) => change(values, moment, &mut window),
                Hook::Motion(change) => change(values, moment, &mut motion),
                Hook::Sensor(change) => change(values, moment, &mut sensor),
            }
        }
        (window, motion, sensor)
    }

    fn moment() -> impl Strategy<Value = StepContext> {
        let commands = prop::array::uniform7(prop::array::uniform2(-100.0..100.0));
        let pose = || (10.0..290.0, 10.0..210.0, -3.0..3.0).prop_map(|(x, y, h)| Pose::new(x, y, h));
        (commands, pose(), pose(), 0.0..2.0, any::<bool>()).prop_map(|(commands, pose, earlier, elapsed_min, echo)| {
            StepContext {
                elapsed_min,
                commands,
                pose,
                earlier: [Some(earlier), None],
                faced: Some([80.0, 0.2]),
                faced_before: Some([60.0, 0.1]),
                echo_before: Some(echo),
                middle_cm: DVec2::new(150.0, 110.0),
                track_cm: 11.5,
            }
        })
    }

    #[test]
    fn every_effect_of_the_table_has_a_form() {
        let mut ids: Vec<&str> = all().iter().map(|form| form.id).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), TABLE, "{ids:?}");
    }

    #[test]
    fn starts_lie_within_the_bounds() {
        for form in all() {
            for start in form.starts {
                assert_eq!(start.len(), form.parameters.len(), "{}", form.id);
                let inside = |(v, p): (&f64, &Parameter)| (p.bounds.low..=p.bounds.high).contains(v);
                assert!(start.iter().zip(form.parameters).all(inside), "{}: {}", form.id, form.name);
            }
        }
    }

    proptest! {
        #[test]
        fn a_neutral_effect_changes_nothing(moment in moment()) {
            let untouched = Variant { acts: &[], ..*all()[0] };
            let (window, motion, sensor) = applied(&untouched, &[], &moment);
            for form in all() {
                let (w, m, s) = applied(form, &form.neutral(), &moment);
                let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
                let same = w.as_flattened().iter().zip(window.as_flattened()).all(|(a, b)| near(*a, *b))
                    && near(m.forward_cm, motion.forward_cm)
                    && near(m.lateral_cm, motion.lateral_cm)
                    && near(m.turn_rad, motion.turn_rad)
                    && near(s.robot.position_cm.distance(sensor.robot.position_cm), 0.0)
                    && near(wrap_rad(s.robot.heading_rad - sensor.robot.heading_rad), 0.0)
                    && near(s.yaw_rad, 0.0)
                    && near(s.width, 1.0)
                    && Perturbation { ghost_cm: sensor.change.ghost_cm, ..s.change } == sensor.change;
                prop_assert!(same, "{}: {}", form.id, form.name);
            }
        }

        #[test]
        fn at_its_bounds_an_effect_stays_finite(moment in moment(), corner in any::<[bool; 4]>()) {
            for form in all() {
                let bound = |(p, high): (&Parameter, &bool)| if *high { p.bounds.high } else { p.bounds.low };
                let values: Vec<f64> = form.parameters.iter().zip(&corner).map(bound).collect();
                let (w, m, s) = applied(form, &values, &moment);
                let finite = w.as_flattened().iter().all(|c| c.is_finite() && c.abs() <= 200.0)
                    && [m.forward_cm, m.lateral_cm, m.turn_rad, s.yaw_rad, s.width].iter().all(|v| v.is_finite())
                    && s.robot.position_cm.is_finite();
                prop_assert!(finite, "{}: {}", form.id, form.name);
            }
        }
    }
}
