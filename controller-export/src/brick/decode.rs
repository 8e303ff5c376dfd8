//! Decodes instructions once, when a program is loaded, rather than at every execution.

use crate::bytecode::{Comparison, Op, SHORT_FORM, VARIABLE_SIZE};

/// Largest number of operands of an instruction with a fixed size.
const OPERANDS: usize = 5;

/// The instruction that starts at a word of the code, whether or not the program reaches it there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decoded {
    /// Operation; `None` where no instruction can start.
    pub(super) op: Option<Op>,
    /// Comparison; [`Comparison::Equal`] if the instruction compares nothing.
    pub(super) comparison: Comparison,
    /// Size in words.
    pub(super) words: u16,
    pub(super) operands: [u16; OPERANDS],
}

/// Decodes the instruction at each word.
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
    // Instructions of variable size have their size and their target before the other operands.
    if op.bytes().is_none() && words < 3 {
        return None;
    }
    let mut operands = [0; OPERANDS];
    operands.iter_mut().zip(present).for_each(|(operand, word)| *operand = *word);
    Some(Decoded { op: Some(op), comparison, words, operands })
}

/// Decodes a short form, whose first word holds one operand as a signed byte.
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
