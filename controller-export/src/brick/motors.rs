//! The outputs: the fields that a program writes and their effect on the motors.
//!
//! Regulation is not emulated: a motor runs at the power that is set, at once.
//!
//! Source: `c_output.c` of the firmware.

use crate::bytecode::{OutputField, RUN_STATE_IDLE, mode, update};

/// Motor ports of a brick.
pub(super) const PORTS: usize = 3;

/// Drive of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drive {
    /// It runs at this power, -100..=100; negative is backward.
    Power(i8),
    /// It holds.
    Brake,
    /// It turns freely.
    #[default]
    Coast,
}

/// An output: its fields and its motor.
#[derive(Clone, Debug, Default)]
pub(super) struct Motor {
    flags: u8,
    mode: u8,
    power: i8,
    tacho_limit: u32,
    run_state: u8,
    turn_ratio: i8,
    regulation_mode: u8,
    gains: [u8; 3],
    options: u8,
    max_speed: i8,
    max_acceleration: i8,
    /// Shaft rotation at which each of the three counters was set to zero.
    tacho_zero: i32,
    block_zero: i32,
    rotation_zero: i32,
    running_power: i8,
    brakes: bool,
    /// Shaft rotation at which the run ends.
    limit_deg: Option<i32>,
}

impl Motor {
    pub(super) fn set(&mut self, field: OutputField, value: u32) {
        match field {
            OutputField::Flags => self.flags = value as u8,
            OutputField::Mode => self.mode = value as u8,
            OutputField::Power => self.power = value as i8,
            OutputField::TachoLimit => self.tacho_limit = value,
            OutputField::RunState => self.run_state = value as u8,
            OutputField::TurnRatio => self.turn_ratio = value as i8,
            OutputField::RegulationMode => self.regulation_mode = value as u8,
            OutputField::PValue => self.gains[0] = value as u8,
            OutputField::IValue => self.gains[1] = value as u8,
            OutputField::DValue => self.gains[2] = value as u8,
            OutputField::Options => self.options = value as u8,
            OutputField::MaxSpeed => self.max_speed = value as i8,
            OutputField::MaxAcceleration => self.max_acceleration = value as i8,
            // Overwritten by the firmware at its next millisecond.
            OutputField::ActualSpeed
            | OutputField::TachoCount
            | OutputField::Overload
            | OutputField::BlockTachoCount
            | OutputField::RotationCount => {}
        }
    }

    pub(super) fn get(&self, field: OutputField, rotation_deg: i32) -> u32 {
        match field {
            OutputField::Flags => u32::from(self.flags),
            OutputField::Mode => u32::from(self.mode),
            OutputField::Power => self.power as u32,
            OutputField::ActualSpeed => self.running_power as u32,
            OutputField::TachoCount => rotation_deg.wrapping_sub(self.tacho_zero) as u32,
            OutputField::TachoLimit => self.tacho_limit,
            OutputField::RunState => u32::from(self.run_state),
            OutputField::TurnRatio => self.turn_ratio as u32,
            OutputField::RegulationMode => u32::from(self.regulation_mode),
            OutputField::Overload => 0,
            OutputField::PValue => u32::from(self.gains[0]),
            OutputField::IValue => u32::from(self.gains[1]),
            OutputField::DValue => u32::from(self.gains[2]),
            OutputField::BlockTachoCount => rotation_deg.wrapping_sub(self.block_zero) as u32,
            OutputField::RotationCount => rotation_deg.wrapping_sub(self.rotation_zero) as u32,
            OutputField::Options => u32::from(self.options),
            OutputField::MaxSpeed => self.max_speed as u32,
            OutputField::MaxAcceleration => self.max_acceleration as u32,
        }
    }

    /// Applies the fields that the flags name, as the firmware does in its next millisecond. Returns the new drive if the
    /// flags affect it.
    pub(super) fn apply(&mut self, rotation_deg: i32) -> Option<Drive> {
        let flags = std::mem::take(&mut self.flags);
        if flags & update::RESET_ROTATION_COUNT != 0 {
            self.rotation_zero = rotation_deg;
        }
        if flags & update::RESET_COUNT != 0 {
            self.tacho_zero = rotation_deg;
        }
        if flags & update::RESET_BLOCK_COUNT != 0 {
            self.block_zero = rotation_deg;
        }
        let is_on = self.mode & mode::MOTOR_ON != 0;
        if flags & update::SPEED != 0 && is_on {
            self.running_power = if self.run_state == RUN_STATE_IDLE { 0 } else { self.power };
        }
        if flags & update::MODE != 0 {
            // A motor that is switched off fades and turns freely, whatever the other bits say.
            self.brakes = is_on && self.mode & mode::BRAKE != 0;
            if !is_on {
                self.running_power = 0;
            }
        }
        if flags & update::TACHO_LIMIT != 0 {
            let way_deg = self.tacho_limit as i32;
            self.limit_deg = match self.running_power {
                _ if way_deg == 0 => None,
                power if power < 0 => Some(rotation_deg.wrapping_sub(way_deg)),
                _ => Some(rotation_deg.wrapping_add(way_deg)),
            };
        }
        (flags & (update::SPEED | update::MODE) != 0).then(|| self.drive())
    }

    /// Whether it runs until it has turned by a limit.
    pub(super) fn has_limit(&self) -> bool {
        self.limit_deg.is_some()
    }

    /// Ends a run that has reached its limit; returns the new drive.
    pub(super) fn end_at_limit(&mut self, rotation_deg: i32) -> Option<Drive> {
        let left_deg = self.limit_deg?.wrapping_sub(rotation_deg);
        let goes_on = if self.running_power < 0 { left_deg < 0 } else { left_deg > 0 };
        if goes_on && self.running_power != 0 {
            return None;
        }
        self.limit_deg = None;
        self.run_state = RUN_STATE_IDLE;
        self.running_power = 0;
        Some(self.drive())
    }

    pub(super) fn drive(&self) -> Drive {
        match (self.running_power, self.brakes) {
            (0, true) => Drive::Brake,
            (0, false) => Drive::Coast,
            (power, _) => Drive::Power(power),
        }
    }
}
