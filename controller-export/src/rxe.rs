//! The controller as an .rxe program, without a compiler: one clump of bytecode for standard firmware 1.28 and later.
//!
//! `rxe/layout.rs` lays out the dataspace, `rxe/assembler.rs` encodes instructions, and this module generates them.
//!
//! The program behaves like the [NXC program](crate::nxc) without log and display, in a third of its size.

mod assembler;
mod layout;

use mindgap_core::controller::{Controller, FULL_SPEED, TUPLES, When};

use assembler::{Assembler, Label};
use layout::{Array, Cluster, Number};

use crate::budget::{Budget, Cost};
use crate::bytecode::{
    Comparison, InputField, OutputField, RUN_STATE_RUNNING, SENSOR_LOW_SPEED_9V, SONAR_ADDRESS, SONAR_FIRST_ECHO,
    Syscall, Type, mode, update,
};
use crate::error::ExportError;
use crate::onboard;
use crate::wiring::Wiring;

/// Measured cost of the program, the same for every controller.
const COST: Cost = Cost { program_bytes: 950, memory_bytes: 360, step_instructions: 90 };

/// The controller as the bytes of an .rxe file.
///
/// # Errors
/// When the brick cannot run the program: see [`ExportError`].
pub fn program(controller: &Controller, wiring: &Wiring) -> Result<Vec<u8>, ExportError> {
    controller.check()?;
    wiring.check()?;
    budget(controller).check()?;
    let mut asm = Assembler::default();
    // Large values first, which minimises padding.
    let next_ms = asm.number(Type::U32, 0);
    let now_ms = asm.number(Type::U32, 0);
    let step_ms = asm.number(Type::U16, controller.step_ms.into());
    let max_steps = asm.number(Type::U16, controller.max_steps.into());
    let steps = asm.number(Type::U16, 0);
    let brake_ms = asm.number(Type::U16, onboard::BRAKE_MS.into());
    let tuple = asm.number(Type::U8, 0);
    let tuples = asm.number(Type::U8, TUPLES as i32);
    let one = asm.number(Type::U8, 1);
    let failed_steps = asm.number(Type::U8, 0);
    let most_failed_steps = asm.number(Type::U8, onboard::FAILED_STEPS_TO_STOP.into());
    let no_echo = asm.number(Type::U8, onboard::NO_ECHO_CM.into());
    let threshold_cm = asm.number(Type::U8, 0);
    let when_larger = asm.number(Type::U8, 0);
    let motors = Motors::declare(&mut asm, controller, wiring);
    let thresholds_cm = asm.array(Type::U8, controller.tuples.iter().map(|tuple| tuple.threshold_cm.into()));
    let when_larger_of = asm.array(Type::U8, controller.tuples.iter().map(|t| i32::from(t.when == When::Larger)));
    let sonar = Sonar::declare(&mut asm, wiring);
    let tone = Tone::declare(&mut asm);
    let [failed, decide, larger, next_tuple, no_next, stop] = std::array::from_fn(|_| asm.label());

    sonar.switch_on(&mut asm);
    asm.tick(next_ms);

    let set_motors = asm.here();
    motors.set(&mut asm, tuple);

    let step = asm.here();
    let late = asm.label();
    asm.add(next_ms, next_ms, step_ms);
    asm.tick(now_ms);
    asm.branch_if(now_ms, Comparison::GreaterOrEqual, next_ms, late);
    asm.sub(now_ms, next_ms, now_ms);
    asm.wait(now_ms);
    asm.bind(late);
    sonar.read(&mut asm, now_ms, one, failed);
    asm.set(failed_steps, 0);
    asm.jump(decide);
    asm.bind(failed);
    asm.mov(sonar.reading_cm, no_echo);
    asm.add(failed_steps, failed_steps, one);

    asm.bind(decide);
    asm.add(steps, steps, one);
    asm.branch_if(failed_steps, Comparison::Equal, most_failed_steps, stop);
    asm.branch_if(sonar.reading_cm, Comparison::Equal, no_echo, no_next);
    asm.index(threshold_cm, thresholds_cm, tuple);
    asm.index(when_larger, when_larger_of, tuple);
    asm.branch_if_zero(when_larger, Comparison::NotEqual, larger);
    asm.branch_if(sonar.reading_cm, Comparison::Less, threshold_cm, next_tuple);
    asm.jump(no_next);
    asm.bind(larger);
    asm.branch_if(sonar.reading_cm, Comparison::LessOrEqual, threshold_cm, no_next);

    asm.bind(next_tuple);
    asm.add(tuple, tuple, one);
    asm.branch_if(tuple, Comparison::Equal, tuples, stop);
    asm.branch_if(steps, Comparison::NotEqual, max_steps, set_motors);
    asm.bind(no_next);
    asm.branch_if(steps, Comparison::NotEqual, max_steps, step);

    asm.bind(stop);
    motors.stop(&mut asm);
    tone.play(&mut asm, tuple, tuples);
    asm.wait(brake_ms);
    asm.stop();
    Ok(asm.into_file())
}

