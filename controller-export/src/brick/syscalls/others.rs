//! System calls for mailboxes, Bluetooth, I/O maps and the remaining functions of the firmware.

use super::Arguments;
use crate::brick::io_map::{MAX_BYTES, Module};
use crate::brick::memory::Place;
use crate::brick::{Brick, Fault};
use crate::bytecode::{Syscall, comm};

/// Number of connections to other bricks.
const CONNECTIONS: u32 = 4;
const MS_PER_MIN: u32 = 60_000;
/// The loader's codes for a module that does not exist, and for an offset outside its map.
const NO_MODULE: i8 = 0x90u8 as i8;
const BAD_FIELD: i8 = -17;
/// Sensors are calibrated by files, and there are none: values are shares of the full range.
const NOT_CALIBRATED: i8 = -64;
const FULL_RANGE: i32 = 1023;

impl Brick<'_, '_> {
    pub(super) fn other_call(&mut self, call: Syscall, argument: Arguments) -> Result<(), Fault> {
        let result = argument[0];
        let status = match call {
            Syscall::MessageWrite => {
                let mailbox = self.memory.get_id(argument[1])?;
                self.mailboxes.write(mailbox, self.memory.array(Place::new(argument[2]))?)
            }
            Syscall::MessageRead => {
                let (mailbox, removes) = (self.memory.get_id(argument[1])?, self.memory.get_id(argument[2])? != 0);
                let (status, message) = self.mailboxes.read(mailbox, removes);
                self.memory.set_array(Place::new(argument[3]), &message)?;
                status
            }
            // No other brick is connected, and none can be found.
            Syscall::CommBtCheckStatus | Syscall::CommBtWrite => {
                let connection = self.memory.get_id(argument[1])?;
                if connection < CONNECTIONS { comm::NOT_READY } else { comm::INVALID_CONNECTION }
            }
            Syscall::CommBtConnection => comm::NOT_READY,
            Syscall::CommBtOnOff | Syscall::DatalogWrite | Syscall::UpdateCalibCacheInfo => comm::OK,
            // The firmware does not implement this call.
            Syscall::CommBtRead => return Err(Fault::Instruction),
            Syscall::KeepAlive => return self.memory.set_id(result, self.sleep_timeout_min * MS_PER_MIN),
            Syscall::SetSleepTimeout => {
                let timeout_ms = self.memory.get_id(argument[1])?;
                self.sleep_timeout_min = if timeout_ms == 0 { 0 } else { (timeout_ms / MS_PER_MIN).max(1) & 0xFF };
                return Ok(());
            }
            // The firmware writes the time of the last synchronisation to the next argument by mistake.
            Syscall::DatalogGetTimes => return self.memory.set_id(argument[1], 0),
            Syscall::IoMapRead => self.read_module(argument)?,
            Syscall::IoMapWrite => self.write_module(argument)?,
            Syscall::ReadSemData | Syscall::WriteSemData => {
                let of_requests = self.memory.get_id(argument[1])? != 0;
                let data = &mut self.semaphores[usize::from(of_requests)];
                if call == Syscall::WriteSemData {
                    let bits = self.memory.get_id(argument[2])? as u8;
                    let clears = self.memory.get_id(argument[3])? != 0;
                    *data = if clears { *data & !bits } else { *data | bits };
                }
                return self.memory.set_id(result, (*data).into());
            }
            Syscall::ComputeCalibValue => {
                let raw = self.memory.get_id(argument[2])? as i16;
                let percent = (i32::from(raw) * 100 / FULL_RANGE).clamp(0, 100);
                self.memory.set_id(argument[2], percent as u32)?;
                NOT_CALIBRATED
            }
            _ => return Err(Fault::Instruction),
        };
        self.memory.set_id(result, status as u32)
    }

    fn read_module(&mut self, argument: Arguments) -> Result<i8, Fault> {
        let (offset, count) = (self.memory.get_id(argument[2])? as usize, self.memory.get_id(argument[3])? as usize);
        let to = Place::new(argument[4]);
        if count > MAX_BYTES {
            self.memory.set_array(to, &[])?;
            return Ok(comm::INVALID_SIZE);
        }
        let Some(module) = Module::named(self.string(argument[1])?) else { return Ok(NO_MODULE) };
        let Some(bytes) = self.read_map(module, offset, count) else { return Ok(BAD_FIELD) };
        self.memory.set_array(to, &bytes)?;
        Ok(comm::OK)
    }

    fn write_module(&mut self, argument: Arguments) -> Result<i8, Fault> {
        let offset = self.memory.get_id(argument[2])? as usize;
        let bytes = self.memory.array(Place::new(argument[3]))?.to_vec();
        if bytes.len() > MAX_BYTES {
            return Ok(comm::INVALID_SIZE);
        }
        let Some(module) = Module::named(self.string(argument[1])?) else { return Ok(NO_MODULE) };
        Ok(if self.write_map(module, offset, &bytes) { comm::OK } else { BAD_FIELD })
    }
}
