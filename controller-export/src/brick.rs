//! An emulator of the brick: runs .rxe programs as the standard firmware does, with simulated sensors.
//!
//! * [`Program`]: a checked .rxe file, as nbc makes it for standard firmware (file versions 0.5 and 0.6).
//! * [`run`]: runs it to its end on an emulated clock and reports every [`Event`].
//! * [`World`]: sensors, buttons and motors around the brick; [`ScriptedWorld`] returns values given in advance.
//!
//! Not emulated: Bluetooth, mailboxes, pictures, colour sensors and motor regulation. A program that uses one of the
//! first four ends with [`Fault::Instruction`]; a motor runs at the power that is set.
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
mod flash;
mod instructions;
mod memory;
mod motors;
mod polymorphic;
mod program;
mod schedule;
mod syscalls;
mod text;
mod world;

use std::collections::BTreeMap;

pub use motors::Drive;
pub use program::{LoadError, Program};
pub use world::{Button, ScriptedWorld, Sonar, World};

use bus::Port;
use flash::Flash;
use instructions::Flow;
use memory::Memory;
use motors::Motor;
use schedule::Schedule;

use crate::onboard::FREE_FLASH_BYTES;

/// Number of instructions that a clump executes before the next one is scheduled.
const TURN: u32 = 20;

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
}

/// What a program did in a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// Observable events in order of time.
    pub events: Vec<Event>,
    /// How the program ended.
    pub end: Termination,
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
    /// Releases of each button before the program last reset its counter.
    forgotten_releases: [u8; 4],
    chance: u32,
    start_tick_ms: u32,
    t_ms: u32,
    events: Vec<Event>,
    instructions: u64,
}

impl Default for RunConfig {
    /// Ten minutes, 100 instructions a millisecond, switched on five seconds ago, an empty file system.
    fn default() -> Self {
        RunConfig {
            run_ms: 600_000,
            instructions_per_ms: 100,
            start_tick_ms: 5_000,
            flash_bytes: FREE_FLASH_BYTES,
            files: BTreeMap::new(),
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
        forgotten_releases: [0; 4],
        chance: 1,
        start_tick_ms: config.start_tick_ms,
        t_ms: 0,
        events: Vec::new(),
        instructions: 0,
    };
    let end = started.unwrap_or_else(|| brick.run(config));
    let motors = match end {
        Termination::Aborted => Default::default(),
        _ => brick.motors.each_ref().map(Motor::drive),
    };
    Report {
        events: brick.events,
        end,
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
            match self.pass(config.instructions_per_ms) {
                Ok(None) => {}
                Ok(Some(end)) => return end,
                Err(fault) => return Termination::Failed(fault),
            }
            let last_ms = self.world.exit_pressed_ms().unwrap_or(u32::MAX).min(config.run_ms);
            self.t_ms = match self.schedule.next_wake_ms() {
                Some(wake_ms) => wake_ms.min(last_ms).max(self.t_ms + 1),
                None => self.t_ms + 1,
            };
        }
    }

    /// One millisecond: clumps run in turn.
    fn pass(&mut self, instructions: u32) -> Result<Option<Termination>, Fault> {
        let mut left = instructions.max(1);
        while let Some(clump) = self.schedule.running() {
            if left == 0 {
                self.schedule.rotate();
                return Ok(None);
            }
            let turn = TURN.min(left);
            match self.turn(clump, turn, &mut left)? {
                Turn::Over => self.schedule.rotate(),
                Turn::Left => {}
                Turn::Stop => return Ok(Some(Termination::Finished)),
            }
        }
        Ok(self.schedule.is_empty().then_some(Termination::Finished))
    }

    /// Up to `turn` instructions of one clump.
    fn turn(&mut self, clump: u8, turn: u32, left: &mut u32) -> Result<Turn, Fault> {
        let (mut pc, end) = (self.schedule.pc(clump), self.program.clumps[usize::from(clump)].code.end);
        for _ in 0..turn {
            if pc >= end {
                return Err(Fault::Instruction);
            }
            *left -= 1;
            self.instructions += 1;
            let flow = match self.execute(pc) {
                // The memory may be fragmented: compact it and try once more.
                Err(Fault::Memory) => {
                    self.memory.compact();
                    self.execute(pc)
                }
                flow => flow,
            };
            match flow? {
                Flow::Next(words) => pc += words,
                Flow::Branch(words) => {
                    pc = pc.checked_add_signed(words.into()).ok_or(Fault::Instruction)?;
                }
                Flow::Suspend(words) => {
                    self.schedule.set_pc(clump, pc + words);
                    return Ok(Turn::Left);
                }
                Flow::Yield(words) => {
                    self.schedule.set_pc(clump, pc + words);
                    return Ok(Turn::Over);
                }
                Flow::ClumpEnds => return Ok(Turn::Left),
                Flow::Stop => return Ok(Turn::Stop),
            }
        }
        self.schedule.set_pc(clump, pc);
        Ok(Turn::Over)
    }

    /// The brick's clock.
    fn tick_ms(&self) -> u32 {
        self.start_tick_ms.wrapping_add(self.t_ms)
    }

    fn emit(&mut self, kind: EventKind) {
        self.events.push(Event { t_ms: self.t_ms, kind });
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
