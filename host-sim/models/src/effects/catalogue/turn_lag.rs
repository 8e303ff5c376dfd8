//! The body turns later than its wheels would have it.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "turn_lag",
    name: "turn lag",
    what: "The body turns later than its wheels would have it: it is long or heavy, and its tyres yield.",
    in_logs: "After a change of the command turns approach their new value over several steps; straight runs do at once.",
    imitated_by: &["inertia", "latency"],
    check: "Film a turn on the spot from above: the wheels turn at once, and the body follows. Straight starts show no delay.",
    place: Some(Place::Body),
    needs_known_robot: false,
    variants: &[Variant {
        id: "first_order",
        parameters: TurnLag::PARAMETERS,
        hooks: &[Hook::Filter(&|v, filter| filter.turn_lag_steps += TurnLag::read(v).ms)],
    }],
};

parameters! {
    TurnLag {
        /// Time constant, steps. A skid-steered robot of half a tonne takes 260 ms; nothing that can be steered takes more than a
        /// few steps.
        ms: Parameter::new("ms", 0.0, [-8.0, 8.0])
            .prior_sd(1.0)
            .from(Guesses::At(&[0.2, 0.6]))
            .report(Report::Duration),
    }
}
