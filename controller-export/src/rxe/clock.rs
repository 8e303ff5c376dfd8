//! The clock, and the orange button, which is checked while time passes.

use super::assembler::{Assembler, Label};
use super::layout::{Cluster, Number};
use crate::bytecode::{CENTER_BUTTON, Comparison, Syscall, Type};
use crate::onboard;

/// Waits, which a press of the orange button ends.
pub(super) struct Clock {
    left_ms: Number,
    poll_ms: Number,
    call: Cluster,
    button: Number,
    pressed: Number,
    releases: Number,
    resets: Number,
}

impl Clock {
    pub(super) fn declare(asm: &mut Assembler) -> Self {
        let left_ms = asm.number(Type::I32, 0);
        let poll_ms = asm.number(Type::U8, onboard::BUTTON_POLL_MS.into());
        let call = asm.cluster(5);
        // The result of the call, which is always the same.
        asm.number(Type::I8, 0);
        let [button, pressed, releases, resets] = std::array::from_fn(|_| asm.number(Type::U8, 0));
        Clock { left_ms, poll_ms, call, button, pressed, releases, resets }
    }

    /// Waits until the press that started the program is over, and resets the button's counter.
    pub(super) fn await_release(&self, asm: &mut Assembler) {
        let released = asm.label();
        asm.set(self.button, CENTER_BUTTON);
        let held = asm.here();
        asm.call(Syscall::ReadButton, self.call);
        asm.branch_if_zero(self.pressed, Comparison::Equal, released);
        asm.wait(self.poll_ms);
        asm.jump(held);
        asm.bind(released);
        asm.set(self.resets, 1);
        asm.call(Syscall::ReadButton, self.call);
        asm.set(self.resets, 0);
    }

    /// Jumps to `stopped` if the button is pressed, or was pressed since the start.
    pub(super) fn check_button(&self, asm: &mut Assembler, stopped: Label) {
        asm.call(Syscall::ReadButton, self.call);
        asm.branch_if_zero(self.pressed, Comparison::NotEqual, stopped);
        asm.branch_if_zero(self.releases, Comparison::NotEqual, stopped);
    }

    /// Waits until a time. The clock wraps, so times are compared by their difference.
    pub(super) fn wait_until(&self, asm: &mut Assembler, due_ms: Number, stopped: Label) {
        let [last, over] = std::array::from_fn(|_| asm.label());
        let again = asm.here();
        asm.tick(self.left_ms);
        asm.sub(self.left_ms, due_ms, self.left_ms);
        asm.branch_if_zero(self.left_ms, Comparison::LessOrEqual, over);
        self.check_button(asm, stopped);
        asm.branch_if(self.left_ms, Comparison::LessOrEqual, self.poll_ms, last);
        asm.wait(self.poll_ms);
        asm.jump(again);
        asm.bind(last);
        asm.wait(self.left_ms);
        asm.jump(again);
        asm.bind(over);
    }
}
