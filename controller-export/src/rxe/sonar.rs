//! The ultrasonic sensor and the calls that read it.

use super::assembler::{Assembler, Label};
use super::clock::Clock;
use super::layout::{Array, Cluster, Number};
use crate::bytecode::{
    Comparison, InputField, SENSOR_LOW_SPEED_9V, SONAR_ADDRESS, SONAR_FIRST_ECHO, SONAR_TYPE, Syscall, Type,
};
use crate::onboard;
use crate::wiring::Wiring;

pub(super) struct Sonar {
    /// The last answer.
    pub(super) reading_cm: Number,
    port: Number,
    due_ms: Number,
    requested_ms: Number,
    passed_ms: Number,
    warm_up_ms: Number,
    hang_ms: Number,
    poll_ms: Number,
    timeout_ms: Number,
    probes: Number,
    one: Number,
    /// Requests for the sensor's type and for its nearest echo: the sensor's address and a register.
    type_request: Array,
    echo_request: Array,
    write: Write,
    status: Status,
    read: Read,
    /// Scratch byte: the value of a field, or the index of the newest answer.
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
    max_bytes: Number,
}

impl Sonar {
    pub(super) fn declare(asm: &mut Assembler, wiring: &Wiring, one: Number) -> Self {
        let request = |register: u8| [SONAR_ADDRESS.into(), register.into()];
        Sonar {
            due_ms: asm.number(Type::U32, 0),
            requested_ms: asm.number(Type::U32, 0),
            passed_ms: asm.number(Type::U32, 0),
            warm_up_ms: asm.number(Type::U16, onboard::SONAR_WARM_UP_MS.into()),
            hang_ms: asm.number(Type::U16, onboard::SONAR_HANG_MS as i32),
            type_request: asm.array(Type::U8, request(SONAR_TYPE)),
            echo_request: asm.array(Type::U8, request(SONAR_FIRST_ECHO)),
            reading_cm: asm.number(Type::U8, 0),
            port: asm.number(Type::U8, wiring.sonar as i32),
            poll_ms: asm.number(Type::U8, onboard::SONAR_POLL_MS.into()),
            timeout_ms: asm.number(Type::U8, onboard::SONAR_TIMEOUT_MS.into()),
            probes: asm.number(Type::U8, onboard::SONAR_PROBES.into()),
            value: asm.number(Type::U8, 0),
            one,
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
                max_bytes: asm.number(Type::U8, 0),
            },
        }
    }

    /// Switches the sensor on and asks for its type, before anything moves. Jumps to `absent` if it never answers.
    pub(super) fn find(&self, asm: &mut Assembler, clock: &Clock, absent: Label, stopped: Label) {
        let [failed, found] = std::array::from_fn(|_| asm.label());
        self.switch_on(asm);
        asm.tick(self.due_ms);
        asm.add(self.due_ms, self.due_ms, self.warm_up_ms);
        clock.wait_until(asm, self.due_ms, stopped);

        asm.mov_array(self.write.request, self.type_request);
        let probe = asm.here();
        self.ask(asm, clock, failed, stopped);
        asm.jump(found);
        asm.bind(failed);
        asm.tick(self.due_ms);
        asm.add(self.due_ms, self.due_ms, self.hang_ms);
        clock.wait_until(asm, self.due_ms, stopped);
        asm.sub(self.probes, self.probes, self.one);
        asm.branch_if_zero(self.probes, Comparison::NotEqual, probe);
        asm.jump(absent);
        asm.bind(found);
        asm.mov_array(self.write.request, self.echo_request);
    }

    /// Makes one exchange and stores the newest byte as the reading. Jumps to `failed` without an answer in time.
    pub(super) fn ask(&self, asm: &mut Assembler, clock: &Clock, failed: Label, stopped: Label) {
        let Sonar { write, status, read, .. } = self;
        let answered = asm.label();
        asm.call(Syscall::CommLsWrite, write.call);
        asm.branch_if_zero(write.result, Comparison::NotEqual, failed);
        asm.tick(self.requested_ms);
        let poll = asm.here();
        asm.wait(self.poll_ms);
        asm.call(Syscall::CommLsCheckStatus, status.call);
        asm.branch_if_zero(status.result, Comparison::Equal, answered);
        asm.branch_if_zero(status.result, Comparison::Less, failed);
        clock.check_button(asm, stopped);
        asm.tick(self.passed_ms);
        asm.sub(self.passed_ms, self.passed_ms, self.requested_ms);
        asm.branch_if(self.passed_ms, Comparison::Less, self.timeout_ms, poll);
        asm.jump(failed);
        asm.bind(answered);
        asm.branch_if_zero(status.ready, Comparison::Equal, failed);
        asm.mov(read.max_bytes, status.ready);
        asm.call(Syscall::CommLsRead, read.call);
        asm.branch_if_zero(read.result, Comparison::NotEqual, failed);
        asm.sub(self.value, status.ready, self.one);
        asm.index(self.reading_cm, read.answer, self.value);
    }

    fn switch_on(&self, asm: &mut Assembler) {
        // Constants of the calls are set by code, as nbc does: its decompiler loses the defaults of a cluster.
        for port in [self.write.port, self.status.port, self.read.port] {
            asm.mov(port, self.port);
        }
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
    }
}
