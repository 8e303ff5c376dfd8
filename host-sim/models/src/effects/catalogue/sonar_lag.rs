//! Readings are old: they are of where the robot was.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, StepContext, Variant};
use mindgap_foundations::geometry::{Pose, wrap_rad};

pub const EFFECT: Effect = Effect {
    id: "sonar_lag",
    name: "old readings",
    what: "Readings are of where the robot was a while ago.",
    in_logs: "Readings are too long on the way towards a wall and too short on the way from it.",
    imitated_by: &["latency", "sonar_offset"],
    check: "Drive straight at a wall and film the display beside a ruler: the reading is that of a place behind.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[Variant {
        id: "earlier_pose",
        parameters: Lag::PARAMETERS,
        hooks: &[Hook::SensorHere(&|v, context, sensor| sensor.robot = earlier(Lag::read(v).lag_ms, context))],
    }],
};

parameters! {
    Lag {
        /// Age of a reading. An NXT sensor takes 35 to 75 ms, a program that hands readings through or averages them a few
        /// steps, of 400 ms in the paper.
        lag_ms: Parameter::new("ms", 0.0, [0.0, 1600.0])
            .prior_sd(300.0)
            .from(Guesses::At(&[80.0, 240.0, 400.0, 640.0, 1200.0]))
            .report(Report::Steps),
    }
}

/// Returns where the robot was `lag_ms` ago, interpolated between the two nearest known poses; the oldest known pose where
/// none is that old.
fn earlier(lag_ms: f64, context: &StepContext) -> Pose {
    let steps = lag_ms / context.robot.step_ms;
    let (mut newer, mut newer_steps) = (context.pose, 0.0);
    for (i, known) in context.earlier.iter().enumerate() {
        let Some(pose) = known else { continue };
        let age_steps = (i + 1) as f64;
        if steps <= age_steps {
            return between(&newer, pose, (steps - newer_steps) / (age_steps - newer_steps));
        }
        (newer, newer_steps) = (*pose, age_steps);
    }
    newer
}

/// Returns the pose at a fraction of the way from `newer` back to `older`.
fn between(newer: &Pose, older: &Pose, share: f64) -> Pose {
    let turn_rad = wrap_rad(older.heading_rad - newer.heading_rad);
    Pose {
        position_cm: newer.position_cm.lerp(older.position_cm, share),
        heading_rad: wrap_rad(newer.heading_rad + share * turn_rad),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::context::{RunHistory, Surroundings};

    /// At 400 ms per step: at x = 100 now, 90 and 60 one and three steps ago, and not seen in between.
    fn x_cm(lag_ms: f64) -> f64 {
        let robot = mindgap_built_in_robot::default_robot();
        let surroundings = Surroundings::new(&robot, &mindgap_built_in_robot::training_room());
        let at = |x_cm: f64| Pose::new(x_cm, 50.0, 0.0);
        let mut context = surroundings.context(&RunHistory::default(), 0.0, at(100.0));
        context.earlier[0] = Some(at(90.0));
        context.earlier[2] = Some(at(60.0));
        earlier(lag_ms, &context).position_cm.x
    }

    #[test]
    fn a_reading_is_of_where_the_robot_was() {
        assert_eq!([0.0, 200.0, 400.0, 800.0, 1200.0].map(x_cm), [100.0, 95.0, 90.0, 75.0, 60.0]);
        assert_eq!(x_cm(2000.0), 60.0, "beyond what is known");
    }
}
