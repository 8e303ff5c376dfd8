//! Reports how the run ended, by a text on the display and a tone.

use super::assembler::{Assembler, Label};
use super::layout::{Array, Cluster, Number};
use crate::bytecode::{Syscall, Type};
use crate::onboard::{self, Ending};

/// The line of the display that the text is drawn on, in pixels from the bottom: the fifth of eight.
const LINE_PIXELS: u16 = 24;

pub(super) struct Endings {
    endings: Vec<(Ending, Label, Array)>,
    tone: Cluster,
    frequency_hz: Number,
    tone_ms: Number,
    volume: Number,
    draw: Cluster,
    line: Number,
    text: Array,
    ending_ms: Number,
}

impl Endings {
    pub(super) fn declare(asm: &mut Assembler, endings: &[Ending]) -> Self {
        let endings = endings.iter().map(|ending| (*ending, asm.label(), asm.string(ending.text()))).collect();
        let ending_ms = asm.number(Type::U16, onboard::ENDING_MS.into());
        let draw = asm.cluster(4);
        // The result of the call, which is always the same.
        asm.number(Type::I8, 0);
        // Position: x and y.
        asm.cluster(2);
        asm.number(Type::I16, 0);
        let line = asm.number(Type::I16, 0);
        let text = asm.array(Type::U8, []);
        // Whether to clear the display.
        asm.number(Type::U32, 0);
        let tone = asm.cluster(5);
        asm.number(Type::I8, 0);
        let (frequency_hz, tone_ms) = (asm.number(Type::U16, 0), asm.number(Type::U16, 0));
        // Whether to repeat.
        asm.number(Type::U8, 0);
        let volume = asm.number(Type::U8, 0);
        Endings { endings, tone, frequency_hz, tone_ms, volume, draw, line, text, ending_ms }
    }

    /// Returns the label to jump to for an ending.
    pub(super) fn label(&self, ending: Ending) -> Label {
        let known = self.endings.iter().find(|(known, ..)| *known == ending);
        known.expect("an ending is declared where it is used").1
    }

    /// Prepares text and tone at each ending's label, then jumps to `halt`, or to `announce` if nothing has moved.
    pub(super) fn prepare(&self, asm: &mut Assembler, halt: Label, announce: Label) {
        for (ending, label, text) in &self.endings {
            asm.bind(*label);
            asm.mov_array(self.text, *text);
            asm.set(self.frequency_hz, ending.hz());
            asm.jump(if *ending == Ending::NoSonar { announce } else { halt });
        }
    }

    /// Shows the text for as long as the tone and the brakes need, and ends the program.
    pub(super) fn announce(&self, asm: &mut Assembler) {
        asm.set(self.line, LINE_PIXELS);
        asm.call(Syscall::DrawText, self.draw);
        asm.set(self.tone_ms, onboard::TONE_MS);
        asm.set(self.volume, onboard::TONE_VOLUME.into());
        asm.call(Syscall::SoundPlayTone, self.tone);
        asm.wait(self.ending_ms);
        asm.stop();
    }
}