/// Resources of the program.
pub fn budget(controller: &Controller) -> Budget {
    Budget::new(COST, controller.step_ms, None)
}

/// The motors and the tuples' commands.
struct Motors {
    sides: [(Number, Array); 2],
    power: Number,
    on: Number,
    running: Number,
    flags: Number,
}

impl Motors {
    fn declare(asm: &mut Assembler, controller: &Controller, wiring: &Wiring) -> Self {
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

    fn set(&self, asm: &mut Assembler, tuple: Number) {
        for (port, powers) in self.sides {
            asm.index(self.power, powers, tuple);
            self.run(asm, port);
        }
    }

    /// Power 0 with the brake on.
    fn stop(&self, asm: &mut Assembler) {
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

/// The ultrasonic sensor and the calls that read it.
struct Sonar {
    reading_cm: Number,
    port: Number,
    warm_up_ms: Number,
    poll_ms: Number,
    timeout_ms: Number,
    deadline_ms: Number,
    /// The sensor's address and the register to read.
    request: Array,
    write: Write,
    status: Status,
    read: Read,
    /// Scratch byte: the value of a field, the index of the newest answer.
    value: Number,
}

/// Arguments of the call that starts an exchange.
struct Write {
    call: Cluster,
    result: Number,
    port: Number,
    request: Array,
    answer_bytes: Number,
}

/// Arguments of the call that queries the status of the exchange.
struct Status {
    call: Cluster,
    result: Number,
    port: Number,
    ready: Number,
}

/// Arguments of the call that reads the answer.
struct Read {
    call: Cluster,
    result: Number,
    port: Number,
    answer: Array,
    most_bytes: Number,
}

impl Sonar {
    fn declare(asm: &mut Assembler, wiring: &Wiring) -> Self {
        Sonar {
            deadline_ms: asm.number(Type::U32, 0),
            warm_up_ms: asm.number(Type::U16, onboard::SONAR_WARM_UP_MS.into()),
            request: asm.array(Type::U8, [SONAR_ADDRESS.into(), SONAR_FIRST_ECHO.into()]),
            reading_cm: asm.number(Type::U8, 0),
            port: asm.number(Type::U8, wiring.sonar as i32),
            poll_ms: asm.number(Type::U8, onboard::SONAR_POLL_MS.into()),
            timeout_ms: asm.number(Type::U8, onboard::SONAR_TIMEOUT_MS.into()),
            value: asm.number(Type::U8, 0),
            write: Write {
                call: asm.cluster(4),
                result: asm.number(Type::I8, 0),
                port: asm.number(Type::U8, 0),
                request: asm.array(Type::U8, []),
                answer_bytes: asm.number(Type::U8, 0),
            },
            status: Status {
                call: asm.cluster(3),
                result: asm.number(Type::I8, 0),
                port: asm.number(Type::U8, 0),
                ready: asm.number(Type::U8, 0),
            },
            read: Read {
                call: asm.cluster(4),
                result: asm.number(Type::I8, 0),
                port: asm.number(Type::U8, 0),
                answer: asm.array(Type::U8, []),
                most_bytes: asm.number(Type::U8, 0),
            },
        }
    }

    fn switch_on(&self, asm: &mut Assembler) {
        // Constants of the calls are set by code, as nbc does, whose decompiler loses the defaults of a cluster.
        for port in [self.write.port, self.status.port, self.read.port] {
            asm.mov(port, self.port);
        }
        asm.mov_array(self.write.request, self.request);
        asm.set(self.write.answer_bytes, 1);

        asm.set(self.value, SENSOR_LOW_SPEED_9V.into());
        asm.set_input(self.port, InputField::Type, self.value);
        asm.set(self.value, 0);
        asm.set_input(self.port, InputField::Mode, self.value);
        asm.set(self.value, 1);
        asm.set_input(self.port, InputField::InvalidData, self.value);
        let settling = asm.here();
        asm.get_input(self.value, self.port, InputField::InvalidData);
        asm.branch_if_zero(self.value, Comparison::NotEqual, settling);
        asm.wait(self.warm_up_ms);
    }

    /// One exchange: stores the newest byte as the reading; jumps to `failed` without an answer in time.
    fn read(&self, asm: &mut Assembler, now_ms: Number, one: Number, failed: Label) {
        let Sonar { write, status, read, .. } = self;
        let answered = asm.label();
        asm.call(Syscall::CommLsWrite, write.call);
        asm.branch_if_zero(write.result, Comparison::NotEqual, failed);
        asm.tick(self.deadline_ms);
        asm.add(self.deadline_ms, self.deadline_ms, self.timeout_ms);
        let poll = asm.here();
        asm.wait(self.poll_ms);
        asm.call(Syscall::CommLsCheckStatus, status.call);
        asm.branch_if_zero(status.result, Comparison::Equal, answered);
        asm.branch_if_zero(status.result, Comparison::Less, failed);
        asm.tick(now_ms);
        asm.branch_if(now_ms, Comparison::Less, self.deadline_ms, poll);
        asm.jump(failed);
        asm.bind(answered);
        asm.branch_if_zero(status.ready, Comparison::Equal, failed);
        asm.mov(read.most_bytes, status.ready);
        asm.call(Syscall::CommLsRead, read.call);
        asm.branch_if_zero(read.result, Comparison::NotEqual, failed);
        asm.sub(self.value, status.ready, one);
        asm.index(self.reading_cm, read.answer, self.value);
    }
}

/// The tone that signals how the run ended.
struct Tone {
    call: Cluster,
    frequency_hz: Number,
    duration_ms: Number,
    volume: Number,
}

impl Tone {
    fn declare(asm: &mut Assembler) -> Self {
        let call = asm.cluster(5);
        // The call's result, which is always the same.
        asm.number(Type::I8, 0);
        let (frequency_hz, duration_ms) = (asm.number(Type::U16, 0), asm.number(Type::U16, 0));
        // Whether it repeats.
        asm.number(Type::U8, 0);
        Tone { call, frequency_hz, duration_ms, volume: asm.number(Type::U8, 0) }
    }

    fn play(&self, asm: &mut Assembler, tuple: Number, tuples: Number) {
        let finished = asm.label();
        asm.set(self.duration_ms, onboard::BRAKE_MS);
        asm.set(self.volume, onboard::TONE_VOLUME.into());
        asm.set(self.frequency_hz, onboard::FINISHED_HZ);
        asm.branch_if(tuple, Comparison::Equal, tuples, finished);
        asm.set(self.frequency_hz, onboard::GAVE_UP_HZ);
        asm.bind(finished);
        asm.call(Syscall::SoundPlayTone, self.call);
    }
}
