//! An emulator of the brick, which runs .rxe programs as the standard firmware does, with simulated sensors.
//!
//! * [`Program`]: a checked .rxe file, as nbc makes it for the standard firmware (file versions 0.5 and 0.6).
//! * [`run`]: runs it to its end on an emulated clock and reports every [`Event`].
//! * [`World`]: sensors, buttons and motors around the brick; [`ScriptedWorld`] returns values given in advance.
//!
//! It covers all opcodes that nbc emits for the standard firmware, and all its system calls. There is nothing beyond the
//! brick: no other brick answers by Bluetooth, there is no colour sensor, sounds from files take no time, and pictures are
//! not drawn.
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
const INSTRUCTIONS_PER_TURN: u32 = 20;
/// Time without use after which the brick switches itself off, by default.
const SLEEP_TIMEOUT_MIN: u32 = 10;
/// Number of array or cluster parts that take as long as an instruction. The firmware's own figure is not known.
const PARTS_PER_INSTRUCTION: u32 = 8;

/// The configuration of a run: the state and speed of the brick, and a time limit.
///
/// ```
/// use mindgap_controller_export::brick::RunConfig;
///
/// let slow = RunConfig { instructions_per_ms: 80, ..RunConfig::default() };
/// assert_eq!(slow.run_ms, 600_000);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunConfig {
    /// Time limit of the run, in ms.
    pub run_ms: u32,
    /// Number of bytecode instructions executed per millisecond. A brick executes 80 to 160.
    pub instructions_per_ms: u32,
    /// System clock when the program starts, in ms. A brick counts from the time at which it was switched on.
    pub start_tick_ms: u32,
    /// Flash available for files, in bytes.
    pub flash_bytes: u32,
    /// Files present at the start, by name.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Number of events that are kept. Later ones are only counted.
    pub limit_events: usize,
}

/// What a program did in a run.
///
/// ```
/// use mindgap_controller_export::brick::{Drive, Report};
///
/// /// Whether the robot stands still after the run.
/// fn stands(report: &Report) -> bool {
///     report.motors.iter().all(|drive| !matches!(drive, Drive::Power(_)))
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Report {
    /// Observable events in order of time, at most [`RunConfig::limit_events`].
    pub events: Vec<Event>,
    /// Number of further events, which were not kept.
    pub further_events: u64,
    /// How the program ended.
    pub end: Termination,
    /// Instruction at which the program failed, if it did.
    pub failed_at: Option<CodeLocation>,
    /// Time of the end, in ms since the start.
    pub ended_ms: u32,
    /// Number of instructions executed.
    pub instructions: u64,
    /// Drive of each motor at the end, ports A to C.
    pub motors: [Drive; motors::PORTS],
    /// Whether the program read the sensor on each port, 1 to 4, or asked a digital sensor there.
    pub ports_read: [bool; bus::PORTS],
    /// Files at the end, by name, truncated to the bytes written.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Peak memory of clump records, values and arrays, in bytes.
    pub pool_bytes: usize,
}

/// An observable event.
///
/// ```
/// use mindgap_controller_export::brick::{Event, EventKind};
///
/// let event = Event { t_ms: 400, kind: EventKind::Tone { hz: 880, ms: 250 } };
/// assert_ne!(event.kind, EventKind::Sound("Start.rso".to_owned()));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// Time since the program started, in ms.
    pub t_ms: u32,
    /// What happened.
    pub kind: EventKind,
}

/// The kind of an observable event.
///
/// ```
/// use mindgap_controller_export::brick::{Drive, EventKind};
///
/// let brake = EventKind::Motor { port: 1, drive: Drive::Brake };
/// assert!(matches!(brake, EventKind::Motor { port: 1, .. }));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A motor was set, possibly to the drive that it already had.
    Motor {
        /// Port of the motor, from 0.
        port: usize,
        /// Drive from now on.
        drive: Drive,
    },
    /// A tone was started.
    Tone {
        /// Frequency of the tone, in Hz.
        hz: u16,
        /// Duration of the tone, in ms.
        ms: u16,
    },
    /// A sound file with this name was started.
    Sound(String),
    /// Text was drawn.
    Text {
        /// Position in pixels from the left.
        x: i16,
        /// Position in pixels from the bottom.
        y: i16,
        /// The text.
        text: String,
    },
}

/// A location in a program's code.
///
/// ```
/// use mindgap_controller_export::brick::CodeLocation;
///
/// fn text(CodeLocation { clump, word, instruction, .. }: &CodeLocation) -> String {
///     format!("word {word} of clump {clump}: {instruction}")
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CodeLocation {
    /// Number of the clump (a task or subroutine), as in the listing of nbc.
    pub clump: u8,
    /// Number of the word within the clump, from 0.
    pub word: usize,
    /// Name of the instruction there, and of the system call that it makes.
    pub instruction: String,
}

