//! The effects that a diagnosis knows: one file each, and one line here.
//!
//! Shared helpers for commands, distances and forces are below and in `drive`.

mod drive;

use super::context::{CommandHistory, StepContext};
use super::parameter::parameters;
use super::scales::{CREEPING, CREEPING_RAD_S, HALF_SPEED};
use super::{Effect, Place, Variant};
use mindgap_foundations::motion::Motion;

/// Declares the modules and lists them, so that an effect cannot be in one place and not in the other.
macro_rules! catalogue {
    ($($effect:ident)*) => {
        $(mod $effect;)*

        /// All effects, in the order of the table in docs/reference/effects.md.
        pub static CATALOGUE: &[&Effect] = &[$(&$effect::EFFECT),*];
    };
}

catalogue! {
    battery_sag
    motor_asymmetry
    drive_scale
    track_width
    deadband
    saturation
    latency
    inertia
    rate_limit
    turn_lag
    payload
    slope
    slip
    turn_loss
    carpet_nap
    sonar_scale
    sonar_offset
    sonar_yaw
    sonar_pitch
    sonar_beam
    sonar_ghost
    sonar_dropout
    sonar_lag
    sonar_absorption
    sonar_crosstalk
    sonar_multipath
    sonar_noise
    tracker_rotation
    tracker_scale
    lens_distortion
    marker_offset
    compass_disturbance
    heading_lag
    tracker_delay
}

/// A variant with the id of its effect.
#[derive(Clone, Copy)]
pub struct Candidate {
    /// Id of the effect.
    pub effect: &'static str,
    /// One of its variants.
    pub variant: &'static Variant,
}

impl Candidate {
    /// All variants of all effects of a catalogue.
    pub fn all(catalogue: &[&'static Effect]) -> Vec<Candidate> {
        let of = |effect: &&'static Effect| {
            let effect: &'static Effect = effect;
            effect.variants.iter().map(|variant| Candidate { effect: effect.id, variant })
        };
        catalogue.iter().flat_map(of).collect()
    }

    /// The variant of an effect, by their ids.
    pub fn named(effect: &str, variant: &str) -> Option<Candidate> {
        Candidate::named_in(CATALOGUE, effect, variant)
    }

