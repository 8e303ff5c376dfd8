//! The four sensor ports: their types, analogue sensors, and the digital bus (I²C) of the ultrasonic sensor.
//!
//! Source: `c_lowspeed.c`, `c_input.c` and `cCmdLS…` in `c_cmd.c` of the firmware.

use std::collections::VecDeque;

use super::world::{Sonar, World};
use crate::bytecode::{
    InputField, SENSOR_LOW_SPEED, SENSOR_LOW_SPEED_9V, SENSOR_SWITCH, SONAR_ADDRESS, SONAR_FIRST_ECHO, comm, input_mode,
};
use crate::onboard::{NO_ECHO_CM, SONAR_HANG_MS};

/// Number of sensor ports of a brick.
pub(super) const PORTS: usize = 4;

/// Time for which a port's values are invalid after its type has changed.
const SETTLE_MS: u32 = 20;
/// Duration of an exchange: two bytes out, the address again and one byte in, at 9600 bit/s.
const ANSWER_MS: u32 = 6;
/// Duration of four attempts without an acknowledgement.
const SILENCE_MS: u32 = 6;
/// Size of the input buffer and of the output buffer.
const BUFFER_BYTES: usize = 16;
/// The registers that hold text: version, maker and type.
const TEXTS: &[u8; 24] = b"V1.0\0\0\0\0LEGO\0\0\0\0Sonar\0\0\0";
/// Number of registers that hold echoes.
const ECHOES: usize = 8;
/// Raw value of an empty port, and of a pressed touch sensor.
const OPEN_RAW: u32 = 1023;
const PRESSED_RAW: u32 = 183;

/// A sensor port.
#[derive(Clone, Debug, Default)]
pub(super) struct Port {
    kind: u8,
    mode: u8,
    is_read: bool,
    invalid_until_ms: Option<u32>,
    state: State,
    received: VecDeque<u8>,
}

#[derive(Clone, Debug, Default)]
enum State {
    #[default]
    Idle,
    /// An exchange that ends at this time, with or without an answer.
    Busy(u32, Option<Vec<u8>>),
    Failed,
}

impl Port {
    pub(super) fn set(&mut self, field: InputField, value: u32, t_ms: u32) {
        match field {
            InputField::Type => {
                self.kind = value as u8;
                self.invalid_until_ms = Some(t_ms.saturating_add(SETTLE_MS));
            }
            InputField::Mode => self.mode = value as u8,
            InputField::InvalidData => self.invalid_until_ms = (value != 0).then_some(t_ms.saturating_add(SETTLE_MS)),
            // Overwritten by the firmware at its next millisecond.
            InputField::AdRaw | InputField::NormRaw | InputField::Scaled => {}
        }
    }

    /// Returns the value of a field to the program, given the reading of an analogue sensor on this port.
    pub(super) fn read_field(&mut self, field: InputField, percent: Option<u8>, t_ms: u32) -> u32 {
        self.is_read |= matches!(field, InputField::AdRaw | InputField::NormRaw | InputField::Scaled);
        self.get(field, percent, t_ms)
    }

    /// Returns whether the program has read a value here or has asked a digital sensor.
    pub(super) fn is_read(&self) -> bool {
        self.is_read
    }

    /// Returns the value of a field, given the reading of an analogue sensor on this port.
    pub(super) fn get(&self, field: InputField, percent: Option<u8>, t_ms: u32) -> u32 {
        match field {
            InputField::Type => u32::from(self.kind),
            InputField::Mode => u32::from(self.mode),
            InputField::InvalidData => u32::from(!self.is_valid(t_ms)),
            InputField::AdRaw | InputField::NormRaw => self.raw(percent),
            InputField::Scaled => match (self.mode & input_mode::MASK, self.kind, percent) {
                (input_mode::RAW, ..) => self.raw(percent),
                (input_mode::BOOLEAN, SENSOR_SWITCH, _) => u32::from(percent.is_some_and(|percent| percent > 0)),
                (input_mode::BOOLEAN, ..) => u32::from(percent.is_some_and(|percent| percent > 50)),
                // Other modes give a percentage. Modes that count edges are not emulated.
                (_, _, percent) => percent.unwrap_or(0).into(),
            },
        }
    }

