//! The outputs: the fields that a program writes and their effect on the motors.
//!
//! Source: `c_output.c` of the firmware.

use super::Brick;
use super::regulation::{self, Pair, Speed};
use crate::bytecode::{OutputField, RUN_STATE_IDLE, mode, regulation_mode, update};

/// Number of motor ports of a brick.
pub(super) const PORTS: usize = 3;

/// The drive of a motor.
///
/// ```
/// use mindgap_controller_export::brick::Drive;
///
/// assert_eq!(Drive::default(), Drive::Coast);
/// assert_ne!(Drive::Power(0), Drive::Brake);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drive {
    /// The motor runs at this power, -100..=100; negative is backward.
    Power(i8),
    /// The motor brakes.
    Brake,
    /// The motor turns freely.
    #[default]
    Coast,
}

/// An output: its fields and its motor.
#[derive(Clone, Debug)]
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
    /// Shaft rotation at which each of the three counters was reset.
    tacho_zero: i32,
    block_zero: i32,
    rotation_zero: i32,
    /// The power that was set, the power that the motor gets, and the regulation that computes it if there is one.
    running_power: i8,
    actual_power: i8,
    regulated: Option<Regulated>,
    overloaded: bool,
    brakes: bool,
    /// Shaft rotation at which the run ends.
    limit_deg: Option<i32>,
}

/// The regulation of a motor, which sets its power at the end of each window.
#[derive(Clone, Debug)]
struct Regulated {
    by: Regulation,
    /// Time at which the window ends, and rotation of the shaft at its start.
    ends_ms: u32,
    start_deg: i32,
}

#[derive(Clone, Debug)]
enum Regulation {
    Speed(Speed),
    /// Together with another motor: the first of the two has the state of the pair.
    Pair(Pair),
}

impl Default for Motor {
    fn default() -> Self {
        Motor {
            flags: 0,
            mode: 0,
            power: 0,
            tacho_limit: 0,
            run_state: RUN_STATE_IDLE,
            turn_ratio: 0,
            regulation_mode: 0,
            gains: regulation::GAINS,
            options: 0,
            max_speed: 0,
            max_acceleration: 0,
            tacho_zero: 0,
            block_zero: 0,
            rotation_zero: 0,
            running_power: 0,
            actual_power: 0,
            regulated: None,
            overloaded: false,
            brakes: false,
            limit_deg: None,
        }
    }
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
            OutputField::ActualSpeed => self.actual_power as u32,
            OutputField::TachoCount => rotation_deg.wrapping_sub(self.tacho_zero) as u32,
            OutputField::TachoLimit => self.tacho_limit,
            OutputField::RunState => u32::from(self.run_state),
            OutputField::TurnRatio => self.turn_ratio as u32,
            OutputField::RegulationMode => u32::from(self.regulation_mode),
            OutputField::Overload => self.overloaded.into(),
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

