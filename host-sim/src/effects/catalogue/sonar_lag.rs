//! Readings are old.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Variant};
use crate::geometry::{Pose, wrap_rad};

pub const EFFECT: Effect = Effect {
    id: "sonar_lag",
    variants: &[
        Variant {
            id: "earlier_pose",
            parameters: Lag::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, context, sensor| {
                let steps = Lag::read(v).lag_ms / context.robot.step_ms;
                let known = [Some(context.pose), context.earlier[0], context.earlier[1]];
                let whole = (steps as usize).min(1);
                let (Some(newer), Some(older)) = (known[whole], known[whole + 1]) else { return };
                sensor.robot = between(&newer, &older, (steps - whole as f64).min(1.0));
            })],
        },
        Variant {
            id: "earlier_reading",
            parameters: Stale::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, context, sensor| {
                // Where the same is faced as before, readings repeat anyway.
                let (Some([now_cm, _]), Some([before_cm, _])) = (context.faced, context.faced_before) else { return };
                if (now_cm - before_cm).abs() > OTHER_CM {
                    sensor.perturbation.p_stale = Stale::read(v).steps;
                }
            })],
        },
    ],
};

parameters! {
    Lag {
        /// Age of a reading. An NXT sensor takes 35 to 75 ms, a program that hands readings through a step or two.
        lag_ms: Parameter::new("ms", 0.0, [0.0, 800.0])
            .prior_sd(300.0)
            .from(Guesses::At(&[80.0, 240.0, 400.0, 640.0]))
            .report(Report::Steps),
    }
}

parameters! {
    Stale {
        /// Share of readings that are the one before: their mean age in steps.
        steps: Parameter::new("steps", 0.0, [0.0, 1.0]).prior_sd(0.5).from(Guesses::At(&[0.1, 0.5])),
    }
}

/// Distances that differ by more than a reading scatters are of something else.
const OTHER_CM: f64 = 4.0;

/// The pose at a share of the way from `newer` back to `older`.
fn between(newer: &Pose, older: &Pose, share: f64) -> Pose {
    let turn_rad = wrap_rad(older.heading_rad - newer.heading_rad);
    Pose {
        position_cm: newer.position_cm.lerp(older.position_cm, share),
        heading_rad: wrap_rad(newer.heading_rad + share * turn_rad),
    }
}