    fn raw(&self, percent: Option<u8>) -> u32 {
        match (self.kind, percent) {
            (_, None) | (SENSOR_SWITCH, Some(0)) => OPEN_RAW,
            (SENSOR_SWITCH, Some(_)) => PRESSED_RAW,
            (_, Some(percent)) => u32::from(percent.min(100)) * OPEN_RAW / 100,
        }
    }

    /// Starts an exchange.
    pub(super) fn write(
        &mut self,
        request: &[u8],
        answer_bytes: u8,
        port: usize,
        t_ms: u32,
        world: &mut dyn World,
    ) -> i8 {
        self.is_read = true;
        self.settle(t_ms);
        let answer_bytes = usize::from(answer_bytes);
        if request.len() > BUFFER_BYTES || answer_bytes > BUFFER_BYTES {
            return comm::INVALID_SIZE;
        }
        let ready = match self.state {
            State::Idle => self.is_digital() && self.is_valid(t_ms),
            State::Failed => true,
            State::Busy(..) => false,
        };
        if !ready {
            return comm::NOT_READY;
        }
        self.state = exchange(request, answer_bytes, port, t_ms, world);
        comm::OK
    }

    /// Returns the status of the exchange and the number of bytes ready to be read.
    pub(super) fn status(&mut self, t_ms: u32) -> (i8, u8) {
        self.settle(t_ms);
        let status = match self.state {
            _ if !self.is_digital() || !self.is_valid(t_ms) => comm::NOT_READY,
            State::Idle => comm::OK,
            State::Busy(..) => comm::PENDING,
            State::Failed => comm::BUS_ERROR,
        };
        (status, self.received.len() as u8)
    }

    /// Removes and returns at most `limit` received bytes, with the status.
    pub(super) fn read(&mut self, limit: u8, t_ms: u32) -> (i8, Vec<u8>) {
        let (status, _) = self.status(t_ms);
        if status < 0 {
            return (status, Vec::new());
        }
        let count = usize::from(limit).min(self.received.len());
        (status, self.received.drain(..count).collect())
    }

    fn is_digital(&self) -> bool {
        matches!(self.kind, SENSOR_LOW_SPEED | SENSOR_LOW_SPEED_9V)
    }

    fn is_valid(&self, t_ms: u32) -> bool {
        self.invalid_until_ms.is_none_or(|until| t_ms >= until)
    }

    fn settle(&mut self, t_ms: u32) {
        match &mut self.state {
            State::Busy(until, answer) if t_ms >= *until => match answer.take() {
                Some(answer) => {
                    // The firmware's ring buffer also loses bytes that are not read in time.
                    self.received.extend(answer);
                    if self.received.len() >= BUFFER_BYTES {
                        self.received.clear();
                    }
                    self.state = State::Idle;
                }
                None => self.state = State::Failed,
            },
            _ => {}
        }
    }
}

fn exchange(request: &[u8], answer_bytes: usize, port: usize, t_ms: u32, world: &mut dyn World) -> State {
    let silence = State::Busy(t_ms.saturating_add(SILENCE_MS), None);
    let [SONAR_ADDRESS, register, ..] = request else { return silence };
    let registers = usize::from(*register)..usize::from(*register) + answer_bytes;
    let first_echo = usize::from(SONAR_FIRST_ECHO);
    let measures = registers.start < first_echo + ECHOES && registers.end > first_echo;
    let answer = if measures { world.sonar(port, t_ms) } else { world.sonar_answers(port, t_ms) };
    let echo_cm = match answer {
        Sonar::Echo(echo_cm) => echo_cm,
        Sonar::Silent => return silence,
        Sonar::Hangs => return State::Busy(t_ms.saturating_add(SONAR_HANG_MS), None),
    };
    let answer = registers.map(|register| match register.checked_sub(first_echo) {
        Some(0) => echo_cm,
        Some(1..ECHOES) => NO_ECHO_CM,
        _ => TEXTS.get(register).copied().unwrap_or(0),
    });
    State::Busy(t_ms.saturating_add(ANSWER_MS), Some(answer.collect()))
}