    /// The same of another catalogue.
    pub fn named_in(catalogue: &[&'static Effect], effect: &str, variant: &str) -> Option<Candidate> {
        Candidate::all(catalogue).into_iter().find(|c| c.effect == effect && c.variant.id == variant)
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.effect == other.effect && self.variant.id == other.variant.id
    }
}

/// Returns where in the robot the effect with this id sits, if that is known.
pub fn place(effect: &str) -> Option<Place> {
    CATALOGUE.iter().find(|known| known.id == effect)?.place
}

/// Where fits of a direction start: the four quarters.
const DIRECTIONS_DEG: [f64; 4] = [0.0, 90.0, 180.0, -90.0];

/// Changes the magnitude of every command and keeps its sign; `change` takes the magnitude and the motor, 0 for left.
fn each_command(commands: &mut CommandHistory, change: impl Fn(f64, usize) -> f64) {
    for pair in commands {
        for (motor, command) in pair.iter_mut().enumerate() {
            *command = change(command.abs(), motor) * command.signum();
        }
    }
}

/// Changes the distance that each wheel covers; `change` takes the distance and the wheel, 0 for left.
fn each_wheel(context: &StepContext, increment: &mut Motion<f64>, change: impl Fn(f64, usize) -> f64) {
    let (arc, track_cm) = (increment.arc(), context.robot.track_cm);
    let [left_cm, right_cm] = arc.wheels_cm(track_cm);
    *increment = arc.with_wheels([change(left_cm, 0), change(right_cm, 1)], track_cm).motion();
}

/// Returns the distance that a force of strength one costs per step: a fraction grows with the distance covered, the rest is
/// that of [`HALF_SPEED`] at any speed.
fn distance_lost_cm(with_speed: f64, covered_cm: f64, context: &StepContext) -> f64 {
    loaded(with_speed, covered_cm.abs(), HALF_SPEED * context.reference_cm())
}

/// Returns a drag: the fraction `with_speed` of it grows with the speed, and the rest is that at `reference`, at any speed.
fn loaded(with_speed: f64, speed: f64, reference: f64) -> f64 {
    with_speed * speed + (1.0 - with_speed) * reference
}

/// Returns how much a step counts as motion, 0 to 1.
fn moving(covered_cm: f64, context: &StepContext) -> f64 {
    (covered_cm.abs() / (CREEPING * context.reference_cm())).min(1.0)
}

/// Returns how much a turn scrubs the tyres, -1 to 1, with the sign of the turn.
fn scrubbing(turn_rad: f64, context: &StepContext) -> f64 {
    libm::tanh(turn_rad / (CREEPING_RAD_S * context.step_s()))
}

/// Returns a distance made longer or shorter, at least 0 in magnitude; a robot at rest stays at rest.
fn pushed_cm(covered_cm: f64, more_cm: f64, context: &StepContext) -> f64 {
    (covered_cm.abs() + moving(covered_cm, context) * more_cm).max(0.0) * covered_cm.signum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::effects::SensorState;
    use crate::effects::chain::EffectChain;
    use crate::effects::context::{HISTORY, RunHistory, Surroundings};
    use crate::sonar::Perturbation;
    use mindgap_foundations::geometry::{Pose, wrap_rad};
    use mindgap_logs::{Robot, Scene};

    /// The effects of the table in docs/reference/effects.md.
    const TABLE: usize = 34;

    /// Returns commands, motion and sensor of a step with an effect.
    fn applied(
        variant: &'static Variant,
        values: &[f64],
        context: &StepContext,
    ) -> (CommandHistory, Motion<f64>, SensorState) {
        let effects = EffectChain::default().with(&[variant], values);
        let mut commands = [[0.0; 2]; HISTORY];
        let increment = effects.wrap(context, |now, before| {
            commands[0] = now;
            commands[1] = before;
            Motion { forward: 7.0, lateral: -0.4, turn: 0.3 }
        });
        (commands, increment, effects.sensor(context))
    }

    fn context() -> impl Strategy<Value = StepContext> {
        let commands = prop::array::uniform16(prop::array::uniform2(-100.0..100.0));
        let pose = || (10.0..290.0, 10.0..210.0, -3.0..3.0).prop_map(|(x, y, h)| Pose::new(x, y, h));
        (commands, pose(), pose(), 0.0..2.0, any::<bool>()).prop_map(|(commands, pose, earlier, elapsed_min, echo)| {
            let robot = mindgap_built_in_robot::default_robot();
            let scene = Scene { arena_cm: Some(glam::DVec2::new(300.0, 220.0)), ..Scene::default() };
            StepContext {
                commands,
                earlier: std::array::from_fn(|i| (i == 0).then_some(earlier)),
                faced: Some([80.0, 0.2]),
                echo_before: Some(echo),
                ..Surroundings::new(&robot, &scene).context(&RunHistory::default(), elapsed_min * 60_000.0, pose)
            }
        })
    }

    #[test]
    fn the_catalogue_is_the_table() {
        let mut ids: Vec<&str> = CATALOGUE.iter().map(|effect| effect.id).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!((ids.len(), CATALOGUE.len()), (TABLE, TABLE), "{ids:?}");
    }

    #[test]
    fn every_effect_says_what_it_looks_like_and_what_imitates_it() {
        for Effect { id, in_logs, imitated_by, .. } in CATALOGUE {
            assert!(in_logs.ends_with('.'), "{id}");
            assert!(
                imitated_by.iter().all(|other| other != id && CATALOGUE.iter().any(|effect| effect.id == *other)),
                "{id}"
            );
        }
    }

    #[test]
    fn ids_of_variants_and_names_of_parameters_are_unique() {
        let unique = |mut names: Vec<&str>| {
            let all = names.len();
            names.sort_unstable();
            names.dedup();
            names.len() == all
        };
        for effect in CATALOGUE {
            assert!(unique(effect.variants.iter().map(|v| v.id).collect()), "{}", effect.id);
            for variant in effect.variants {
                assert!(unique(variant.parameters.iter().map(|p| p.name).collect()), "{} {}", effect.id, variant.id);
            }
        }
    }

    #[test]
    fn fits_start_within_the_bounds_and_not_where_nothing_changes() {
        for Candidate { effect, variant } in Candidate::all(CATALOGUE) {
            for start in variant.initial_guesses(1.0) {
                assert!(start.iter().zip(variant.parameters).all(|(v, p)| p.allows(*v)), "{effect} {}", variant.id);
                assert_ne!(start, variant.nominal(), "{effect} {}", variant.id);
            }
        }
    }

    /// What each effect reports by the table in docs/reference/effects.md, and what slip and dropouts report besides: the loss, and
    /// the persistence of a dropout.
    const REPORTED: [(&str, &[&str]); TABLE + 3] = [
        ("battery_sag", &["loss_per_min"]),
        ("motor_asymmetry", &["side", "factor"]),
        ("drive_scale", &["factor"]),
        ("track_width", &["factor"]),
        ("deadband", &["command"]),
        ("saturation", &["acts_on", "command"]),
        ("saturation twist", &["acts_on", "command", "turn_deg_s"]),
        ("latency", &["ms"]),
        ("inertia", &["ms"]),
        ("rate_limit wheel", &["acts_on", "cm_s2"]),
        ("rate_limit twist", &["acts_on", "cm_s2", "deg_s2"]),
        ("turn_lag", &["ms"]),
        ("payload", &["side", "loss"]),
        ("slope", &["direction_deg", "loss"]),
        ("slip", &["onset", "loss"]),
        ("turn_loss", &["cm_per_rad"]),
        ("carpet_nap", &["direction_deg", "loss"]),
        ("sonar_scale", &["factor"]),
        ("sonar_offset", &["cm"]),
        ("sonar_yaw", &["deg"]),
        ("sonar_pitch", &["cm"]),
        ("sonar_beam", &["factor"]),
        ("sonar_ghost", &["probability", "cm"]),
        ("sonar_dropout", &["probability", "persistence"]),
        ("sonar_lag", &["steps"]),
        ("sonar_absorption", &["factor"]),
        ("sonar_crosstalk", &["probability"]),
        ("sonar_multipath", &["probability"]),
        ("sonar_multipath mirrored", &["factor"]),
        ("sonar_noise", &["cm"]),
        ("tracker_rotation", &["deg"]),
        ("tracker_scale", &["factor"]),
        ("lens_distortion", &["per_m2"]),
        ("marker_offset", &["ahead_cm", "left_cm"]),
        ("compass_disturbance", &["deg"]),
        ("heading_lag", &["ms"]),
        ("tracker_delay", &["ms"]),
    ];

    #[test]
    fn every_variant_reports_by_the_names_of_the_table() {
        let robot = mindgap_built_in_robot::default_robot();
        for Candidate { effect, variant } in Candidate::all(CATALOGUE) {
            let asked = |id: &str| REPORTED.iter().find(|(known, _)| *known == id).map(|(_, names)| names);
            let asked = asked(&format!("{effect} {}", variant.id)).or_else(|| asked(effect)).expect(effect);
            let reported = variant.reported(&variant.initial_guesses(1.0)[0], &robot);
            let mut names: Vec<&str> = reported.keys().map(String::as_str).collect();
            let mut asked = asked.to_vec();
            names.sort_unstable();
            asked.sort_unstable();
            assert_eq!(names, asked, "{effect} {}", variant.id);
        }
    }

    /// Wheel speeds, not commands, are what effects depend on: a robot of five times the full speed that is sent a fifth of
    /// the commands is the same robot.
    #[test]
    fn the_unit_of_commands_does_not_matter() {
        const TIMES: f64 = 5.0;
        let robot = mindgap_built_in_robot::default_robot();
        let scene = Scene { arena_cm: Some(glam::DVec2::new(300.0, 220.0)), ..Scene::default() };
        let usual = StepContext {
            commands: std::array::from_fn(|age| [[90.0, -35.0], [20.0, 60.0], [-45.0, 5.0], [0.0, 80.0]][age % 4]),
            ..Surroundings::new(&robot, &scene).context(&RunHistory::default(), 60_000.0, Pose::new(120.0, 90.0, 0.7))
        };
        let scaled = StepContext {
            commands: usual.commands.map(|pair| pair.map(|command| command / TIMES)),
            robot: Robot { full_speed_cm_s: TIMES * robot.full_speed_cm_s, ..robot },
            ..usual
        };
        // A command of 100 is full speed by definition, and there this variant changes nothing.
        let refers_to_full_speed = |c: &Candidate| c.effect == "deadband" && c.variant.id == "stretched";
        for candidate in Candidate::all(CATALOGUE).into_iter().filter(|c| !refers_to_full_speed(c)) {
            let Candidate { effect, variant } = candidate;
            for values in variant.initial_guesses(1.0) {
                let (c, m, s) = applied(variant, &values, &usual);
                let (other_c, other_m, other_s) = applied(variant, &values, &scaled);
                let commands = c[..2].as_flattened().iter().zip(other_c[..2].as_flattened());
                let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
                let same = commands.into_iter().all(|(a, b)| near(*a, TIMES * b))
                    && near(m.forward, other_m.forward)
                    && near(m.lateral, other_m.lateral)
                    && near(m.turn, other_m.turn)
                    && s == other_s;
                assert!(same, "{effect} {} {values:?}", variant.id);
            }
        }
    }

    proptest! {
        #[test]
        fn a_nominal_effect_changes_nothing(context in context()) {
            let increment = Motion { forward: 7.0, lateral: -0.4, turn: 0.3 };
            for Candidate { effect, variant } in Candidate::all(CATALOGUE) {
                let (c, m, s) = applied(variant, &variant.nominal(), &context);
                let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
                let same = c[..2].as_flattened().iter().zip(context.commands.as_flattened()).all(|(a, b)| near(*a, *b))
                    && near(m.forward, increment.forward)
                    && near(m.lateral, increment.lateral)
                    && near(m.turn, increment.turn)
                    && near(s.robot.position_cm.distance(context.pose.position_cm), 0.0)
                    && near(wrap_rad(s.robot.heading_rad - context.pose.heading_rad), 0.0)
                    && near(s.yaw_rad, 0.0)
                    && Perturbation { ghost_cm: Perturbation::NONE.ghost_cm, ..s.perturbation } == Perturbation::NONE;
                prop_assert!(same, "{effect} {}", variant.id);
            }
        }

        #[test]
        fn command_only_effects_do_not_depend_on_place_or_time(here in context(), elsewhere in context()) {
            let elsewhere = StepContext { commands: here.commands, ..elsewhere };
            for Candidate { effect, variant } in Candidate::all(CATALOGUE) {
                for values in variant.initial_guesses(1.0) {
                    let [here, elsewhere] = [&here, &elsewhere].map(|context| applied(variant, &values, context));
                    let same = (here.0, here.1) == (elsewhere.0, elsewhere.1);
                    prop_assert!(same || !variant.moves_by_commands_alone(), "{effect} {}", variant.id);
                }
            }
        }

        /// So simulated steps need not compute it.
        #[test]
        fn no_motion_effect_depends_on_what_the_sensor_faces(facing in context()) {
            let unseen = StepContext { faced: None, ..facing };
            for Candidate { effect, variant } in Candidate::all(CATALOGUE) {
                for values in variant.initial_guesses(1.0) {
                    let [facing, unseen] = [&facing, &unseen].map(|context| applied(variant, &values, context));
                    prop_assert_eq!((facing.0, facing.1), (unseen.0, unseen.1), "{} {}", effect, variant.id);
                }
            }
        }

        #[test]
        fn uniform_sensor_effects_do_not_depend_on_place_or_time(here in context(), elsewhere in context()) {
            let elsewhere = StepContext { echo_before: here.echo_before, ..elsewhere };
            for Candidate { effect, variant } in Candidate::all(CATALOGUE) {
                for values in variant.initial_guesses(1.0) {
                    let same = [&here, &elsewhere].map(|context| {
                        let (.., sensor) = applied(variant, &values, context);
                        (sensor.robot == context.pose).then_some(SensorState { robot: here.pose, ..sensor })
                    });
                    let alike = same[0].is_some() && same[0] == same[1];
                    prop_assert!(alike || !variant.senses_alike_everywhere(), "{effect} {}", variant.id);
                }
            }
        }

        #[test]
        fn at_its_bounds_an_effect_stays_finite(context in context(), corner in any::<[bool; 5]>()) {
            for Candidate { effect, variant } in Candidate::all(CATALOGUE) {
                let bound = |(p, high): (&super::super::Parameter, &bool)| p.bounds[usize::from(*high)];
                let values: Vec<f64> = variant.parameters.iter().zip(&corner).map(bound).collect();
                let (c, m, s) = applied(variant, &values, &context);
                let finite = c.as_flattened().iter().all(|c| c.is_finite() && c.abs() <= 200.0)
                    && [m.forward, m.lateral, m.turn, s.yaw_rad, s.perturbation.width].iter().all(|v| v.is_finite())
                    && s.robot.position_cm.is_finite();
                prop_assert!(finite, "{effect} {}", variant.id);
            }
        }
    }
}