    /// Applies the fields selected by the flags, as the firmware does in its next millisecond. Returns the new drive if the
    /// flags affect it.
    pub(super) fn apply(&mut self, rotation_deg: i32, t_ms: u32) -> Option<Drive> {
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
            self.overloaded = false;
        }
        if flags & update::MODE != 0 {
            // A motor that is switched off turns freely, whatever the other bits are.
            self.brakes = is_on && self.mode & mode::BRAKE != 0;
            if !is_on {
                self.running_power = 0;
                self.run_state = RUN_STATE_IDLE;
            }
        }
        if flags & (update::MODE | update::SPEED) != 0 {
            self.regulate(rotation_deg, t_ms);
        }
        if flags & update::TACHO_LIMIT != 0 {
            let limit_deg = self.tacho_limit as i32;
            self.limit_deg = match self.running_power {
                _ if limit_deg == 0 => None,
                power if power < 0 => Some(rotation_deg.wrapping_sub(limit_deg)),
                _ => Some(rotation_deg.wrapping_add(limit_deg)),
            };
        }
        (flags & (update::SPEED | update::MODE) != 0).then(|| self.drive())
    }

    /// Returns whether the motor runs until it has turned by a limit.
    pub(super) fn has_limit(&self) -> bool {
        self.limit_deg.is_some()
    }

    /// Returns whether the shaft has turned by the limit, in the direction in which the motor is driven.
    fn has_arrived(&self, rotation_deg: i32) -> bool {
        self.limit_deg.is_some_and(|limit_deg| match self.running_power.signum() {
            1 => rotation_deg >= limit_deg,
            -1 => rotation_deg <= limit_deg,
            // The firmware waits for a motor without power, although it never arrives.
            _ => false,
        })
    }

    /// Ends a run at its limit. The motor turns freely, and its program has to brake it.
    fn end_run(&mut self) -> Drive {
        self.limit_deg = None;
        self.run_state = RUN_STATE_IDLE;
        self.running_power = 0;
        self.actual_power = 0;
        self.regulated = None;
        self.brakes = false;
        self.drive()
    }

    /// Starts, continues or ends the regulation that the fields select. The motor keeps its power until the end of the window:
    /// one at rest waits.
    fn regulate(&mut self, rotation_deg: i32, t_ms: u32) {
        let is_regulated = self.mode & mode::REGULATED != 0 && self.running_power != 0;
        let by = match self.regulation_mode {
            regulation_mode::SPEED if is_regulated => Regulation::Speed(Speed::default()),
            regulation_mode::SYNC if is_regulated => Regulation::Pair(Pair::default()),
            _ => {
                self.actual_power = self.running_power;
                self.regulated = None;
                return;
            }
        };
        match &mut self.regulated {
            // A new speed continues the errors of the last one. A pair begins a new movement, in the same window.
            Some(Regulated { by: Regulation::Speed(_), .. }) if matches!(by, Regulation::Speed(_)) => {}
            Some(regulated) => regulated.by = by,
            None => {
                let ends_ms = t_ms.saturating_add(regulation::WINDOW_MS);
                self.regulated = Some(Regulated { by, ends_ms, start_deg: rotation_deg });
            }
        }
    }

    /// Returns whether the motor is one of two that are kept together.
    fn is_synchronised(&self) -> bool {
        matches!(self.regulated, Some(Regulated { by: Regulation::Pair(_), .. }))
    }

    /// Starts the next window if one has ended. Returns whether it has.
    fn next_window(&mut self, t_ms: u32) -> bool {
        match &mut self.regulated {
            Some(regulated) if regulated.ends_ms <= t_ms => {
                regulated.ends_ms = t_ms.saturating_add(regulation::WINDOW_MS);
                true
            }
            _ => false,
        }
    }

    fn hold_speed(&mut self, rotation_deg: i32) {
        if let Some(Regulated { by: Regulation::Speed(speed), start_deg, .. }) = &mut self.regulated {
            let turned_deg = rotation_deg.wrapping_sub(std::mem::replace(start_deg, rotation_deg));
            (self.actual_power, self.overloaded) = speed.power(self.running_power, turned_deg, self.gains);
        }
    }

    /// Returns the powers of this motor and of the other one of its pair.
    fn pair_powers(&mut self, turned_deg: [i32; 2]) -> Option<[i8; 2]> {
        match &mut self.regulated {
            Some(Regulated { by: Regulation::Pair(pair), .. }) => {
                Some(pair.powers(self.running_power, self.turn_ratio, turned_deg, self.gains))
            }
            _ => None,
        }
    }

    /// Returns whether the shaft is checked in every millisecond: the motor runs to a limit or is regulated.
    pub(super) fn is_watched(&self) -> bool {
        self.has_limit() || self.regulated.is_some()
    }

    /// Returns the drive that was set.
    pub(super) fn drive(&self) -> Drive {
        self.drive_with(self.running_power)
    }

    /// Returns the drive that the regulation computes from it.
    pub(super) fn regulated_drive(&self) -> Drive {
        self.drive_with(self.actual_power)
    }

    fn drive_with(&self, power: i8) -> Drive {
        match (power, self.brakes) {
            (0, true) => Drive::Brake,
            (0, false) => Drive::Coast,
            (power, _) => Drive::Power(power),
        }
    }
}

impl Brick<'_, '_> {
    /// Ends the runs of motors that have arrived at their limits. The first motor of a synchronised pair to arrive ends both.
    pub(super) fn end_at_limits(&mut self) {
        for port in 0..PORTS {
            if !self.motors[port].has_limit() {
                continue;
            }
            let rotation_deg = self.world.rotation_deg(port, self.t_ms);
            if !self.motors[port].has_arrived(rotation_deg) {
                continue;
            }
            if self.motors[port].is_synchronised() {
                // A motor without a partner never ends.
                let Some(other) = self.partner(port) else { continue };
                if self.motors[port].turn_ratio != 0 {
                    let counted_deg = rotation_deg.wrapping_sub(self.motors[port].tacho_zero);
                    let other_deg = self.world.rotation_deg(other, self.t_ms);
                    self.motors[other].tacho_zero = other_deg.wrapping_sub(counted_deg);
                }
                self.end_run(other);
            }
            self.end_run(port);
        }
    }

    fn end_run(&mut self, port: usize) {
        let drive = self.motors[port].end_run();
        self.drive(port, drive);
    }

    /// Returns the first other motor that is synchronised.
    fn partner(&self, port: usize) -> Option<usize> {
        (0..PORTS).find(|other| *other != port && self.motors[*other].is_synchronised())
    }

    /// Sets the power of regulated motors whose window has ended.
    pub(super) fn regulate_motors(&mut self) {
        for port in 0..PORTS {
            if !self.motors[port].next_window(self.t_ms) {
                continue;
            }
            let changed =
                if self.motors[port].is_synchronised() { self.regulate_pair(port) } else { self.hold_speed(port) };
            for port in changed {
                self.world.motor(port, self.motors[port].regulated_drive(), self.t_ms);
            }
        }
    }

    fn hold_speed(&mut self, port: usize) -> Vec<usize> {
        let rotation_deg = self.world.rotation_deg(port, self.t_ms);
        self.motors[port].hold_speed(rotation_deg);
        vec![port]
    }

    /// Lets the first motor of a pair set the power of both. A motor without a partner continues unchanged.
    fn regulate_pair(&mut self, port: usize) -> Vec<usize> {
        let pair: Vec<usize> = (0..PORTS).filter(|at| self.motors[*at].is_synchronised()).take(2).collect();
        let [first, second] = pair[..] else { return Vec::new() };
        if first != port {
            return Vec::new();
        }
        let turned_deg = [first, second].map(|at| {
            let rotation_deg = self.world.rotation_deg(at, self.t_ms);
            rotation_deg.wrapping_sub(self.motors[at].block_zero)
        });
        let powers = self.motors[first].pair_powers(turned_deg).into_iter().flatten();
        for (at, new_power) in pair.iter().zip(powers) {
            self.motors[*at].actual_power = new_power;
        }
        pair
    }
}
