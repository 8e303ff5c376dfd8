//! An emulator of the brick: runs .rxe programs as the standard firmware does, with simulated sensors.
//!
//! * [`Program`]: a checked .rxe file, as nbc makes it for standard firmware (file versions 0.5 and 0.6).
//! * [`run`]: runs it to its end on an emulated clock and reports every [`Event`].
//! * [`World`]: sensors, buttons and motors around the brick; [`ScriptedWorld`] returns values given in advance.
//!
//! All opcodes that nbc emits for standard firmware and all its system calls are there. Beyond the brick there is
//! nothing: no other brick answers by Bluetooth, there is no colour sensor, and sounds from files take no time. Pictures
//! are not drawn.
//!
//! ```
//! use mindgap_controller_export::brick::{self, Termination, Program, ScriptedWorld, RunConfig};
//!
//! // An empty task, as nbc compiles it: one clump that stops.
//! # let mut file = b"MindstormsNXT\0\0\x06".to_vec();
//! # let header = [1u16, 12, 2, 10, 0, 10, 0, 0, 2, 1, 2];
//! # for word in header { file.extend(word.to_le_bytes()); }
//! # file.extend([1, 1, 0, 0]);
//! # for word in [2u16, 10, 1, 0xFFFF, 0xFFFF] { file.extend(word.to_le_bytes()); }
//! # file.extend([0, 0, 0, 0, 0x29, 0x40, 0xFF, 0xFF]);
//! let program = Program::load(&file)?;
//! let report = brick::run(&program, &mut ScriptedWorld::default(), &RunConfig::default());
//! assert_eq!(report.end, Termination::Finished);
//! # Ok::<(), brick::LoadError>(())
//! ```

mod arithmetic;
mod bus;
mod decode;
mod flash;
mod instructions;
mod io_map;
mod mailboxes;
mod memory;
mod motors;
mod polymorphic;
mod program;
mod regulation;
mod schedule;
mod shaft;
mod syscalls;
mod text;
mod world;

use std::collections::BTreeMap;

pub use motors::Drive;
pub use program::{LoadError, Program};
pub use shaft::Shaft;
pub use world::{Button, Level, Press, ScriptedWorld, Sonar, World};

use bus::Port;
use flash::Flash;
use instructions::Flow;
use io_map::IoMaps;
use mailboxes::Mailboxes;
use memory::Memory;
use motors::Motor;
use schedule::Schedule;

use crate::bytecode::{Op, Syscall};
use crate::onboard::FREE_FLASH_BYTES;

/// Number of instructions that a clump executes before the next one is scheduled.
const TURN: u32 = 20;
/// Time without use after which the brick switches itself off, as it is delivered.
const SLEEP_TIMEOUT_MIN: u32 = 10;
/// Parts of arrays and clusters that take as long as an instruction. The firmware's own figure is not known.
const PARTS_AN_INSTRUCTION: u32 = 8;

/// Configuration of a run: the state and speed of the brick, and a time limit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunConfig {
    /// Time limit of the run.
    pub run_ms: u32,
    /// Bytecode instructions executed in a millisecond; a brick manages 80 to 160.
    pub instructions_per_ms: u32,
    /// System clock when the program starts; a brick counts from when it was switched on.
    pub start_tick_ms: u32,
    /// Flash available for files.
    pub flash_bytes: u32,
    /// Files present at the start, by name.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Events that are kept; later ones are only counted.
    pub limit_events: usize,
}

/// What a program did in a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// Observable events in order of time, at most [`RunConfig::limit_events`].
    pub events: Vec<Event>,
    /// Number of events after those.
    pub further_events: u64,
    /// How the program ended.
    pub end: Termination,
    /// The instruction at which it failed.
    pub failed_at: Option<CodePlace>,
    /// Time of its end, ms since its start.
    pub ended_ms: u32,
    /// Number of instructions executed.
    pub instructions: u64,
    /// Drive of each motor at the end, ports A to C.
    pub motors: [Drive; motors::PORTS],
    /// Files at the end by name, truncated to the bytes written.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Peak memory of clump records, values and arrays, in bytes.
    pub pool_bytes: usize,
}

/// An observable event.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// Time since the program started, ms.
    pub t_ms: u32,
    /// Kind of event.
    pub kind: EventKind,
}

/// Kind of an observable event.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A motor was set, possibly to the drive that it had already.
    Motor {
        /// The motor's port, from 0.
        port: usize,
        /// Its drive from now on.
        drive: Drive,
    },
    /// A tone was started.
    Tone {
        /// Its frequency, Hz.
        hz: u16,
        /// Its duration, ms.
        ms: u16,
    },
    /// A sound file was started.
    Sound(String),
    /// Text was drawn.
    Text {
        /// Pixels from the left.
        x: i16,
        /// Pixels from the bottom.
        y: i16,
        /// The text.
        text: String,
    },
}

