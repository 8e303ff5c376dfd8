//! The I/O maps of the firmware's modules, which programs read and write by offset. They contain the state of the emulator;
//! bytes that a program writes elsewhere are kept.
//!
//! Source: the `.iom` files of the firmware; names and offsets as in nbc's `NXTDefs.h`.

use std::ops::Range;

use super::{Brick, bus, motors};
use crate::bytecode::{InputField, OutputField};

/// Largest number of bytes per read or write.
pub(super) const MAX_BYTES: usize = 64;

const MAPS: usize = 10;
/// Offset and size of the fields in the 20 bytes of an input.
const INPUT: [(InputField, usize, usize); 6] = [
    (InputField::AdRaw, 2, 2),
    (InputField::NormRaw, 4, 2),
    (InputField::Scaled, 6, 2),
    (InputField::Type, 8, 1),
    (InputField::Mode, 9, 1),
    (InputField::InvalidData, 16, 1),
];
const INPUT_BYTES: usize = 20;
/// Offset and size of the fields in the 32 bytes of an output.
const OUTPUT: [(OutputField, usize, usize); 17] = [
    (OutputField::TachoCount, 0, 4),
    (OutputField::BlockTachoCount, 4, 4),
    (OutputField::RotationCount, 8, 4),
    (OutputField::TachoLimit, 12, 4),
    (OutputField::Mode, 19, 1),
    (OutputField::Power, 20, 1),
    (OutputField::ActualSpeed, 21, 1),
    (OutputField::PValue, 22, 1),
    (OutputField::IValue, 23, 1),
    (OutputField::DValue, 24, 1),
    (OutputField::RunState, 25, 1),
    (OutputField::RegulationMode, 26, 1),
    (OutputField::Overload, 27, 1),
    (OutputField::TurnRatio, 28, 1),
    (OutputField::Options, 29, 1),
    (OutputField::MaxSpeed, 30, 1),
    (OutputField::Flags, 18, 1),
];
const OUTPUT_BYTES: usize = 32;

const BUTTON_COUNTS_BYTES: usize = 8;
const BUTTON_RELEASES: usize = 4;
const BUTTON_STATES: usize = 32;
const BUTTON_PRESSED: u8 = 0x80;
const COMMAND_TICK: usize = 20;
const LOADER_FREE_FLASH: usize = 4;
const UI_BATTERY_MV: usize = 4;
const UI_SLEEP_TIMEOUT: usize = 33;
const SOUND_STATE: usize = 27;

/// A module with an I/O map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Module {
    Command,
    Loader,
    Sound,
    Button,
    Ui,
    Input,
    Output,
    LowSpeed,
    Display,
    Comm,
}

/// The contents of the maps. Each has its full size once it is used.
#[derive(Debug, Default)]
pub(super) struct IoMaps([Vec<u8>; MAPS]);

impl Module {
    pub(super) fn named(name: &[u8]) -> Option<Module> {
        Some(match name {
            b"Command.mod" => Module::Command,
            b"Loader.mod" => Module::Loader,
            b"Sound.mod" => Module::Sound,
            b"Button.mod" => Module::Button,
            b"Ui.mod" => Module::Ui,
            b"Input.mod" => Module::Input,
            b"Output.mod" => Module::Output,
            b"Low Speed.mod" => Module::LowSpeed,
            b"Display.mod" => Module::Display,
            b"Comm.mod" => Module::Comm,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Module::Command => 32_828,
            Module::Loader => 8,
            Module::Sound => 30,
            Module::Button => 36,
            Module::Ui => 41,
            Module::Input => 416,
            Module::Output => 98,
            Module::LowSpeed => 167,
            Module::Display => 1_720,
            Module::Comm => 1_896,
        }
    }
}

impl Brick<'_, '_> {
    /// Returns a part of a module's map, or `None` beyond its end.
    pub(super) fn read_map(&mut self, module: Module, offset: usize, count: usize) -> Option<Vec<u8>> {
        let range = offset..offset.checked_add(count)?;
        if range.end > module.bytes() {
            return None;
        }
        self.refresh(module);
        if module == Module::Input {
            self.mark_inputs_read(range.clone());
        }
        self.io_maps.0[module as usize].get(range).map(<[u8]>::to_vec)
    }

