//! System calls of the firmware: files, sound, display, buttons, the digital bus, the clock.

use super::flash::status;
use super::memory::Place;
use super::{Brick, EventKind, Fault};
use crate::bytecode::{NONE, Syscall, Type, comm};

const MOST_ARGUMENTS: usize = 16;
const BUTTONS: usize = 4;
const EXIT_BUTTON: u32 = 0;
const BAD_PORT: i8 = -16;
const BAD_FIELD: i8 = -17;
/// The user interface module, and the offset of the battery voltage (mV) in its I/O map.
const UI_MODULE: &[u8] = b"Ui.mod";
const UI_BATTERY_MV: usize = 4;

impl Brick<'_, '_> {
    pub(super) fn syscall(&mut self, number: u16, arguments: u16) -> Result<(), Fault> {
        let call = Syscall::from_number(number).ok_or(Fault::Instruction)?;
        let argument = self.arguments(arguments)?;
        let result = argument[0];
        let t_ms = self.t_ms;
        match call {
            Syscall::FileOpenRead | Syscall::FileOpenAppend => {
                let name = self.name(argument[2])?;
                let opened = match call {
                    Syscall::FileOpenRead => self.flash.open_read(&name),
                    _ => self.flash.append(&name),
                };
                if let Ok((_, length)) = opened {
                    self.memory.set_id(argument[3], length)?;
                }
                self.answer_open(result, argument[1], opened.map(|(handle, _)| handle))
            }
            Syscall::FileOpenWrite => {
                let (name, bytes) = (self.name(argument[2])?, self.memory.get_id(argument[3])?);
                let opened = self.flash.create(&name, bytes);
                self.answer_open(result, argument[1], opened)
            }
            Syscall::FileRead => {
                let (handle, most) = (self.memory.get_id(argument[1])? as u8, self.memory.get_id(argument[3])?);
                // The firmware allocates the requested size before it reads.
                let room = vec![0; usize::from(most as u16) + 1];
                self.memory.set_array(Place::of(argument[2]), &room)?;
                let (status, mut bytes) = self.flash.read(handle, u32::from(most as u16));
                self.memory.set_id(argument[3], bytes.len() as u32)?;
                bytes.resize(room.len(), 0);
                self.memory.set_array(Place::of(argument[2]), &bytes)?;
                self.memory.set_id(result, status.into())
            }
            Syscall::FileWrite => {
                let (handle, length) = (self.memory.get_id(argument[1])? as u8, self.memory.get_id(argument[3])?);
                let buffer = self.memory.array(Place::of(argument[2]))?;
                // The firmware would write whatever lies behind the buffer.
                let bytes = buffer.get(..length as usize).ok_or(Fault::Pointer)?;
                let (status, written) = self.flash.write(handle, bytes);
                self.memory.set_id(argument[3], written)?;
                self.memory.set_id(result, status.into())
            }
            Syscall::FileClose => {
                let status = self.flash.close(self.memory.get_id(argument[1])? as u8);
                self.memory.set_id(result, status.into())
            }
            Syscall::FileResolveHandle => {
                let (status, handle, writes) = match self.flash.resolve(&self.name(argument[3])?) {
                    Some((handle, writes)) => (status::OK, handle, writes),
                    None => (status::CLOSED_HANDLE, u8::MAX, false),
                };
                self.memory.set_id(argument[1], handle.into())?;
                self.memory.set_id(argument[2], writes.into())?;
                self.memory.set_id(result, status.into())
            }
            Syscall::FileRename => {
                let status = self.flash.rename(&self.name(argument[1])?, &self.name(argument[2])?);
                self.memory.set_id(result, status.into())
            }
            Syscall::FileDelete => {
                let status = self.flash.delete(&self.name(argument[1])?);
                self.memory.set_id(result, status.into())
            }
            Syscall::SoundPlayFile => {
                let name = self.name(argument[1])?;
                self.emit(EventKind::Sound(name));
                self.memory.set_id(result, 0)
            }
            Syscall::SoundPlayTone => {
                let (hz, ms) = (self.memory.get_id(argument[1])? as u16, self.memory.get_id(argument[2])? as u16);
                self.emit(EventKind::Tone { hz, ms });
                self.memory.set_id(result, 0)
            }
            // Sounds have always ended when the program asks.
            Syscall::SoundGetState => {
                self.memory.set_id(argument[0], 0)?;
                self.memory.set_id(argument[1], 0)
            }
            Syscall::SoundSetState => {
                let state = self.memory.get_id(argument[1])?;
                self.memory.set_id(result, state)
            }
            Syscall::DrawText => {
                let [x, y, ..] = self.arguments(argument[1])?;
                let (x, y) = (self.memory.get_id(x)? as i16, self.memory.get_id(y)? as i16);
                let text = self.name(argument[2])?;
                self.emit(EventKind::Text { x, y, text });
                self.memory.set_id(result, 0)
            }
            Syscall::DrawPoint
            | Syscall::DrawLine
            | Syscall::DrawCircle
            | Syscall::DrawRect
            | Syscall::DrawPicture
            | Syscall::SetScreenMode
            | Syscall::KeepAlive => self.memory.set_id(result, 0),
            Syscall::ReadButton => self.read_button(argument),
            Syscall::CommLsWrite => {
                let (port, answer_bytes) =
                    (self.memory.get_id(argument[1])? as usize, self.memory.get_id(argument[3])?);
                let request = self.memory.array(Place::of(argument[2]))?;
                let status = match self.ports.get_mut(port) {
                    Some(on_port) => on_port.write(request, answer_bytes as u8, port, t_ms, self.world),
                    None => comm::INVALID_PORT,
                };
                self.memory.set_id(result, status as u32)
            }
            Syscall::CommLsRead => {
                let (port, most) = (self.memory.get_id(argument[1])? as usize, self.memory.get_id(argument[3])? as u8);
                let (status, bytes) = match self.ports.get_mut(port) {
                    Some(on_port) => on_port.read(most, t_ms),
                    None => (comm::INVALID_PORT, Vec::new()),
                };
                self.memory.set_array(Place::of(argument[2]), &bytes)?;
                self.memory.set_id(result, status as u32)
            }
            Syscall::CommLsCheckStatus => {
                let port = self.memory.get_id(argument[1])? as usize;
                let (status, ready) = match self.ports.get_mut(port) {
                    Some(on_port) => on_port.status(t_ms),
                    None => (comm::INVALID_PORT, 0),
                };
                self.memory.set_id(argument[2], ready.into())?;
                self.memory.set_id(result, status as u32)
            }
            Syscall::RandomNumber => {
                // The generator of the example in the C standard.
                self.chance = self.chance.wrapping_mul(1_103_515_245).wrapping_add(12_345);
                self.memory.set_id(result, self.chance >> 16)
            }
            Syscall::GetStartTick => self.memory.set_id(result, self.start_tick_ms),
            Syscall::IoMapRead => self.read_module_map(argument),
        }
    }

