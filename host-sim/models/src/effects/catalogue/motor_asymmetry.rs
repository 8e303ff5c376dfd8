//! One motor is weaker than it was.

use super::{each_wheel, parameters};
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "motor_asymmetry",
    name: "weaker motor",
    what: "One motor turns slower than it did at the same command, so the robot bends to that side.",
    in_logs: "Straight commands bend to one side, in proportion to the speed.",
    imitated_by: &["payload", "slip"],
    check: "Lift the robot, give both motors the same command for ten seconds, and count the turns of both wheels; \
            or command a straight metre and measure how far to one side it ends.",
    place: Some(Place::Motor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "command",
            parameters: Asymmetry::PARAMETERS,
            hooks: &[Hook::Commands(&|v, _, commands| {
                let factors = Asymmetry::read(v).factors();
                commands.iter_mut().for_each(|c| *c = [c[0] * factors[0], c[1] * factors[1]]);
            })],
        },
        Variant {
            id: "distance",
            parameters: Asymmetry::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let factors = Asymmetry::read(v).factors();
                each_wheel(context, increment, |cm, wheel| cm * factors[wheel]);
            })],
        },
    ],
};

parameters! {
    Asymmetry {
        /// Share of speed that the left motor lacks; negative: the right one. NXT motors differ by a few per cent when
        /// new; one that has lost half of its speed is about to stall.
        loss: Parameter::new("", 0.0, [-0.5, 0.5])
            .prior_sd(0.15)
            .from(Guesses::At(&[0.05, -0.05]))
            .report(Report::SideAndFactor),
    }
}

impl Asymmetry {
    fn factors(&self) -> [f64; 2] {
        [1.0 - self.loss.max(0.0), 1.0 + self.loss.min(0.0)]
    }
}
