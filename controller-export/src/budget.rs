//! Resources that a program takes, and those of the brick.

use std::fmt;

use mindgap_core::limits::POOL_BYTES;

use crate::error::ExportError;
use crate::nxc::source::{log_bytes, log_rows};
use crate::onboard::{FREE_FLASH_BYTES, SONAR_HANG_MS, SONAR_TIMEOUT_MS};

/// Bytecode instructions that the slowest brick executes in a millisecond.
pub const INSTRUCTIONS_PER_MS: u32 = 80;
/// From a step's tick to its request: the clock's own millisecond, and the instructions in between.
const REQUEST_MS: u32 = 2;
/// What a step is longer than its parts: the scheduler's passes, and a brick that is slower than any that was measured.
const MARGIN_MS: u32 = 10;
/// Time to write a row of the log, which writes a page of flash now and then.
const LOG_ROW_MS: u32 = 5;

/// Resources that a program takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Upper bound on the size of the .rxe file in flash.
    pub program_bytes: u32,
    /// Upper bound on the memory for clumps, values and arrays.
    pub memory_bytes: u32,
    /// Flash reserved for the log.
    pub log_bytes: u32,
    /// Time between two steps.
    pub step_ms: u16,
    /// Worst-case duration of a step, with a margin: the shortest step that the brick keeps.
    pub worst_step_ms: u16,
}

/// Resources of a kind of program, whatever its controller.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cost {
    pub(crate) program_bytes: u32,
    pub(crate) memory_bytes: u32,
    /// Worst-case number of bytecode instructions in a step.
    pub(crate) step_instructions: u32,
}

impl Cost {
    pub(crate) const fn plus(self, more: Cost) -> Cost {
        Cost {
            program_bytes: self.program_bytes + more.program_bytes,
            memory_bytes: self.memory_bytes + more.memory_bytes,
            step_instructions: self.step_instructions + more.step_instructions,
        }
    }
}

impl Budget {
    /// The budget of a program of this cost that logs its start and `logged_steps` steps, or nothing.
    pub(crate) fn new(cost: Cost, step_ms: u16, logged_steps: Option<u16>) -> Self {
        let log_ms = if logged_steps.is_some() { LOG_ROW_MS } else { 0 };
        let work_ms = cost.step_instructions.div_ceil(INSTRUCTIONS_PER_MS) + log_ms;
        // The next request has to find the port free that a sensor keeps busy which hangs; the program itself gives up
        // sooner, and does its work meanwhile.
        let busy_ms = SONAR_HANG_MS.max(u32::from(SONAR_TIMEOUT_MS) + work_ms);
        Budget {
            program_bytes: cost.program_bytes,
            memory_bytes: cost.memory_bytes,
            log_bytes: logged_steps.map_or(0, |steps| log_bytes(u32::from(steps) + 1)),
            step_ms,
            worst_step_ms: (REQUEST_MS + busy_ms + MARGIN_MS) as u16,
        }
    }

    /// Checks that the brick can store and run the program.
    pub(crate) fn check(&self) -> Result<(), ExportError> {
        let Budget { log_bytes, step_ms, worst_step_ms, .. } = *self;
        if step_ms < worst_step_ms {
            return Err(ExportError::StepTooShort { step_ms, shortest_ms: worst_step_ms });
        }
        let flash_bytes = FREE_FLASH_BYTES.saturating_sub(self.program_bytes);
        if log_bytes > flash_bytes {
            let steps = log_rows(flash_bytes).saturating_sub(1) as u16;
            return Err(ExportError::LogTooLarge { log_bytes, flash_bytes, steps });
        }
        Ok(())
    }
}

/// One line a resource: taken and available.
impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Budget { program_bytes, memory_bytes, log_bytes, step_ms, worst_step_ms } = self;
        writeln!(f, "program  {program_bytes:>7} of {FREE_FLASH_BYTES} bytes of flash")?;
        if *log_bytes > 0 {
            let flash_bytes = FREE_FLASH_BYTES.saturating_sub(*program_bytes);
            writeln!(f, "log      {log_bytes:>7} of {flash_bytes} bytes of flash without other files")?;
        }
        writeln!(f, "memory   {memory_bytes:>7} of {POOL_BYTES} bytes")?;
        write!(f, "step     {worst_step_ms:>7} of {step_ms} ms at worst")
    }
}
