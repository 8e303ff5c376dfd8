//! The resources that a program needs, compared with those of the brick.

use std::fmt;

use mindgap_core::limits::POOL_BYTES;

use crate::error::ExportError;
use crate::onboard::{FREE_FLASH_BYTES, SONAR_HANG_MS, SONAR_TIMEOUT_MS};

/// Number of bytecode instructions that the slowest brick executes per millisecond.
pub const INSTRUCTIONS_PER_MS: u32 = 80;
/// Time from a step's tick to its request: the clock's resolution of a millisecond, and the instructions in between.
const REQUEST_MS: u32 = 2;
/// Allowance for the firmware's scheduler, and for a brick that is slower than any measured one.
const MARGIN_MS: u32 = 10;
/// Time to write a row of the log, which occasionally writes a page of flash.
const LOG_ROW_MS: u32 = 5;
/// Size of the log's header line.
const LOG_HEADER_BYTES: u32 = 80;
/// Size of the longest row of a log: a time of ten digits, two commands, two wheel rotations of seven digits, millivolts, a
/// reading, six commas, and the line end.
const LOG_ROW_BYTES: u32 = 10 + 4 + 4 + 7 + 7 + 5 + 3 + 6 + 2;

/// The resources that a program needs. `Display` prints one line per resource, with what the brick has.
///
/// ```
/// use mindgap_controller_export::onboard::Safety;
/// use mindgap_controller_export::rxe;
/// use mindgap_core::controller::{Controller, Tuple, When};
///
/// let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
/// let budget = rxe::budget(&controller, Safety::default());
/// assert!(budget.worst_step_ms < controller.step_ms);
/// println!("{budget}");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Budget {
    /// Upper bound on the size of the .rxe file in flash.
    pub program_bytes: u32,
    /// Upper bound on the memory for clumps, values and arrays.
    pub memory_bytes: u32,
    /// Flash reserved for the log.
    pub log_bytes: u32,
    /// Time between two steps, as the controller states it.
    pub step_ms: u16,
    /// Worst-case duration of a step, with a margin. It is the shortest step time that the brick can keep.
    pub worst_step_ms: u16,
}

/// The resources of a type of program, which do not depend on its controller.
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
    /// Returns the budget of a program with this cost that logs its start and `logged_steps` steps, or nothing.
    pub(crate) fn new(cost: Cost, step_ms: u16, logged_steps: Option<u16>) -> Self {
        let log_ms = if logged_steps.is_some() { LOG_ROW_MS } else { 0 };
        let work_ms = cost.step_instructions.div_ceil(INSTRUCTIONS_PER_MS) + log_ms;
        // A sensor that hangs keeps its port busy, and the next request has to find it free. The program itself gives up
        // earlier and does its work in the meantime.
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

/// Returns the size of a log of `rows` rows in flash.
fn log_bytes(rows: u32) -> u32 {
    LOG_HEADER_BYTES + rows * LOG_ROW_BYTES
}

/// Returns the number of rows of a log that fit into `bytes`.
fn log_rows(bytes: u32) -> u32 {
    bytes.saturating_sub(LOG_HEADER_BYTES) / LOG_ROW_BYTES
}

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
