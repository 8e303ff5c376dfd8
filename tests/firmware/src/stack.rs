//! How much stack a function takes: everything below is painted first, and what is no longer paint was used.

use core::arch::asm;
use core::ptr;

const PAINT: u32 = 0x5041_494e;
/// What is painted; far more than anything here takes.
const DEPTH_WORDS: usize = 1024;

/// The bytes of stack that `work` takes.
#[inline(never)]
pub fn used_by(work: fn()) -> usize {
    let top: *mut u32;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) top, options(nomem, nostack)) };
    // SAFETY: all images leave at least this much between the stack and everything else, nothing below the stack
    // pointer is in use, and interrupts are off or use it alike.
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
