//! Both wheels slow down in turns: a caster that has to be dragged round.

use mindgap_models::effects::parameter::Guesses;
use mindgap_models::effects::{Effect, Hook, Parameter, Variant};

pub const EFFECT: Effect = Effect {
    id: "turning_loss",
    name: "turning_loss",
    what: "Made up.",
    in_logs: "",
    imitated_by: &[],
    check: "None.",
    place: None,
    needs_known_robot: false,
    variants: &[Variant {
        id: "with_turn_rate",
        parameters: &[LOSS],
        hooks: &[Hook::Motion(&|v, context, increment| {
            let turn_rad_s = increment.turn.abs() / context.step_s();
            increment.forward *= (1.0 - v[0] * turn_rad_s).max(0.0);
        })],
    }],
};

/// Share of forward speed lost per rad/s of turn rate. An NXT robot turns by 2 to 6 rad/s on the spot; with half of its
/// speed lost at 1 rad/s it could not drive an arc.
const LOSS: Parameter = Parameter {
    name: "loss_per_rad_s",
    ..Parameter::new("s/rad", 0.0, [0.0, 0.5]).prior_sd(0.2).from(Guesses::At(&[0.03, 0.1]))
};
