//! Applies scalar instructions to arrays and clusters, part by part.

use super::Fault;
use super::arithmetic::{Operation, order};
use super::memory::{Memory, Place};
use crate::bytecode::{Comparison, Op, Type};

/// Iteration over the parts of a value.
#[derive(Clone, Copy)]
enum Parts {
    /// A number, which is used for every part of the other operand.
    One(Place),
    Elements {
        array: Place,
    },
    Members {
        id: u16,
        base: usize,
    },
}

/// Copies a value of any type, part by part.
pub(super) fn copy(memory: &mut Memory, to: Place, from: Place) -> Result<(), Fault> {
    unary(memory, Operation { op: Op::Mov, comparison: Comparison::Equal }, to, from)
}

/// Applies an operation with one operand.
pub(super) fn unary(memory: &mut Memory, operation: Operation, to: Place, from: Place) -> Result<(), Fault> {
    let (to_type, from_type) = (memory.kind(to.id)?, memory.kind(from.id)?);
    if !from_type.is_aggregate() {
        // The firmware cannot store a number in an array, and continues.
        if to_type.is_aggregate() {
            return Ok(());
        }
        if to_type == Type::Float || from_type == Type::Float {
            let value = operation.unary_float(memory.get_float(from)?)?;
            return memory.set_float(to, value);
        }
        let value = operation.unary(memory.get(from)?, from_type)?;
        return memory.set(to, value);
    }
    // The firmware copies arrays of the same integer type unchanged, whatever the operation is.
    if to_type == Type::Array && from_type == Type::Array {
        let (to_element, from_element) = (memory.kind(to.id + 1)?, memory.kind(from.id + 1)?);
        if to_element == from_element && to_element.is_integer() {
            let bytes = memory.array(from)?.to_vec();
            return memory.set_array(to, &bytes);
        }
    }
    let count = match to_type {
        Type::Array => {
            if from_type != Type::Array {
                return Err(Fault::Argument);
            }
            let count = memory.count(from)?;
            memory.resize(to, count)?;
            count
        }
        Type::Cluster => usize::from(memory.entry(to.id)?.members),
        _ => return Err(Fault::Argument),
    };
    let (mut to, mut from) = (parts(memory, to)?, parts(memory, from)?);
    for index in 0..count {
        let (to, from) = (to.part(memory, index)?, from.part(memory, index)?);
        unary(memory, operation, to, from)?;
    }
    Ok(())
}

/// Applies an operation with two operands.
pub(super) fn binary(
    memory: &mut Memory,
    operation: Operation,
    to: Place,
    left: Place,
    right: Place,
) -> Result<(), Fault> {
    let (to_type, left_type, right_type) = (memory.kind(to.id)?, memory.kind(left.id)?, memory.kind(right.id)?);
    if !left_type.is_aggregate() && !right_type.is_aggregate() {
        if [to_type, left_type, right_type].contains(&Type::Float) {
            let value = operation.binary_float(memory.get_float(left)?, memory.get_float(right)?)?;
            return memory.set_float(to, value);
        }
        let value = operation.binary(memory.get(left)?, memory.get(right)?, left_type, right_type)?;
        return memory.set(to, value);
    }
    let count = match to_type {
        Type::Array => {
            let counts = [(left_type, left), (right_type, right)];
            let mut shortest = None;
            for (_, array) in counts.into_iter().filter(|(kind, _)| *kind == Type::Array) {
                let count = memory.count(array)?;
                shortest = Some(shortest.map_or(count, |other: usize| other.min(count)));
            }
            let count = shortest.ok_or(Fault::Argument)?;
            memory.resize(to, count)?;
            count
        }
        Type::Cluster => usize::from(memory.entry(to.id)?.members),
        _ => return Err(Fault::Argument),
    };
    let (mut to, mut left, mut right) = (parts(memory, to)?, parts(memory, left)?, parts(memory, right)?);
    for index in 0..count {
        let to = to.part(memory, index)?;
        let (left, right) = (left.part(memory, index)?, right.part(memory, index)?);
        binary(memory, operation, to, left, right)?;
    }
    Ok(())
}

/// Compares two arrays or clusters by their first different parts, then by their lengths.
pub(super) fn compare(memory: &Memory, comparison: Comparison, left: Place, right: Place) -> Result<bool, Fault> {
    let order = match (memory.kind(left.id)?, memory.kind(right.id)?) {
        (Type::Float, _) | (_, Type::Float) => memory.get_float(left)?.partial_cmp(&memory.get_float(right)?),
        _ => Some(order_of_parts(memory, comparison, left, right)?),
    };
    Ok(comparison.holds(order))
}

fn order_of_parts(
    memory: &Memory,
    comparison: Comparison,
    left: Place,
    right: Place,
) -> Result<std::cmp::Ordering, Fault> {
    use std::cmp::Ordering::{Equal, Less};
    let (left_type, right_type) = (memory.kind(left.id)?, memory.kind(right.id)?);
    if !left_type.is_aggregate() {
        return Ok(order(memory.get(left)?, memory.get(right)?, left_type, right_type));
    }
    if left_type != right_type {
        return Err(Fault::Argument);
    }
    let length = |place: Place| match left_type {
        Type::Array => memory.count(place),
        _ => Ok(usize::from(memory.entry(place.id)?.members)),
    };
    let (left_length, right_length) = (length(left)?, length(right)?);
    if left_length != right_length && matches!(comparison, Comparison::Equal | Comparison::NotEqual) {
        return Ok(Less);
    }
    let (mut left, mut right) = (parts(memory, left)?, parts(memory, right)?);
    for index in 0..left_length.min(right_length) {
        let (left, right) = (left.part(memory, index)?, right.part(memory, index)?);
        let order = order_of_parts(memory, comparison, left, right)?;
        if order != Equal {
            return Ok(order);
        }
    }
    Ok(left_length.cmp(&right_length))
}

fn parts(memory: &Memory, place: Place) -> Result<Parts, Fault> {
    Ok(match memory.kind(place.id)? {
        Type::Array => Parts::Elements { array: place },
        Type::Cluster => Parts::Members { id: place.id + 1, base: place.base },
        _ => Parts::One(place),
    })
}

impl Parts {
    /// Returns the next part, whose index is `index`.
    fn part(&mut self, memory: &Memory, index: usize) -> Result<Place, Fault> {
        match self {
            Parts::One(place) => Ok(*place),
            Parts::Elements { array } => memory.element(*array, index),
            Parts::Members { id, base } => {
                let member = Place { id: *id, base: *base };
                *id = memory.entry(*id)?.next;
                Ok(member)
            }
        }
    }
}
