//! The entry point of an ARM7: sets up the stack and calls `main`, in either of the two instruction sets.

core::arch::global_asm!(
    ".section .text._start, \"ax\"",
    ".arm",
    ".global _start",
    ".type _start, %function",
    "_start:",
    "ldr sp, =_stack_start",
    "ldr r0, =main",
    "bx r0",
    ".ltorg",
    ".section .bss.stack, \"aw\", %nobits",
    ".balign 8",
    ".space 16384",
    "_stack_start:",
);
