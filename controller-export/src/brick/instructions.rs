//! Executes one instruction of the bytecode.

use std::ops::Range;

use super::arithmetic::{Operation, order};
use super::memory::Place;
use super::{Brick, EventKind, Fault, polymorphic, text};
use crate::bytecode::{Comparison, NONE, Op, SHORT_FORM, Type, VARIABLE_SIZE};

/// Control flow after an instruction; offsets are words of code from its first.
pub(super) enum Flow {
    Next(usize),
    Branch(i16),
    /// The clump waits, and resumes at this offset.
    Suspend(usize),
    /// The clump yields to the others, and resumes at this offset.
    Yield(usize),
    ClumpEnds,
    Stop,
}

impl<'p> Brick<'p, '_> {
    pub(super) fn execute(&mut self, pc: usize) -> Result<Flow, Fault> {
        let word = self.word(pc)?;
        if word & SHORT_FORM != 0 {
            return self.execute_short(word, pc);
        }
        let op = Op::from_number(word as u8).ok_or(Fault::Instruction)?;
        let comparison = Comparison::from_number((word >> 8) as u8 & 7);
        let size = match word >> 12 {
            VARIABLE_SIZE => self.word(pc + 1)?,
            size => size,
        };
        if size < 4 || size % 2 != 0 || op.bytes().is_some_and(|fixed| fixed != size) {
            return Err(Fault::Instruction);
        }
        let next = usize::from(size / 2);
        let operand = |n: usize| self.word(pc + n);
        let operation = || Ok(Operation { op, comparison: comparison.ok_or(Fault::Instruction)? });
        match op {
            Op::Mov => {
                let (to, from) = (operand(1)?, operand(2)?);
                self.mov(to, from)?;
            }
            Op::Set => {
                let (to, value) = (operand(1)?, operand(2)?);
                self.memory.set_id(to, value.into())?;
            }
            Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Mod | Op::And | Op::Or | Op::Xor => {
                let (to, left, right) = (operand(1)?, operand(2)?, operand(3)?);
                // Their comparison bits are ignored.
                let operation = Operation { op, comparison: Comparison::Equal };
                polymorphic::binary(&mut self.memory, operation, Place::of(to), Place::of(left), Place::of(right))?;
            }
            Op::Neg | Op::Not | Op::Sqrt | Op::Abs => {
                let (to, from) = (operand(1)?, operand(2)?);
                let operation = Operation { op, comparison: Comparison::Equal };
                polymorphic::unary(&mut self.memory, operation, Place::of(to), Place::of(from))?;
            }
            Op::Tst => {
                let (to, from, operation) = (operand(1)?, operand(2)?, operation()?);
                polymorphic::unary(&mut self.memory, operation, Place::of(to), Place::of(from))?;
            }
            Op::Cmp => {
                let (to, left, right, operation) = (operand(1)?, operand(2)?, operand(3)?, operation()?);
                self.compare(operation, to, left, right)?;
            }
            Op::BrCmp => {
                let (words, left, right, operation) = (operand(1)?, operand(2)?, operand(3)?, operation()?);
                if self.holds(operation.comparison, left, right)? {
                    return Ok(Flow::Branch(words as i16));
                }
            }
            Op::BrTst => {
                let (words, value, operation) = (operand(1)?, operand(2)?, operation()?);
                let value = if value == NONE { 0 } else { self.memory.get_id(value)? as i32 };
                if operation.comparison.holds(Some(value.cmp(&0))) {
                    return Ok(Flow::Branch(words as i16));
                }
            }
            Op::Jmp => return Ok(Flow::Branch(operand(1)? as i16)),
            Op::Index => {
                let (to, array, index) = (operand(1)?, operand(2)?, operand(3)?);
                let index = self.number_or(index, 0)?;
                let element = self.memory.element(Place::of(array), index)?;
                polymorphic::copy(&mut self.memory, Place::of(to), element)?;
            }
            Op::Replace => self.replace([operand(1)?, operand(2)?, operand(3)?, operand(4)?])?,
            Op::ArrSize => {
                let (to, array) = (operand(1)?, operand(2)?);
                let count = self.memory.count(Place::of(array))?;
                self.memory.set_id(to, count as u32)?;
            }
            Op::ArrInit => {
                let (to, value, count) = (operand(1)?, operand(2)?, operand(3)?);
                let count = usize::from(self.number_or(count, 0)? as u16);
                self.memory.resize(Place::of(to), count)?;
                for index in 0..count {
                    let element = self.memory.element(Place::of(to), index)?;
                    polymorphic::copy(&mut self.memory, element, Place::of(value))?;
                }
            }
            Op::ArrSubset => self.array_subset([operand(1)?, operand(2)?, operand(3)?, operand(4)?])?,
            Op::ArrBuild => self.array_build(operand(2)?, pc + 3..pc + next)?,
            Op::StrCat => self.concatenate(operand(2)?, pc + 3..pc + next)?,
            Op::StrSubset => self.string_subset([operand(1)?, operand(2)?, operand(3)?, operand(4)?])?,
            Op::StrToByteArr => {
                let (to, from) = (operand(1)?, operand(2)?);
                if let Some((_, text)) = self.memory.array(Place::of(from))?.split_last() {
                    let text = text.to_vec();
                    self.memory.set_array(Place::of(to), &text)?;
                }
            }
            Op::ByteArrToStr => {
                let (to, from) = (operand(1)?, operand(2)?);
                let text = self.memory.array(Place::of(from))?.to_vec();
                self.set_string(to, &text)?;
            }
            Op::NumToString => {
                let (to, from) = (operand(1)?, operand(2)?);
                let text = match self.memory.kind(from)? {
                    Type::Float => text::of_float(self.memory.get_float(Place::of(from))?),
                    kind if kind.is_signed() => (self.memory.get_id(from)? as i32).to_string(),
                    _ => self.memory.get_id(from)?.to_string(),
                };
                self.set_string(to, text.as_bytes())?;
            }
            Op::StringToNum => {
                self.string_to_number([operand(1)?, operand(2)?, operand(3)?, operand(4)?, operand(5)?])?;
            }
            Op::Flatten => {
                let (to, from) = (operand(1)?, operand(2)?);
                let mut bytes = Vec::new();
                self.memory.flatten(Place::of(from), &mut bytes)?;
                self.set_string(to, &bytes)?;
            }
            Op::Unflatten => self.unflatten([operand(1)?, operand(2)?, operand(3)?, operand(4)?])?,
            Op::Syscall => {
                let (number, arguments) = (operand(1)?, operand(2)?);
                self.syscall(number, arguments)?;
            }
            Op::Stop => {
                let condition = operand(1)?;
                if condition == NONE || self.memory.get_id(condition)? > 0 {
                    return Ok(Flow::Stop);
                }
            }
            Op::FinClump => {
                let (first, last) = (operand(1)? as i16, operand(2)? as i16);
                let clump = self.schedule.running().ok_or(Fault::Instruction)?;
                let all = &self.program.clumps[usize::from(clump)].dependents;
                let chosen = match (usize::try_from(first), usize::try_from(last)) {
                    (Ok(first), Ok(last)) => all.get(first..=last).ok_or(Fault::Argument)?,
                    _ => &[],
                };
                self.schedule.finish(chosen)?;
                return Ok(Flow::ClumpEnds);
            }
            Op::FinClumpImmed => {
                let dependent = operand(1)? as u8;
                self.schedule.finish(&[dependent])?;
                return Ok(Flow::ClumpEnds);
            }
            Op::Acquire => {
                let mutex = operand(1)?;
                return self.acquire(mutex, next);
            }
            Op::Release => {
                let mutex = operand(1)?;
                self.schedule.release(mutex)?;
            }
            Op::SubCall => {
                let (callee, slot) = (operand(1)?, operand(2)?);
                return self.call(callee, slot, next);
            }
            Op::SubRet => {
                let caller = self.memory.get_id(operand(1)?)? as u8;
                self.schedule.return_to(caller)?;
                return Ok(Flow::ClumpEnds);
            }
            Op::SetIn => {
                let (value, port, field) = (operand(1)?, operand(2)?, operand(3)?);
                let (value, port) = (self.memory.get_id(value)?, self.memory.get_id(port)?);
                let t_ms = self.t_ms;
                self.ports.get_mut(port as usize).ok_or(Fault::Argument)?.set(field, value, t_ms)?;
            }
            Op::GetIn => {
                let (to, port, field) = (operand(1)?, operand(2)?, operand(3)?);
                let port = self.memory.get_id(port)?;
                let value = self.ports.get(port as usize).ok_or(Fault::Argument)?.get(field, self.t_ms)?;
                self.memory.set_id(to, value)?;
            }
            Op::SetOut => self.set_outputs(operand(2)?, pc + 3..pc + next)?,
            Op::GetOut => {
                let (to, port, field) = (operand(1)?, operand(2)?, operand(3)?);
                let port = self.memory.get_id(port)? as usize;
                let motor = self.motors.get(port).ok_or(Fault::Argument)?;
                let value = motor.get(field, self.world.rotation_deg(port, self.t_ms))?;
                self.memory.set_id(to, value)?;
            }
            Op::Wait => {
                let (result, ms) = (operand(1)?, operand(2)?);
                let ms = self.number_or(ms, 0)? as u32;
                if result != NONE {
                    self.memory.set_id(result, self.tick_ms())?;
                }
                if ms == 0 {
                    return Ok(Flow::Yield(next));
                }
                self.schedule.sleep(self.t_ms.saturating_add(ms));
                return Ok(Flow::Suspend(next));
            }
            Op::GetTick => {
                let to = operand(1)?;
                self.memory.set_id(to, self.tick_ms())?;
            }
        }
        Ok(Flow::Next(next))
    }

    /// The short forms, whose first word holds one operand as a signed byte.
    fn execute_short(&mut self, word: u16, pc: usize) -> Result<Flow, Fault> {
        let byte = word as i8;
        match word >> 8 & 7 {
            0 => {
                let from = self.word(pc + 1)?;
                self.mov(from.wrapping_add_signed(byte.into()), from)?;
                Ok(Flow::Next(2))
            }
            1 => self.acquire(byte as u16, 1),
            2 => {
                self.schedule.release(byte as u16)?;
                Ok(Flow::Next(1))
            }
            3 => {
                let slot = self.word(pc + 1)?;
                self.call(slot.wrapping_add_signed(byte.into()), slot, 2)
            }
            _ => Err(Fault::Instruction),
        }
    }

    fn mov(&mut self, to: u16, from: u16) -> Result<(), Fault> {
        let (to_type, from_type) = (self.memory.kind(to)?, self.memory.kind(from)?);
        if to_type.is_integer() && from_type.is_integer() {
            let value = self.memory.get_id(from)?;
            return self.memory.set_id(to, value);
        }
        polymorphic::copy(&mut self.memory, Place::of(to), Place::of(from))
    }

    fn compare(&mut self, operation: Operation, to: u16, left: u16, right: u16) -> Result<(), Fault> {
        let whole = self.memory.kind(left)?.is_aggregate()
            && self.memory.kind(right)?.is_aggregate()
            && !self.memory.kind(to)?.is_aggregate();
        if whole {
            let holds = self.holds(operation.comparison, left, right)?;
            return self.memory.set_id(to, holds.into());
        }
        polymorphic::binary(&mut self.memory, operation, Place::of(to), Place::of(left), Place::of(right))
    }

    fn holds(&self, comparison: Comparison, left: u16, right: u16) -> Result<bool, Fault> {
        let (left_type, right_type) = (self.memory.kind(left)?, self.memory.kind(right)?);
        if left_type.is_integer() && right_type.is_integer() {
            let order = order(self.memory.get_id(left)?, self.memory.get_id(right)?, left_type, right_type);
            return Ok(comparison.holds(Some(order)));
        }
        polymorphic::compare(&self.memory, comparison, Place::of(left), Place::of(right))
    }

    fn acquire(&mut self, mutex: u16, next: usize) -> Result<Flow, Fault> {
        Ok(if self.schedule.acquire(mutex)? { Flow::Next(next) } else { Flow::Suspend(next) })
    }

    fn call(&mut self, callee: u16, slot: u16, next: usize) -> Result<Flow, Fault> {
        let caller = self.schedule.running().ok_or(Fault::Instruction)?;
        self.memory.set_id(slot, caller.into())?;
        self.schedule.call(callee as u8)?;
        Ok(Flow::Suspend(next))
    }

    /// Copies an array with one or more elements replaced; an index out of range changes nothing.
    fn replace(&mut self, [to, from, index, value]: [u16; 4]) -> Result<(), Fault> {
        if to != from {
            self.mov(to, from)?;
        }
        let index = self.number_or(index, 0)?;
        let (to, value) = (Place::of(to), Place::of(value));
        let room = self.memory.count(to)?.saturating_sub(index);
        if self.memory.kind(value.id)? != Type::Array {
            if room > 0 {
                let element = self.memory.element(to, index)?;
                polymorphic::copy(&mut self.memory, element, value)?;
            }
            return Ok(());
        }
        for i in 0..self.memory.count(value)?.min(room) {
            let (element, new) = (self.memory.element(to, index + i)?, self.memory.element(value, i)?);
            polymorphic::copy(&mut self.memory, element, new)?;
        }
        Ok(())
    }

    fn array_subset(&mut self, [to, from, start, length]: [u16; 4]) -> Result<(), Fault> {
        let (to, from) = (Place::of(to), Place::of(from));
        let start = self.number_or(start, 0)?;
        let rest = self.memory.count(from)?.saturating_sub(start);
        let count = self.number_or(length, rest)?.min(rest);
        self.memory.resize(to, count)?;
        for i in 0..count {
            let (element, old) = (self.memory.element(to, i)?, self.memory.element(from, start + i)?);
            polymorphic::copy(&mut self.memory, element, old)?;
        }
        Ok(())
    }

    /// Builds an array from elements or arrays of elements.
    fn array_build(&mut self, to: u16, sources: Range<usize>) -> Result<(), Fault> {
        let sources = self.sources(to, sources)?;
        let mut count = 0;
        for source in sources {
            count += if self.memory.is_same_type(to, *source)? { self.memory.count(Place::of(*source))? } else { 1 };
        }
        let to = Place::of(to);
        self.memory.resize(to, count)?;
        let mut at = 0;
        for source in sources {
            let source = Place::of(*source);
            if !self.memory.is_same_type(to.id, source.id)? {
                let element = self.memory.element(to, at)?;
                polymorphic::copy(&mut self.memory, element, source)?;
                at += 1;
                continue;
            }
            for i in 0..self.memory.count(source)? {
                let (element, new) = (self.memory.element(to, at)?, self.memory.element(source, i)?);
                polymorphic::copy(&mut self.memory, element, new)?;
                at += 1;
            }
        }
        Ok(())
    }

    fn concatenate(&mut self, to: u16, sources: Range<usize>) -> Result<(), Fault> {
        let sources = self.sources(to, sources)?;
        let mut text = Vec::new();
        for source in sources {
            text.extend(self.string(*source)?);
        }
        self.set_string(to, &text)
    }

    /// The operands that an array is built from. The firmware resizes the array first, so that if it is itself an operand,
    /// its contents are overwritten.
    fn sources(&self, to: u16, sources: Range<usize>) -> Result<&'p [u16], Fault> {
        let sources = self.program.code.get(sources).ok_or(Fault::Instruction)?;
        if sources.contains(&to) { Err(Fault::Argument) } else { Ok(sources) }
    }

    fn string_subset(&mut self, [to, from, start, length]: [u16; 4]) -> Result<(), Fault> {
        let text = self.string(from)?.to_vec();
        let start = self.number_or(start, 0)?;
        let rest = text.get(start..).unwrap_or_default();
        let count = self.number_or(length, rest.len())?.min(rest.len());
        self.set_string(to, &rest[..count])
    }

    fn string_to_number(&mut self, [to, end, from, start, default]: [u16; 5]) -> Result<(), Fault> {
        let start = self.number_or(start, 0)?;
        let default = if default == NONE { 0.0 } else { self.memory.get_float(Place::of(default))? };
        let string = self.string(from)?;
        let found = text::to_float(string.get(start..).unwrap_or_default());
        let end_at = if found.is_some() { text::end_of_number(string, start) } else { 0 };
        self.memory.set_float(Place::of(to), found.unwrap_or(default))?;
        self.memory.set_id(end, end_at as u32)
    }

    fn unflatten(&mut self, [to, failed, from, template]: [u16; 4]) -> Result<(), Fault> {
        self.mov(to, template)?;
        let bytes = self.string(from)?.to_vec();
        let mut expected = Vec::new();
        self.memory.flatten(Place::of(template), &mut expected)?;
        let fits = bytes.len() == expected.len();
        if fits {
            self.memory.unflatten(Place::of(to), &mut bytes.as_slice())?;
        }
        self.memory.set_id(failed, (!fits).into())
    }

    fn set_outputs(&mut self, ports: u16, fields: Range<usize>) -> Result<(), Fault> {
        let fields = self.program.code.get(fields).ok_or(Fault::Instruction)?;
        let ports: Vec<usize> = if self.memory.kind(ports)? == Type::Array {
            let ports = Place::of(ports);
            let port = |i| self.memory.get(self.memory.element(ports, i)?).map(|port| port as usize);
            (0..self.memory.count(ports)?).map(port).collect::<Result<_, _>>()?
        } else {
            vec![self.memory.get_id(ports)? as usize]
        };
        for port in ports {
            // A port that does not exist is ignored.
            let Some(motor) = self.motors.get_mut(port) else { continue };
            for pair in fields.chunks_exact(2) {
                motor.set(pair[0], self.memory.get_id(pair[1])?)?;
            }
            if let Some(drive) = motor.apply(self.world.rotation_deg(port, self.t_ms)) {
                self.world.motor(port, drive, self.t_ms);
                self.emit(EventKind::Motor { port, drive });
            }
        }
        Ok(())
    }

    /// A string without its terminating NUL.
    pub(super) fn string(&self, id: u16) -> Result<&[u8], Fault> {
        let bytes = self.memory.array(Place::of(id))?;
        Ok(bytes.split_last().map_or(&[], |(_, text)| text))
    }

    pub(super) fn set_string(&mut self, id: u16, text: &[u8]) -> Result<(), Fault> {
        self.memory.set_array(Place::of(id), &[text, &[0]].concat())
    }

    /// A number, or `default` if the operand is omitted.
    fn number_or(&self, id: u16, default: usize) -> Result<usize, Fault> {
        if id == NONE { Ok(default) } else { Ok(self.memory.get_id(id)? as usize) }
    }

    fn word(&self, at: usize) -> Result<u16, Fault> {
        self.program.code.get(at).copied().ok_or(Fault::Instruction)
    }
}