/// A place in a program's code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodePlace {
    /// The clump: a task or subroutine, numbered as in the listing of nbc.
    pub clump: u8,
    /// The word within the clump, from 0.
    pub word: usize,
    /// The instruction there, and the system call that it makes.
    pub instruction: String,
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// It reached its end or stopped itself.
    Finished,
    /// The dark button was pressed: the motors coast.
    Aborted,
    /// The firmware aborted it: the motors run on until somebody presses a button.
    Failed(Fault),
    /// It was still running at [`RunConfig::run_ms`].
    OutOfTime,
}

/// Why the firmware aborts a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// An unknown instruction or call, or execution past the end of the code.
    Instruction,
    /// An operand of the wrong type, or an index outside its array.
    Argument,
    /// Data outside the dataspace.
    Pointer,
    /// Out of memory.
    Memory,
    /// An instruction on more parts than memory holds, in a file whose arrays lie within each other.
    Endless,
}

/// The brick while a program runs.
struct Brick<'p, 'w> {
    program: &'p Program,
    world: &'w mut dyn World,
    memory: Memory<'p>,
    schedule: Schedule,
    motors: [Motor; motors::PORTS],
    ports: [Port; bus::PORTS],
    flash: Flash,
    mailboxes: Mailboxes,
    io_maps: IoMaps,
    /// When the last tone ends.
    tone_until_ms: u32,
    sleep_timeout_min: u32,
    /// Bits of which tasks agree who uses what.
    semaphores: [u8; 2],
    /// Releases of each button before the program last reset its counter.
    forgotten_releases: [u8; 4],
    chance: u32,
    start_tick_ms: u32,
    t_ms: u32,
    events: Vec<Event>,
    further_events: u64,
    limit_events: usize,
    instructions: u64,
    /// Instructions that long operations on arrays have taken ahead of time.
    owed: u32,
    failed_at: Option<CodePlace>,
}

impl Default for RunConfig {
    /// Ten minutes, 100 instructions a millisecond, switched on five seconds ago, an empty file system, and 100,000 events.
    fn default() -> Self {
        RunConfig {
            run_ms: 600_000,
            instructions_per_ms: 100,
            start_tick_ms: 5_000,
            flash_bytes: FREE_FLASH_BYTES,
            files: BTreeMap::new(),
            limit_events: 100_000,
        }
    }
}

/// Runs a program until it ends.
pub fn run(program: &Program, world: &mut dyn World, config: &RunConfig) -> Report {
    let clump_bytes = program.pool_bytes() - program.data.len();
    let (memory, started) = match Memory::new(program) {
        Ok(memory) => (memory, None),
        Err(memory) => (memory, Some(Termination::Failed(Fault::Memory))),
    };
    let mut brick = Brick {
        program,
        world,
        memory,
        schedule: Schedule::new(program),
        motors: Default::default(),
        ports: Default::default(),
        flash: Flash::new(config.flash_bytes, &config.files),
        mailboxes: Mailboxes::default(),
        io_maps: IoMaps::default(),
        tone_until_ms: 0,
        sleep_timeout_min: SLEEP_TIMEOUT_MIN,
        semaphores: [0; 2],
        forgotten_releases: [0; 4],
        chance: 1,
        start_tick_ms: config.start_tick_ms,
        t_ms: 0,
        events: Vec::new(),
        further_events: 0,
        limit_events: config.limit_events,
        instructions: 0,
        owed: 0,
        failed_at: None,
    };
    let end = started.unwrap_or_else(|| brick.run(config));
    let motors = match end {
        Termination::Aborted => Default::default(),
        _ => brick.motors.each_ref().map(Motor::drive),
    };
    Report {
        events: brick.events,
        further_events: brick.further_events,
        end,
        failed_at: brick.failed_at,
        ended_ms: brick.t_ms,
        instructions: brick.instructions,
        motors,
        files: brick.flash.into_files(),
        pool_bytes: clump_bytes + brick.memory.most_bytes(),
    }
}

impl Brick<'_, '_> {
    /// Runs the firmware's scheduler once a millisecond, skipping those in which every clump sleeps.
    fn run(&mut self, config: &RunConfig) -> Termination {
        loop {
            if self.world.exit_pressed_ms().is_some_and(|exit_ms| self.t_ms >= exit_ms) {
                return Termination::Aborted;
            }
            if self.t_ms >= config.run_ms {
                return Termination::OutOfTime;
            }
            self.schedule.wake(self.t_ms);
            self.end_at_limits();
            self.regulate_motors();
            match self.pass(config.instructions_per_ms) {
                Ok(None) => {}
                Ok(Some(end)) => return end,
                Err(fault) => return Termination::Failed(fault),
            }
            let last_ms = self.world.exit_pressed_ms().unwrap_or(u32::MAX).min(config.run_ms);
            let next_ms = match self.schedule.next_wake_ms() {
                Some(wake_ms) if !self.motors.iter().any(Motor::is_watched) => wake_ms.min(last_ms).max(self.t_ms + 1),
                _ => self.t_ms + 1,
            };
            let idle_ms = next_ms - self.t_ms - 1;
            self.owed = self.owed.saturating_sub(idle_ms.saturating_mul(config.instructions_per_ms));
            self.t_ms = next_ms;
        }
    }

