//! Executes one instruction of the bytecode.

use std::ops::Range;

use super::arithmetic::{Operation, order};
use super::decode::Decoded;
use super::memory::Place;
use super::{Brick, Drive, EventKind, Fault, polymorphic, text};
use crate::bytecode::{Comparison, InputField, NONE, Op, OutputField, Type};

/// Control flow after an instruction. Offsets are words of code from its first word.
pub(super) enum Flow {
    Next(usize),
    Branch(i16),
    /// The clump waits and resumes at this offset.
    Suspend(usize),
    /// The clump yields to the others and resumes at this offset.
    Yield(usize),
    ClumpEnds,
    Stop,
}

impl<'p> Brick<'p, '_> {
    #[inline(always)]
    pub(super) fn execute(&mut self, pc: usize) -> Result<Flow, Fault> {
        let Decoded { op, comparison, words, operands } = self.program.decoded[pc];
        let [first, second, third, fourth, fifth] = operands;
        let op = op.ok_or(Fault::Instruction)?;
        let next = usize::from(words);
        let operation = Operation { op, comparison };
        match op {
            Op::Mov => self.mov(first, second)?,
            Op::Set => self.memory.set_id(first, second.into())?,
            Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Mod | Op::And | Op::Or | Op::Xor => {
                self.calculate(operation, first, second, third)?;
            }
            Op::Neg | Op::Not | Op::Sqrt | Op::Abs | Op::Tst => {
                polymorphic::unary(&mut self.memory, operation, Place::new(first), Place::new(second))?;
            }
            Op::Cmp => self.compare(operation, first, second, third)?,
            Op::BrCmp => {
                if self.holds(comparison, second, third)? {
                    return Ok(Flow::Branch(first as i16));
                }
            }
            Op::BrTst => {
                let value = if second == NONE { 0 } else { self.memory.get_id(second)? as i32 };
                if comparison.holds(Some(value.cmp(&0))) {
                    return Ok(Flow::Branch(first as i16));
                }
            }
            Op::Jmp => return Ok(Flow::Branch(first as i16)),
            Op::Index => self.index(first, second, third)?,
            Op::Replace => self.replace([first, second, third, fourth])?,
            Op::ArrSize => {
                let count = self.memory.count(Place::new(second))?;
                self.memory.set_id(first, count as u32)?;
            }
            Op::ArrInit => {
                let count = usize::from(self.number_or(third, 0)? as u16);
                self.memory.resize(Place::new(first), count)?;
                for index in 0..count {
                    let element = self.memory.element(Place::new(first), index)?;
                    polymorphic::copy(&mut self.memory, element, Place::new(second))?;
                }
            }
            Op::ArrSubset => self.array_subset([first, second, third, fourth])?,
            Op::ArrBuild => self.array_build(second, pc + 3..pc + next)?,
            Op::StrCat => self.concatenate(second, pc + 3..pc + next)?,
            Op::StrSubset => self.string_subset([first, second, third, fourth])?,
            Op::StrToByteArr => {
                if let Some((_, text)) = self.memory.array(Place::new(second))?.split_last() {
                    let text = text.to_vec();
                    self.memory.set_array(Place::new(first), &text)?;
                }
            }
            Op::ByteArrToStr => {
                let text = self.memory.array(Place::new(second))?.to_vec();
                self.set_string(first, &text)?;
            }
            Op::NumToString => {
                let text = match self.memory.kind(second)? {
                    Type::Float => text::from_float(self.memory.get_float(Place::new(second))?),
                    kind if kind.is_signed() => (self.memory.get_id(second)? as i32).to_string(),
                    _ => self.memory.get_id(second)?.to_string(),
                };
                self.set_string(first, text.as_bytes())?;
            }
            Op::StringToNum => self.string_to_number([first, second, third, fourth, fifth])?,
            Op::Flatten => {
                let mut bytes = Vec::new();
                self.memory.flatten(Place::new(second), &mut bytes)?;
                self.set_string(first, &bytes)?;
            }
            Op::Unflatten => self.unflatten([first, second, third, fourth])?,
            Op::Syscall => self.syscall(first, second)?,
            Op::Stop => {
                if first == NONE || self.memory.get_id(first)? > 0 {
                    return Ok(Flow::Stop);
                }
            }
            Op::FinClump => {
                let clump = self.schedule.running().ok_or(Fault::Instruction)?;
                let all = &self.program.clumps[usize::from(clump)].dependents;
                let chosen = match (usize::try_from(first as i16), usize::try_from(second as i16)) {
                    (Ok(first), Ok(last)) => all.get(first..=last).ok_or(Fault::Argument)?,
                    _ => &[],
                };
                self.schedule.finish(chosen)?;
                return Ok(Flow::ClumpEnds);
            }
            Op::FinClumpImmed => {
                self.schedule.finish(&[first as u8])?;
                return Ok(Flow::ClumpEnds);
            }
            Op::Acquire => return self.acquire(first, next),
            Op::Release => self.schedule.release(first)?,
            Op::SubCall => return self.call(first, second, next),
            Op::SubRet => {
                let caller = self.memory.get_id(first)? as u8;
                self.schedule.return_to(caller)?;
                return Ok(Flow::ClumpEnds);
            }
            // The firmware does not check the port and accesses other memory.
            Op::SetIn => {
                let (value, port) = (self.memory.get_id(first)?, self.memory.get_id(second)?);
                let field = InputField::from_number(third).ok_or(Fault::Instruction)?;
                if let Some(port) = self.ports.get_mut(port as usize) {
                    port.set(field, value, self.t_ms);
                }
            }
            Op::GetIn => {
                let port = self.memory.get_id(second)? as usize;
                let field = InputField::from_number(third).ok_or(Fault::Instruction)?;
                let value = match self.ports.get_mut(port) {
                    Some(on_port) => on_port.read_field(field, self.world.percent(port, self.t_ms), self.t_ms),
                    None => 0,
                };
                self.memory.set_id(first, value)?;
            }
            Op::SetOut => self.set_outputs(second, pc + 3..pc + next)?,
            Op::GetOut => {
                let port = self.memory.get_id(second)? as usize;
                let field = OutputField::from_number(third).ok_or(Fault::Instruction)?;
                let value = match self.motors.get(port) {
                    Some(motor) => motor.get(field, self.world.rotation_deg(port, self.t_ms)),
                    None => 0,
                };
                self.memory.set_id(first, value)?;
            }
            Op::Wait => {
                let ms = self.number_or(second, 0)? as u32;
                if first != NONE {
                    self.memory.set_id(first, self.tick_ms())?;
                }
                if ms == 0 {
                    return Ok(Flow::Yield(next));
                }
                self.schedule.sleep(self.t_ms.saturating_add(ms));
                return Ok(Flow::Suspend(next));
            }
            Op::GetTick => self.memory.set_id(first, self.tick_ms())?,
        }
        Ok(Flow::Next(next))
    }

    #[inline]
    fn mov(&mut self, to: u16, from: u16) -> Result<(), Fault> {
        let (to_entry, from_entry) = (self.memory.entry(to)?, self.memory.entry(from)?);
        if to_entry.kind.is_integer() && from_entry.kind.is_integer() {
            let value = self.memory.value(from_entry, 0)?;
            return self.memory.set_value(to_entry, 0, value);
        }
        polymorphic::copy(&mut self.memory, Place::new(to), Place::new(from))
    }

    #[inline]
    fn calculate(&mut self, operation: Operation, to: u16, left: u16, right: u16) -> Result<(), Fault> {
        let memory = &mut self.memory;
        let (to_entry, left_entry, right_entry) = (memory.entry(to)?, memory.entry(left)?, memory.entry(right)?);
        let kinds = [to_entry.kind, left_entry.kind, right_entry.kind];
        if kinds.into_iter().all(Type::is_integer) {
            let (left, right) = (memory.value(left_entry, 0)?, memory.value(right_entry, 0)?);
            let value = operation.binary(left, right, left_entry.kind, right_entry.kind)?;
            return memory.set_value(to_entry, 0, value);
        }
        polymorphic::binary(memory, operation, Place::new(to), Place::new(left), Place::new(right))
    }

    #[inline]
    fn index(&mut self, to: u16, array: u16, index: u16) -> Result<(), Fault> {
        let index = self.number_or(index, 0)?;
        let element = self.memory.element(Place::new(array), index)?;
        let (to_entry, from_entry) = (self.memory.entry(to)?, self.memory.entry(element.id)?);
        if to_entry.kind.is_integer() && from_entry.kind.is_integer() {
            let value = self.memory.value(from_entry, element.base)?;
            return self.memory.set_value(to_entry, 0, value);
        }
        polymorphic::copy(&mut self.memory, Place::new(to), element)
    }

    fn compare(&mut self, operation: Operation, to: u16, left: u16, right: u16) -> Result<(), Fault> {
        let whole = self.memory.kind(left)?.is_aggregate()
            && self.memory.kind(right)?.is_aggregate()
            && !self.memory.kind(to)?.is_aggregate();
        if whole {
            let holds = self.holds(operation.comparison, left, right)?;
            return self.memory.set_id(to, holds.into());
        }
        polymorphic::binary(&mut self.memory, operation, Place::new(to), Place::new(left), Place::new(right))
    }

    #[inline]
    fn holds(&self, comparison: Comparison, left: u16, right: u16) -> Result<bool, Fault> {
        let (left_entry, right_entry) = (self.memory.entry(left)?, self.memory.entry(right)?);
        if left_entry.kind.is_integer() && right_entry.kind.is_integer() {
            let (left, right) = (self.memory.value(left_entry, 0)?, self.memory.value(right_entry, 0)?);
            return Ok(comparison.holds(Some(order(left, right, left_entry.kind, right_entry.kind))));
        }
        polymorphic::compare(&self.memory, comparison, Place::new(left), Place::new(right))
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

    /// Copies an array with one or more elements replaced. An index out of range changes nothing.
    fn replace(&mut self, [to, from, index, value]: [u16; 4]) -> Result<(), Fault> {
        if to != from {
            self.mov(to, from)?;
        }
        let index = self.number_or(index, 0)?;
        let (to, value) = (Place::new(to), Place::new(value));
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
        let (to, from) = (Place::new(to), Place::new(from));
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
            count += if self.memory.is_same_type(to, *source)? { self.memory.count(Place::new(*source))? } else { 1 };
        }
        let to = Place::new(to);
        self.memory.resize(to, count)?;
        let mut at = 0;
        for source in sources {
            let source = Place::new(*source);
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

    /// Returns the operands from which an array is built. The array itself cannot be one, because the firmware resizes it
    /// first and so overwrites its contents.
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
        let default = if default == NONE { 0.0 } else { self.memory.get_float(Place::new(default))? };
        let string = self.string(from)?;
        let found = text::to_float(string.get(start..).unwrap_or_default());
        let end_at = if found.is_some() { text::end_of_number(string, start) } else { 0 };
        self.memory.set_float(Place::new(to), found.unwrap_or(default))?;
        self.memory.set_id(end, end_at as u32)
    }

    fn unflatten(&mut self, [to, failed, from, template]: [u16; 4]) -> Result<(), Fault> {
        self.mov(to, template)?;
        let bytes = self.string(from)?.to_vec();
        let mut expected = Vec::new();
        self.memory.flatten(Place::new(template), &mut expected)?;
        let fits = bytes.len() == expected.len();
        if fits {
            self.memory.unflatten(Place::new(to), &mut bytes.as_slice())?;
        }
        self.memory.set_id(failed, (!fits).into())
    }

    fn set_outputs(&mut self, ports: u16, fields: Range<usize>) -> Result<(), Fault> {
        let fields = self.program.code.get(fields).ok_or(Fault::Instruction)?;
        let ports: Vec<usize> = if self.memory.kind(ports)? == Type::Array {
            let ports = Place::new(ports);
            let port = |i| self.memory.get(self.memory.element(ports, i)?).map(|port| port as usize);
            (0..self.memory.count(ports)?).map(port).collect::<Result<_, _>>()?
        } else {
            vec![self.memory.get_id(ports)? as usize]
        };
        for port in ports {
            // A port that does not exist is ignored.
            let Some(motor) = self.motors.get_mut(port) else { continue };
            for pair in fields.chunks_exact(2) {
                let field = OutputField::from_number(pair[0]).ok_or(Fault::Instruction)?;
                motor.set(field, self.memory.get_id(pair[1])?);
            }
            self.apply_output(port);
        }
        Ok(())
    }

    /// Applies the fields of an output to its motor.
    pub(super) fn apply_output(&mut self, port: usize) {
        let rotation_deg = self.world.rotation_deg(port, self.t_ms);
        if let Some(drive) = self.motors[port].apply(rotation_deg, self.t_ms) {
            self.drive(port, drive);
        }
    }

    /// Reports the drive that a motor was set to. A regulated motor gets the power that its regulation computes from it.
    pub(super) fn drive(&mut self, port: usize, drive: Drive) {
        self.world.motor(port, self.motors[port].regulated_drive(), self.t_ms);
        self.emit(EventKind::Motor { port, drive });
    }

    /// Returns a string without its terminating NUL.
    pub(super) fn string(&self, id: u16) -> Result<&[u8], Fault> {
        let bytes = self.memory.array(Place::new(id))?;
        Ok(bytes.split_last().map_or(&[], |(_, text)| text))
    }

    pub(super) fn set_string(&mut self, id: u16, text: &[u8]) -> Result<(), Fault> {
        self.memory.set_array(Place::new(id), &[text, &[0]].concat())
    }

    /// Returns a number, or `default` if the operand is omitted.
    fn number_or(&self, id: u16, default: usize) -> Result<usize, Fault> {
        if id == NONE { Ok(default) } else { Ok(self.memory.get_id(id)? as usize) }
    }
}
