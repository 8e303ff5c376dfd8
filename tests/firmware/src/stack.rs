//! Measures the stack of a function: the stack is painted first, and words that are no longer paint were used.

use core::arch::asm;
use core::ptr;

const PAINT: u32 = 0x5041_494e;
/// Number of words that are painted, far more than anything here needs.
const DEPTH_WORDS: usize = 1024;

/// Returns the number of bytes of stack that `work` uses.
#[inline(never)]
pub fn used_by(work: fn()) -> usize {
    let top: *mut u32;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) top, options(nomem, nostack)) };
    // SAFETY: all images leave at least this much space below the stack, nothing below the stack pointer is in use, and
    // interrupts are off or use the stack in the same way.
    unsafe {
        for i in 1..=DEPTH_WORDS {
            ptr::write_volatile(top.sub(i), PAINT);
        }
    }
    work();
    // SAFETY: as above.
    let untouched = (1..=DEPTH_WORDS).rev().take_while(|i| unsafe { ptr::read_volatile(top.sub(*i)) } == PAINT);
    (DEPTH_WORDS - untouched.count()) * size_of::<u32>()
}