    fn end_at_limits(&mut self) {
        for port in 0..motors::PORTS {
            if self.motors[port].has_limit() {
                let rotation_deg = self.world.rotation_deg(port, self.t_ms);
                if let Some(drive) = self.motors[port].end_at_limit(rotation_deg) {
                    self.drive(port, drive);
                }
            }
        }
    }

    /// One millisecond: clumps run in turn.
    fn pass(&mut self, instructions: u32) -> Result<Option<Termination>, Fault> {
        let mut left = instructions.max(1);
        let paid = self.owed.min(left);
        (left, self.owed) = (left - paid, self.owed - paid);
        while let Some(clump) = self.schedule.running() {
            if left == 0 {
                self.schedule.rotate();
                return Ok(None);
            }
            let (executed, turn) = self.turn(clump, TURN.min(left));
            self.instructions += u64::from(executed);
            // Long operations may take more than what is left to this millisecond.
            let cost = executed + self.memory.take_parts() / PARTS_AN_INSTRUCTION;
            self.owed += cost.saturating_sub(left);
            left = left.saturating_sub(cost);
            match turn? {
                Turn::Over => self.schedule.rotate(),
                Turn::Left => {}
                Turn::Stop => return Ok(Some(Termination::Finished)),
            }
        }
        Ok(self.schedule.is_empty().then_some(Termination::Finished))
    }

    /// At most `most` instructions of one clump; their number, and how the turn ended.
    fn turn(&mut self, clump: u8, most: u32) -> (u32, Result<Turn, Fault>) {
        let (mut pc, end) = (self.schedule.pc(clump), self.program.clumps[usize::from(clump)].code.end);
        for executed in 1..=most {
            if pc >= end {
                return (executed - 1, Err(self.failed(clump, pc, Fault::Instruction)));
            }
            let flow = match self.execute(pc) {
                Err(Fault::Memory) => self.execute_packed(pc),
                flow => flow,
            };
            let turn = match flow {
                Ok(Flow::Next(words)) => {
                    pc += words;
                    continue;
                }
                Ok(Flow::Branch(words)) => match pc.checked_add_signed(words.into()) {
                    Some(to) => {
                        pc = to;
                        continue;
                    }
                    None => Err(self.failed(clump, pc, Fault::Instruction)),
                },
                Ok(Flow::Suspend(words)) => {
                    self.schedule.set_pc(clump, pc + words);
                    Ok(Turn::Left)
                }
                Ok(Flow::Yield(words)) => {
                    self.schedule.set_pc(clump, pc + words);
                    Ok(Turn::Over)
                }
                Ok(Flow::ClumpEnds) => Ok(Turn::Left),
                Ok(Flow::Stop) => Ok(Turn::Stop),
                Err(fault) => Err(self.failed(clump, pc, fault)),
            };
            return (executed, turn);
        }
        self.schedule.set_pc(clump, pc);
        (most, Ok(Turn::Over))
    }

    /// The memory may be in pieces: packs it and tries an instruction once more.
    #[cold]
    fn execute_packed(&mut self, pc: usize) -> Result<Flow, Fault> {
        self.memory.compact();
        self.execute(pc)
    }

    /// Notes where a program failed, and returns why.
    #[cold]
    fn failed(&mut self, clump: u8, pc: usize, fault: Fault) -> Fault {
        let code = &self.program.clumps[usize::from(clump)].code;
        let instruction = match self.program.decoded.get(pc) {
            Some(decoded) if pc < code.end => match (decoded.op, decoded.operands[0]) {
                (Some(Op::Syscall), number) => match Syscall::from_number(number) {
                    Some(call) => format!("syscall {number} ({call:?})"),
                    None => format!("syscall {number}, which standard firmware does not have"),
                },
                (Some(op), _) => format!("{op:?}").to_lowercase(),
                (None, _) => format!("{:#06x}, which is no instruction of standard firmware", self.program.code[pc]),
            },
            _ => "behind the end of the clump".to_owned(),
        };
        self.failed_at = Some(CodePlace { clump, word: pc.saturating_sub(code.start), instruction });
        fault
    }

    /// The brick's clock.
    fn tick_ms(&self) -> u32 {
        self.start_tick_ms.wrapping_add(self.t_ms)
    }

    fn emit(&mut self, kind: EventKind) {
        if self.events.len() < self.limit_events {
            self.events.push(Event { t_ms: self.t_ms, kind });
        } else {
            self.further_events += 1;
        }
    }
}

/// How a clump's turn ended.
enum Turn {
    /// It may continue after the others.
    Over,
    /// It waits or has ended.
    Left,
    /// The program stops.
    Stop,
}
