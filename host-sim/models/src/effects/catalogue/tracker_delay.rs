//! Poses are old.
//!
//! To the motion an old pose is a late command. Readings tell them apart: they are made where the robot is by then.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Late, Parameter, Place, SensorState, StepContext, Variant};
use mindgap_foundations::motion::Motion;

pub const EFFECT: Effect = Effect {
    id: "tracker_delay",
    name: "old poses",
    what: "Tracked poses are old: each is of where the robot was a fixed time ago.",
    in_logs: "The motion is that of the command before, and readings are those of a place ahead of the pose.",
    imitated_by: &["latency", "sonar_lag"],
    check: "Push the robot by hand against a wall and film it together with the live pose: count the frames from the bump to the pose \
            that stands still.",
    place: Some(Place::Tracker),
    needs_known_robot: false,
    variants: &[Variant {
        id: "age",
        parameters: Delay::PARAMETERS,
        hooks: &[
            Hook::Delay(&|v| Late { drive_steps: Delay::read(v).ms, ..Late::default() }),
            Hook::SensorHere(&|v, context, sensor| move_on(Delay::read(v).ms, context, sensor)),
        ],
    }],
};

parameters! {
    Delay {
        /// Age of a pose, steps. Cameras and the programs behind them take 30 to 300 ms; with poses older than a few steps nothing can
        /// be steered.
        ms: Parameter::new("ms", 0.0, [0.0, 8.0])
            .prior_sd(1.0)
            .from(Guesses::At(&[0.2, 0.6]))
            .report(Report::Duration),
    }
}

/// Moves the sensor to where the robot is by now, as the textbook drives the commands since its pose.
fn move_on(steps: f64, context: &StepContext, sensor: &mut SensorState) {
    let whole = (steps as usize).min(context.commands.len() - 2);
    let begun = driven(context, whole + 1, steps - whole as f64).end(&sensor.robot);
    sensor.robot = (1..=whole).rev().fold(begun, |pose, ago| driven(context, ago, 1.0).end(&pose));
}

/// Returns the textbook's motion under a command of some steps ago, over a share of a step.
fn driven(context: &StepContext, ago: usize, share: f64) -> Motion<f64> {
    let wheels_cm = context.commands[ago].map(|command| share * context.wheel_speed_cm_s(command) * context.step_s());
    Motion::ZERO.arc().with_wheels(wheels_cm, context.robot.track_cm).motion()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::context::{RunHistory, Surroundings};
    use mindgap_foundations::geometry::Pose;
    use mindgap_logs::Scene;

    /// Of 40 % of full speed, 41 cm/s, a step of 400 ms is 6.56 cm; before it, it drove at half of that.
    #[test]
    fn readings_are_made_where_the_robot_is_by_then() {
        let robot = mindgap_built_in_robot::default_robot();
        let mut context = Surroundings::new(&robot, &Scene::default()).context(
            &RunHistory::default(),
            0.0,
            Pose::new(50.0, 0.0, 0.0),
        );
        context.commands[1] = [40.0; 2];
        context.commands[2] = [20.0; 2];
        for (steps, x_cm) in [(0.0, 50.0), (0.5, 53.28), (1.0, 56.56), (1.5, 58.2)] {
            let mut sensor = SensorState::nominal(context.pose);
            move_on(steps, &context, &mut sensor);
            assert!((sensor.robot.position_cm.x - x_cm).abs() < 1e-9, "{steps}: {:?}", sensor.robot);
        }
    }
}