    /// Marks the ports whose values lie in a part of the map of the inputs.
    fn mark_inputs_read(&mut self, range: Range<usize>) {
        for (number, port) in self.ports.iter_mut().enumerate() {
            for (field, offset, size) in INPUT {
                let at = number * INPUT_BYTES + offset;
                if range.start < at + size && at < range.end {
                    port.read_field(field, None, self.t_ms);
                }
            }
        }
    }

    /// Writes a part of a module's map. Returns `false` beyond its end.
    pub(super) fn write_map(&mut self, module: Module, offset: usize, bytes: &[u8]) -> bool {
        let range = offset..offset.saturating_add(bytes.len());
        if range.end > module.bytes() {
            return false;
        }
        self.refresh(module);
        self.io_maps.0[module as usize][range.clone()].copy_from_slice(bytes);
        let touched = |at: usize, size: usize| range.start < at + size && at < range.end;
        match module {
            Module::Input => {
                for (field, offset, size) in INPUT {
                    for port in 0..bus::PORTS {
                        let at = port * INPUT_BYTES + offset;
                        if touched(at, size) {
                            let value = self.number(module, at, size);
                            self.ports[port].set(field, value, self.t_ms);
                        }
                    }
                }
            }
            Module::Output => {
                for port in 0..motors::PORTS {
                    for (field, offset, size) in OUTPUT {
                        let at = port * OUTPUT_BYTES + offset;
                        if touched(at, size) {
                            let value = self.number(module, at, size);
                            self.motors[port].set(field, value);
                        }
                    }
                    self.apply_output(port);
                }
            }
            Module::Ui if touched(UI_SLEEP_TIMEOUT, 1) => {
                self.sleep_timeout_min = self.number(module, UI_SLEEP_TIMEOUT, 1);
            }
            _ => {}
        }
        true
    }

    /// Writes the state of the emulator into a module's map.
    fn refresh(&mut self, module: Module) {
        self.io_maps.0[module as usize].resize(module.bytes(), 0);
        let t_ms = self.t_ms;
        match module {
            Module::Command => self.put(module, COMMAND_TICK, 4, self.tick_ms()),
            Module::Loader => self.put(module, LOADER_FREE_FLASH, 4, self.flash.free_bytes()),
            Module::Sound => self.put(module, SOUND_STATE, 1, self.sound_state()),
            Module::Button => {
                for button in 0..4u8 {
                    let state = self.world.button(button, t_ms);
                    let releases = state.released.wrapping_sub(self.reset_releases[usize::from(button)]);
                    let pressed = if state.pressed { BUTTON_PRESSED } else { 0 };
                    let counts = usize::from(button) * BUTTON_COUNTS_BYTES;
                    self.put(module, counts + BUTTON_RELEASES, 1, releases.into());
                    self.put(module, BUTTON_STATES + usize::from(button), 1, pressed.into());
                }
            }
            Module::Ui => {
                let battery_mv = self.world.battery_mv(t_ms);
                self.put(module, UI_BATTERY_MV, 2, battery_mv.into());
                self.put(module, UI_SLEEP_TIMEOUT, 1, self.sleep_timeout_min);
            }
            Module::Input => {
                for port in 0..bus::PORTS {
                    let percent = self.world.percent(port, t_ms);
                    for (field, at, size) in INPUT {
                        self.put(module, port * INPUT_BYTES + at, size, self.ports[port].get(field, percent, t_ms));
                    }
                }
            }
            Module::Output => {
                for port in 0..motors::PORTS {
                    let rotation_deg = self.world.rotation_deg(port, t_ms);
                    for (field, at, size) in OUTPUT {
                        self.put(module, port * OUTPUT_BYTES + at, size, self.motors[port].get(field, rotation_deg));
                    }
                }
            }
            Module::LowSpeed | Module::Display | Module::Comm => {}
        }
    }

    fn put(&mut self, module: Module, at: usize, size: usize, value: u32) {
        self.io_maps.0[module as usize][at..at + size].copy_from_slice(&value.to_le_bytes()[..size]);
    }

    fn number(&self, module: Module, at: usize, size: usize) -> u32 {
        let mut value = [0; 4];
        value[..size].copy_from_slice(&self.io_maps.0[module as usize][at..at + size]);
        u32::from_le_bytes(value)
    }
}
