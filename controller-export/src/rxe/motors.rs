//! The motors: the tuples' commands, and the detection of wheels that do not turn.

use mindgap_core::controller::{Controller, FULL_SPEED};

use super::assembler::{Assembler, Label};
use super::layout::{Array, Number};
use crate::bytecode::{Comparison, OutputField, RUN_STATE_RUNNING, Type, mode, update};
use crate::onboard::{self, STALL_POWER};
use crate::wiring::Wiring;

/// The motors and the tuples' commands.
pub(super) struct Motors {
    /// Port and powers of the left and the right motor.
    pub(super) sides: [(Number, Array); 2],
    power: Number,
    on: Number,
    running: Number,
    flags: Number,
}

impl Motors {
    pub(super) fn declare(asm: &mut Assembler, controller: &Controller, wiring: &Wiring) -> Self {
        let clamped = |speed: i8| i32::from(speed.clamp(-FULL_SPEED, FULL_SPEED));
        let left = controller.tuples.iter().map(|tuple| clamped(tuple.left));
        let right = controller.tuples.iter().map(|tuple| clamped(tuple.right));
        Motors {
            power: asm.number(Type::I8, 0),
            on: asm.number(Type::U8, (mode::MOTOR_ON | mode::BRAKE).into()),
            running: asm.number(Type::U8, RUN_STATE_RUNNING.into()),
            flags: asm.number(Type::U8, (update::MODE | update::SPEED).into()),
            sides: [
                (asm.number(Type::U8, wiring.left as i32), asm.array(Type::I8, left)),
                (asm.number(Type::U8, wiring.right as i32), asm.array(Type::I8, right)),
            ],
        }
    }

    pub(super) fn set(&self, asm: &mut Assembler, tuple: Number) {
        for (port, powers) in self.sides {
            asm.index(self.power, powers, tuple);
            self.run(asm, port);
        }
    }

    /// Sets power 0 with the brake on.
    pub(super) fn stop(&self, asm: &mut Assembler) {
        asm.set(self.power, 0);
        for (port, _) in self.sides {
            self.run(asm, port);
        }
    }

    fn run(&self, asm: &mut Assembler, port: Number) {
        asm.set_output(
            port,
            [
                (OutputField::Mode, self.on),
                (OutputField::Power, self.power),
                (OutputField::RunState, self.running),
                (OutputField::Flags, self.flags),
            ],
        );
    }
}

/// Counts the steps in which a driven wheel has not turned.
pub(super) struct Stall {
    still_steps: Number,
    max_steps: Number,
    min_deg: Number,
    min_power: Number,
    power: Number,
    /// Rotation at the last step, and rotation during it, of the left and the right wheel.
    sides: [(Number, Number); 2],
}

impl Stall {
    pub(super) fn declare(asm: &mut Assembler, step_ms: u16) -> Self {
        Stall {
            sides: std::array::from_fn(|_| (asm.number(Type::I32, 0), asm.number(Type::I32, 0))),
            min_deg: asm.number(Type::U16, onboard::stall_deg(step_ms).into()),
            still_steps: asm.number(Type::U16, 0),
            max_steps: asm.number(Type::U16, onboard::stalled_steps(step_ms).into()),
            min_power: asm.number(Type::U8, STALL_POWER.into()),
            power: asm.number(Type::I8, 0),
        }
    }

    /// Checks both wheels after a step with the commands of `tuple`.
    pub(super) fn count(&self, asm: &mut Assembler, motors: &Motors, tuple: Number, one: Number) {
        let [still, counted] = std::array::from_fn(|_| asm.label());
        for ((port, _), (at_deg, turned_deg)) in motors.sides.into_iter().zip(self.sides) {
            asm.mov(turned_deg, at_deg);
            asm.get_output(at_deg, port, OutputField::RotationCount);
            asm.sub(turned_deg, at_deg, turned_deg);
            asm.abs(turned_deg, turned_deg);
        }
        for ((_, powers), (_, turned_deg)) in motors.sides.into_iter().zip(self.sides) {
            let turns = asm.label();
            asm.branch_if(turned_deg, Comparison::GreaterOrEqual, self.min_deg, turns);
            asm.index(self.power, powers, tuple);
            asm.abs(self.power, self.power);
            asm.branch_if(self.power, Comparison::GreaterOrEqual, self.min_power, still);
            asm.bind(turns);
        }
        asm.set(self.still_steps, 0);
        asm.jump(counted);
        asm.bind(still);
        asm.add(self.still_steps, self.still_steps, one);
        asm.bind(counted);
    }

    /// Jumps to `stalled` after too many consecutive steps without rotation.
    pub(super) fn check(&self, asm: &mut Assembler, stalled: Label) {
        asm.branch_if(self.still_steps, Comparison::GreaterOrEqual, self.max_steps, stalled);
    }
}
