//! System calls for the digital bus of the sensor ports. The firmware treats those for the fast serial port alike.

use super::Arguments;
use crate::brick::memory::Place;
use crate::brick::{Brick, Fault};
use crate::bytecode::{Syscall, comm};

/// Number of values of a colour sensor: red, green, blue, dark.
const COLORS: usize = 4;

impl Brick<'_, '_> {
    pub(super) fn bus_call(&mut self, call: Syscall, argument: Arguments) -> Result<(), Fault> {
        let t_ms = self.t_ms;
        let port = self.memory.get_id(argument[1])? as usize;
        let status = match call {
            Syscall::CommLsWrite | Syscall::CommHsWrite => {
                let answer_bytes = self.memory.get_id(argument[3])? as u8;
                let request = self.memory.array(Place::new(argument[2]))?;
                match self.ports.get_mut(port) {
                    Some(on_port) => on_port.write(request, answer_bytes, port, t_ms, self.world),
                    None => comm::INVALID_PORT,
                }
            }
            Syscall::CommLsRead | Syscall::CommHsRead => {
                let limit = self.memory.get_id(argument[3])? as u8;
                let (status, bytes) = match self.ports.get_mut(port) {
                    Some(on_port) => on_port.read(limit, t_ms),
                    None => (comm::INVALID_PORT, Vec::new()),
                };
                self.memory.set_array(Place::new(argument[2]), &bytes)?;
                status
            }
            Syscall::CommLsCheckStatus | Syscall::CommHsCheckStatus => {
                let (status, ready) = match self.ports.get_mut(port) {
                    Some(on_port) => on_port.status(t_ms),
                    None => (comm::INVALID_PORT, 0),
                };
                self.memory.set_id(argument[2], ready.into())?;
                status
            }
            // There is no colour sensor: its values have their usual sizes and are invalid.
            Syscall::ColorSensorRead => {
                for values in &argument[3..6] {
                    self.memory.resize(Place::new(*values), COLORS)?;
                }
                self.memory.set_id(argument[6], 1)?;
                comm::NOT_READY
            }
            _ => return Err(Fault::Instruction),
        };
        self.memory.set_id(argument[0], status as u32)
    }
}
