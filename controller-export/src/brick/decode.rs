//! Instructions taken apart once when a program is loaded, and not whenever they are executed.

use crate::bytecode::{Comparison, Op, SHORT_FORM, VARIABLE_SIZE};

/// Operands of the instruction that has most of a fixed number.
const OPERANDS: usize = 5;

/// What stands at a word of the code, be it the first of an instruction or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decoded {
    /// `None` where no instruction can begin.
    pub(super) op: Option<Op>,
    /// [`Comparison::Equal`] where the instruction compares nothing.
    pub(super) comparison: Comparison,
    /// Words of code.
    pub(super) words: u16,
    pub(super) operands: [u16; OPERANDS],
}

/// Takes apart what stands at each word.
pub(super) fn decode(code: &[u16]) -> Vec<Decoded> {
    let unknown = Decoded { op: None, comparison: Comparison::Equal, words: 1, operands: [0; OPERANDS] };
    (0..code.len()).map(|at| at_word(&code[at..]).unwrap_or(unknown)).collect()
}

fn at_word(code: &[u16]) -> Option<Decoded> {
    let word = *code.first()?;
    if word & SHORT_FORM != 0 {
        return short(word, code);
    }
    let op = Op::from_number(word as u8)?;
    let comparison = match op {
        Op::Tst | Op::Cmp | Op::BrCmp | Op::BrTst => Comparison::from_number((word >> 8) as u8 & 7)?,
        _ => Comparison::Equal,
    };
    let bytes = match word >> 12 {
        VARIABLE_SIZE => *code.get(1)?,
        bytes => bytes,
    };
    if bytes < 4 || bytes % 2 != 0 || op.bytes().is_some_and(|fixed| fixed != bytes) {
        return None;
    }
    let words = bytes / 2;
    let present = code.get(1..usize::from(words))?;
    // Those of variable size have their size and their target before the others.
    if op.bytes().is_none() && words < 3 {
        return None;
    }
    let mut operands = [0; OPERANDS];
    operands.iter_mut().zip(present).for_each(|(operand, word)| *operand = *word);
    Some(Decoded { op: Some(op), comparison, words, operands })
}

/// The short forms, whose first word holds one operand as a signed byte.
fn short(word: u16, code: &[u16]) -> Option<Decoded> {
    let byte = word as i8;
    let (op, words) = match word >> 8 & 7 {
        0 => (Op::Mov, 2),
        1 => (Op::Acquire, 1),
        2 => (Op::Release, 1),
        3 => (Op::SubCall, 2),
        _ => return None,
    };
    let mut operands = [byte as u16, 0, 0, 0, 0];
    if words == 2 {
        let second = *code.get(1)?;
        operands[..2].copy_from_slice(&[second.wrapping_add_signed(byte.into()), second]);
    }
    Some(Decoded { op: Some(op), comparison: Comparison::Equal, words, operands })
}
