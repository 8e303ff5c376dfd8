//! Two marks between which `run.sh` counts instructions.

use core::arch::asm;

/// Counting begins when this returns.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn count_from_here() {
    // SAFETY: does nothing. One instruction here and two below keep the two marks apart.
    unsafe { asm!("nop") }
}

/// Counting ends when this is called.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn count_to_here() {
    // SAFETY: does nothing.
    unsafe { asm!("nop", "nop") }
}