    /// The members of a call's argument cluster; missing ones are [`NONE`].
    fn arguments(&self, cluster: u16) -> Result<[u16; MOST_ARGUMENTS], Fault> {
        let entry = self.memory.entry(cluster)?;
        if entry.kind != Type::Cluster || usize::from(entry.members) > MOST_ARGUMENTS {
            return Err(Fault::Instruction);
        }
        let mut arguments = [NONE; MOST_ARGUMENTS];
        let mut id = cluster + 1;
        for argument in arguments.iter_mut().take(usize::from(entry.members)) {
            *argument = id;
            id = self.memory.entry(id)?.next;
        }
        Ok(arguments)
    }

    fn answer_open(&mut self, result: u16, to: u16, opened: Result<u8, u16>) -> Result<(), Fault> {
        let (status, handle) = match opened {
            Ok(handle) => (status::OK, handle),
            Err(status) => (status, 0),
        };
        self.memory.set_id(to, handle.into())?;
        self.memory.set_id(result, status.into())
    }

    fn read_button(&mut self, argument: [u16; MOST_ARGUMENTS]) -> Result<(), Fault> {
        let index = self.memory.get_id(argument[1])?;
        let (mut status, mut pressed, mut count) = (0, false, 0);
        if index as usize >= BUTTONS {
            status = BAD_PORT;
        } else if index != EXIT_BUTTON {
            let button = self.world.button(index as u8, self.t_ms);
            let forgotten = &mut self.forgotten_releases[index as usize];
            (pressed, count) = (button.pressed, button.released.wrapping_sub(*forgotten));
            if self.memory.get_id(argument[4])? != 0 {
                *forgotten = button.released;
            }
        }
        self.memory.set_id(argument[2], pressed.into())?;
        self.memory.set_id(argument[3], count.into())?;
        self.memory.set_id(argument[0], status as u32)
    }

    /// Reads the I/O map of a module; only the battery voltage is available.
    fn read_module_map(&mut self, argument: [u16; MOST_ARGUMENTS]) -> Result<(), Fault> {
        let (offset, count) = (self.memory.get_id(argument[2])? as usize, self.memory.get_id(argument[3])? as usize);
        let voltage = self.world.battery_mv(self.t_ms).to_le_bytes();
        let is_ui = self.string(argument[1])? == UI_MODULE;
        let wanted = offset.checked_sub(UI_BATTERY_MV).and_then(|at| voltage.get(at..at.checked_add(count)?));
        match wanted {
            Some(bytes) if is_ui => {
                self.memory.set_array(Place::of(argument[4]), bytes)?;
                self.memory.set_id(argument[0], 0)
            }
            _ => self.memory.set_id(argument[0], BAD_FIELD as u32),
        }
    }

    /// A string up to its first NUL.
    fn name(&self, id: u16) -> Result<String, Fault> {
        let bytes = self.memory.array(Place::of(id))?;
        let text = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
        Ok(String::from_utf8_lossy(text).into_owned())
    }
}
