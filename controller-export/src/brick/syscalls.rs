//! All 48 system calls of standard firmware 1.29.
//!
//! Those for sound, display, buttons and time are here, and the others in `src/brick/syscalls`.
//!
//! Source: `cCmdWrap…` in `c_cmd.c` of the firmware.

mod bus;
mod files;
mod others;

use super::memory::Place;
use super::{Brick, EventKind, Fault};
use crate::bytecode::{NONE, Syscall, Type};

const MAX_ARGUMENTS: usize = 16;
const BUTTONS: usize = 4;
const EXIT_BUTTON: u32 = 0;
const BAD_PORT: i8 = -16;
/// States of the sound module.
const SOUND_IDLE: u32 = 0;
const SOUND_TONE: u32 = 3;
/// Width of the display and of a character, which limit the text that is shown.
const DISPLAY_PIXELS: i16 = 100;
const CHARACTER_PIXELS: i16 = 6;
/// Longest name of a sound file.
const MAX_NAME: usize = 19;

/// The members of a call's argument cluster; missing ones are [`NONE`].
type Arguments = [u16; MAX_ARGUMENTS];

impl Brick<'_, '_> {
    pub(super) fn syscall(&mut self, number: u16, arguments: u16) -> Result<(), Fault> {
        let call = Syscall::from_number(number).ok_or(Fault::Instruction)?;
        let argument = self.arguments(arguments)?;
        let result = argument[0];
        match call {
            Syscall::FileOpenRead
            | Syscall::FileOpenWrite
            | Syscall::FileOpenAppend
            | Syscall::FileRead
            | Syscall::FileWrite
            | Syscall::FileClose
            | Syscall::FileResolveHandle
            | Syscall::FileRename
            | Syscall::FileDelete
            | Syscall::ListFiles => self.file_call(call, argument),
            Syscall::SoundPlayFile => {
                let name = self.name(argument[1])?.chars().take(MAX_NAME).collect();
                self.emit(EventKind::Sound(name));
                self.memory.set_id(result, 0)
            }
            Syscall::SoundPlayTone => {
                let (hz, ms) = (self.memory.get_id(argument[1])? as u16, self.memory.get_id(argument[2])? as u16);
                self.emit(EventKind::Tone { hz, ms });
                self.tone_until_ms = self.t_ms.saturating_add(ms.into());
                self.memory.set_id(result, 0)
            }
            Syscall::SoundGetState => {
                let state = self.sound_state();
                self.memory.set_id(argument[0], state)?;
                self.memory.set_id(argument[1], 0)
            }
            Syscall::SoundSetState => {
                // Any state ends the sound.
                self.tone_until_ms = self.t_ms;
                let state = self.memory.get_id(argument[1])?;
                self.memory.set_id(result, state)
            }
            Syscall::DrawText => {
                let [x, y, ..] = self.arguments(argument[1])?;
                let (x, y) = (self.memory.get_id(x)? as i16, self.memory.get_id(y)? as i16);
                let shown = DISPLAY_PIXELS.saturating_sub(x) / CHARACTER_PIXELS;
                let text = self.name(argument[2])?.chars().take(shown.clamp(0, 16) as usize).collect();
                self.emit(EventKind::Text { x, y, text });
                self.memory.set_id(result, 0)
            }
            Syscall::DrawPoint
            | Syscall::DrawLine
            | Syscall::DrawCircle
            | Syscall::DrawRect
            | Syscall::DrawPicture
            | Syscall::SetScreenMode => self.memory.set_id(result, 0),
            Syscall::ReadButton => self.read_button(argument),
            Syscall::CommLsWrite
            | Syscall::CommLsRead
            | Syscall::CommLsCheckStatus
            | Syscall::CommHsWrite
            | Syscall::CommHsRead
            | Syscall::CommHsCheckStatus
            | Syscall::ColorSensorRead => self.bus_call(call, argument),
            Syscall::RandomNumber => {
                // The generator in the example of the C standard.
                self.random_state = self.random_state.wrapping_mul(1_103_515_245).wrapping_add(12_345);
                self.memory.set_id(result, self.random_state >> 16)
            }
            Syscall::GetStartTick => self.memory.set_id(result, self.start_tick_ms),
            Syscall::MessageWrite
            | Syscall::MessageRead
            | Syscall::CommBtCheckStatus
            | Syscall::CommBtWrite
            | Syscall::CommBtRead
            | Syscall::CommBtOnOff
            | Syscall::CommBtConnection
            | Syscall::KeepAlive
            | Syscall::SetSleepTimeout
            | Syscall::IoMapRead
            | Syscall::IoMapWrite
            | Syscall::ReadSemData
            | Syscall::WriteSemData
            | Syscall::ComputeCalibValue
            | Syscall::UpdateCalibCacheInfo
            | Syscall::DatalogWrite
            | Syscall::DatalogGetTimes => self.other_call(call, argument),
        }
    }

    /// Returns the state of the sound module. Only tones take time.
    pub(super) fn sound_state(&self) -> u32 {
        if self.t_ms < self.tone_until_ms { SOUND_TONE } else { SOUND_IDLE }
    }

    fn arguments(&self, cluster: u16) -> Result<Arguments, Fault> {
        let entry = self.memory.entry(cluster)?;
        if entry.kind != Type::Cluster || usize::from(entry.members) > MAX_ARGUMENTS {
            return Err(Fault::Instruction);
        }
        let mut arguments = [NONE; MAX_ARGUMENTS];
        let mut id = cluster + 1;
        for argument in arguments.iter_mut().take(usize::from(entry.members)) {
            *argument = id;
            id = self.memory.entry(id)?.next;
        }
        Ok(arguments)
    }

    fn read_button(&mut self, argument: Arguments) -> Result<(), Fault> {
        let index = self.memory.get_id(argument[1])?;
        let (mut status, mut pressed, mut count) = (0, false, 0);
        if index as usize >= BUTTONS {
            status = BAD_PORT;
        } else if index != EXIT_BUTTON {
            let button = self.world.button(index as u8, self.t_ms);
            let reset = &mut self.reset_releases[index as usize];
            (pressed, count) = (button.pressed, button.released.wrapping_sub(*reset));
            if self.memory.get_id(argument[4])? != 0 {
                *reset = button.released;
            }
        }
        self.memory.set_id(argument[2], pressed.into())?;
        self.memory.set_id(argument[3], count.into())?;
        self.memory.set_id(argument[0], status as u32)
    }

    /// Returns a string up to its first NUL.
    fn name(&self, id: u16) -> Result<String, Fault> {
        let bytes = self.memory.array(Place::new(id))?;
        let text = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
        Ok(String::from_utf8_lossy(text).into_owned())
    }
}