/// How a program ended.
///
/// ```
/// use mindgap_controller_export::brick::{Fault, Termination};
///
/// let end = Termination::Failed(Fault::Memory);
/// assert_ne!(end, Termination::Finished);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The program reached its end or stopped itself.
    Finished,
    /// The dark button was pressed. The motors coast.
    Aborted,
    /// The firmware aborted the program. The motors run on until somebody presses a button.
    Failed(Fault),
    /// The program was still running at [`RunConfig::run_ms`].
    OutOfTime,
}

/// The reason why the firmware aborts a program.
///
/// ```
/// use mindgap_controller_export::brick::Fault;
///
/// assert_eq!(Fault::Pointer.to_string(), "data outside the dataspace");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// An unknown instruction or call, or execution past the end of the code.
    #[error("unknown instruction")]
    Instruction,
    /// An operand of the wrong type, or an index outside its array.
    #[error("wrong operand or index")]
    Argument,
    /// Data outside the dataspace.
    #[error("data outside the dataspace")]
    Pointer,
    /// Out of memory.
    #[error("out of memory")]
    Memory,
    /// An instruction on more parts than the memory can hold, in a damaged file whose arrays contain each other.
    #[error("arrays that contain each other")]
    CyclicData,
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
    /// Time at which the last tone ends.
    tone_until_ms: u32,
    sleep_timeout_min: u32,
    /// Bits by which tasks agree on the use of resources.
    semaphores: [u8; 2],
    /// Number of releases of each button when the program last reset its counter.
    reset_releases: [u8; 4],
    random_state: u32,
    start_tick_ms: u32,
    t_ms: u32,
    events: Vec<Event>,
    further_events: u64,
    limit_events: usize,
    instructions: u64,
    /// Number of instructions by which long operations on arrays have overdrawn their millisecond.
    overdrawn: u32,
    failed_at: Option<CodeLocation>,
}

impl Default for RunConfig {
    /// Returns a limit of ten minutes, 100 instructions per ms, a brick that was switched on five seconds ago, an empty file
    /// system, and 100,000 events.
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

/// Runs a program until it ends or reaches its time limit, and reports what it did.
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
        reset_releases: [0; 4],
        random_state: 1,
        start_tick_ms: config.start_tick_ms,
        t_ms: 0,
        events: Vec::new(),
        further_events: 0,
        limit_events: config.limit_events,
        instructions: 0,
        overdrawn: 0,
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
        ports_read: brick.ports.each_ref().map(Port::is_read),
        files: brick.flash.into_files(),
        pool_bytes: clump_bytes + brick.memory.peak_bytes(),
    }
}

impl Brick<'_, '_> {
    /// Runs the firmware's scheduler once per millisecond, and skips milliseconds in which every clump sleeps.
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
            self.overdrawn = self.overdrawn.saturating_sub(idle_ms.saturating_mul(config.instructions_per_ms));
            self.t_ms = next_ms;
        }
    }

    /// Runs the clumps in turn for one millisecond.
    fn pass(&mut self, instructions: u32) -> Result<Option<Termination>, Fault> {
        let mut left = instructions.max(1);
        let repaid = self.overdrawn.min(left);
        (left, self.overdrawn) = (left - repaid, self.overdrawn - repaid);
        while let Some(clump) = self.schedule.running() {
            if left == 0 {
                self.schedule.rotate();
                return Ok(None);
            }
            let (executed, turn) = self.turn(clump, INSTRUCTIONS_PER_TURN.min(left));
            self.instructions += u64::from(executed);
            // Long operations may take more than the rest of this millisecond.
            let cost = executed + self.memory.take_parts() / PARTS_PER_INSTRUCTION;
            self.overdrawn += cost.saturating_sub(left);
            left = left.saturating_sub(cost);
            match turn? {
                Turn::Over => self.schedule.rotate(),
                Turn::Left => {}
                Turn::Stop => return Ok(Some(Termination::Finished)),
            }
        }
        Ok(self.schedule.is_empty().then_some(Termination::Finished))
    }

    /// Executes at most `limit` instructions of one clump. Returns their number and how the turn ended.
    fn turn(&mut self, clump: u8, limit: u32) -> (u32, Result<Turn, Fault>) {
        let (mut pc, end) = (self.schedule.pc(clump), self.program.clumps[usize::from(clump)].code.end);
        for executed in 1..=limit {
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
        (limit, Ok(Turn::Over))
    }

    /// Compacts the memory, which may be fragmented, and tries an instruction once more.
    #[cold]
    fn execute_packed(&mut self, pc: usize) -> Result<Flow, Fault> {
        self.memory.compact();
        self.execute(pc)
    }

    /// Records where a program failed, and returns the fault.
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
                (None, _) => {
                    format!("{:#06x}, which is not an instruction of standard firmware", self.program.code[pc])
                }
            },
            _ => "past the end of the clump".to_owned(),
        };
        self.failed_at = Some(CodeLocation { clump, word: pc.saturating_sub(code.start), instruction });
        fault
    }

    /// Returns the brick's clock.
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
    /// The clump may continue after the others.
    Over,
    /// The clump waits or has ended.
    Left,
    /// The program stops.
    Stop,
}
