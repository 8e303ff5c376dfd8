//! System calls for files.

use super::Arguments;
use crate::brick::flash::status;
use crate::brick::memory::Place;
use crate::brick::{Brick, Fault};
use crate::bytecode::Syscall;

impl Brick<'_, '_> {
    pub(super) fn file_call(&mut self, call: Syscall, argument: Arguments) -> Result<(), Fault> {
        let result = argument[0];
        let status = match call {
            Syscall::FileOpenRead | Syscall::FileOpenAppend => {
                let name = self.name(argument[2])?;
                let opened = match call {
                    Syscall::FileOpenRead => self.flash.open_read(&name),
                    _ => self.flash.append(&name),
                };
                if let Ok((_, length)) = opened {
                    self.memory.set_id(argument[3], length)?;
                }
                self.open(argument[1], opened.map(|(handle, _)| handle))?
            }
            Syscall::FileOpenWrite => {
                let (name, bytes) = (self.name(argument[2])?, self.memory.get_id(argument[3])?);
                let opened = self.flash.create(&name, bytes);
                self.open(argument[1], opened)?
            }
            Syscall::FileRead => {
                let (handle, limit) = (self.memory.get_id(argument[1])? as u8, self.memory.get_id(argument[3])?);
                // The firmware allocates the requested size before it reads.
                let room = vec![0; usize::from(limit as u16) + 1];
                self.memory.set_array(Place::new(argument[2]), &room)?;
                let (status, mut bytes) = self.flash.read(handle, u32::from(limit as u16));
                self.memory.set_id(argument[3], bytes.len() as u32)?;
                bytes.resize(room.len(), 0);
                self.memory.set_array(Place::new(argument[2]), &bytes)?;
                status
            }
            Syscall::FileWrite => {
                let (handle, length) = (self.memory.get_id(argument[1])? as u8, self.memory.get_id(argument[3])?);
                let buffer = self.memory.array(Place::new(argument[2]))?;
                // The firmware would write the memory after the buffer.
                let bytes = buffer.get(..length as usize).ok_or(Fault::Pointer)?;
                let (status, written) = self.flash.write(handle, bytes);
                self.memory.set_id(argument[3], written)?;
                status
            }
            Syscall::FileClose => self.flash.close(self.memory.get_id(argument[1])? as u8),
            Syscall::FileResolveHandle => {
                let (status, handle, writes) = match self.flash.resolve(&self.name(argument[3])?) {
                    Some((handle, writes)) => (status::OK, handle, writes),
                    None => (status::CLOSED_HANDLE, u8::MAX, false),
                };
                self.memory.set_id(argument[1], handle.into())?;
                self.memory.set_id(argument[2], writes.into())?;
                status
            }
            Syscall::FileRename => self.flash.rename(&self.name(argument[1])?, &self.name(argument[2])?),
            Syscall::FileDelete => self.flash.delete(&self.name(argument[1])?),
            Syscall::ListFiles => {
                let pattern = self.name(argument[1])?;
                let names: Vec<Vec<u8>> =
                    self.flash.list(&pattern).iter().map(|name| [name.as_bytes(), &[0]].concat()).collect();
                let list = Place::new(argument[2]);
                self.memory.resize(list, names.len())?;
                for (at, name) in names.iter().enumerate() {
                    let element = self.memory.element(list, at)?;
                    self.memory.set_array(element, name)?;
                }
                status::OK
            }
            _ => return Err(Fault::Instruction),
        };
        self.memory.set_id(result, status.into())
    }

    /// Stores the handle and returns the status.
    fn open(&mut self, handle: u16, opened: Result<u8, u16>) -> Result<u16, Fault> {
        let (status, number) = match opened {
            Ok(handle) => (status::OK, handle),
            Err(status) => (status, 0),
        };
        self.memory.set_id(handle, number.into())?;
        Ok(status)
    }
}
