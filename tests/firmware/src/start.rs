//! Where an ARM7 begins: the stack is set up and `main` called, in whichever of the two instruction sets it is.

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
