//! The dataspace: typed values at fixed offsets, and arrays that grow, move and are compacted.
//!
//! Source: the memory manager of the firmware, `cCmdDVArrayAlloc` and its neighbours in `c_cmd.c`.

use std::cell::Cell;

use mindgap_core::limits::POOL_BYTES;

use super::Fault;
use super::program::{DopeVector, Entry, Program};
use crate::bytecode::{CLUMP_RECORD_BYTES, Type};

/// Number of dope vectors added at once when none is free.
const DOPE_VECTORS_ADDED: usize = 25;
const MAX_SPARE_DOPE_VECTORS: usize = 200;
/// Number of array and cluster parts that the instructions of one turn may touch: more than a valid program can in this
/// memory, fewer than a damaged file can claim to hold.
const MAX_PARTS: u32 = 1 << 22;
/// Number of bytes of a block copy that count as one part.
const BYTES_PER_PART: usize = 64;
/// The dope vector of the table of dope vectors itself.
const TABLE: usize = 0;

pub(super) struct Memory<'p> {
    entries: &'p [Entry],
    bytes: Vec<u8>,
    static_bytes: usize,
    dope: Vec<DopeVector>,
    free: Vec<u16>,
    /// Size of the pool available to the dataspace, in bytes.
    limit: usize,
    peak_bytes: usize,
    /// Number of parts touched since the last `take_parts`.
    parts: Cell<u32>,
}

/// A value: its entry, and the offset of the array element that contains it (0 outside arrays).
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) id: u16,
    pub(super) base: usize,
}

impl Place {
    /// Returns the place of an entry outside arrays.
    pub(super) fn new(id: u16) -> Place {
        Place { id, base: 0 }
    }
}

impl<'p> Memory<'p> {
    /// Returns the dataspace at a program's start, as an error if the pool is too small for it.
    pub(super) fn new(program: &'p Program) -> Result<Memory<'p>, Memory<'p>> {
        let limit = POOL_BYTES - (program.clumps.len() * CLUMP_RECORD_BYTES).next_multiple_of(4);
        let mut memory = Memory {
            entries: &program.entries,
            bytes: program.data.clone(),
            static_bytes: program.static_bytes,
            dope: program.dope.clone(),
            free: Vec::new(),
            limit,
            peak_bytes: program.data.len(),
            parts: Cell::new(0),
        };
        match memory.add_dope_vectors((program.dope.len() / 2).min(MAX_SPARE_DOPE_VECTORS)) {
            Ok(()) => Ok(memory),
            Err(_) => Err(memory),
        }
    }

    #[inline]
    pub(super) fn entry(&self, id: u16) -> Result<Entry, Fault> {
        self.entries.get(usize::from(id)).copied().ok_or(Fault::Argument)
    }

    #[inline]
    pub(super) fn kind(&self, id: u16) -> Result<Type, Fault> {
        Ok(self.entry(id)?.kind)
    }

    /// Returns the number of parts touched since the last call.
    pub(super) fn take_parts(&self) -> u32 {
        self.parts.replace(0)
    }

    fn touch(&self, parts: usize) -> Result<(), Fault> {
        let touched = self.parts.get().saturating_add(parts as u32);
        self.parts.set(touched);
        if touched > MAX_PARTS { Err(Fault::CyclicData) } else { Ok(()) }
    }

    /// Returns a number as an integer in the firmware's 32-bit accumulator. A float is rounded by adding or
    /// subtracting a half, and saturates.
    pub(super) fn get(&self, place: Place) -> Result<u32, Fault> {
        self.value(self.entry(place.id)?, place.base)
    }

    /// Equals [`get`](Self::get) for an entry that was looked up before.
    #[inline]
    pub(super) fn value(&self, entry: Entry, base: usize) -> Result<u32, Fault> {
        let at = entry.at(base);
        Ok(match entry.kind {
            Type::U8 => u32::from(self.read::<1>(at)?[0]),
            Type::I8 => self.read::<1>(at)?[0] as i8 as u32,
            Type::U16 => u32::from(u16::from_le_bytes(self.read(at)?)),
            Type::I16 => i16::from_le_bytes(self.read(at)?) as u32,
            Type::U32 | Type::I32 => u32::from_le_bytes(self.read(at)?),
            Type::Float => {
                let float = f32::from_le_bytes(self.read(at)?);
                (float + 0.5f32.copysign(float)) as i32 as u32
            }
            Type::Void | Type::Array | Type::Cluster | Type::Mutex => return Err(Fault::Argument),
        })
    }

    #[inline]
    pub(super) fn get_id(&self, id: u16) -> Result<u32, Fault> {
        self.get(Place::new(id))
    }

    pub(super) fn get_float(&self, place: Place) -> Result<f32, Fault> {
        let entry = self.entry(place.id)?;
        match entry.kind {
            Type::Float => Ok(f32::from_le_bytes(self.read(entry.at(place.base))?)),
            kind if kind.is_signed() => Ok(self.get(place)? as i32 as f32),
            _ => Ok(self.get(place)? as f32),
        }
    }

    /// Stores the low bytes of a number, as many as the type has.
    pub(super) fn set(&mut self, place: Place, value: u32) -> Result<(), Fault> {
        self.set_value(self.entry(place.id)?, place.base, value)
    }

    /// Equals [`set`](Self::set) for an entry that was looked up before.
    #[inline]
    pub(super) fn set_value(&mut self, entry: Entry, base: usize, value: u32) -> Result<(), Fault> {
        let at = entry.at(base);
        match entry.kind {
            Type::U8 | Type::I8 => self.write(at, [value as u8]),
            Type::U16 | Type::I16 => self.write(at, (value as u16).to_le_bytes()),
            Type::U32 | Type::I32 => self.write(at, value.to_le_bytes()),
            Type::Float => self.write(at, (value as i32 as f32).to_le_bytes()),
            Type::Void | Type::Array | Type::Cluster | Type::Mutex => Err(Fault::Argument),
        }
    }

    #[inline]
    pub(super) fn set_id(&mut self, id: u16, value: u32) -> Result<(), Fault> {
        self.set(Place::new(id), value)
    }

    /// Stores a float. In an integer, signed or not, it is truncated towards zero and saturates as a signed one.
    pub(super) fn set_float(&mut self, place: Place, value: f32) -> Result<(), Fault> {
        let entry = self.entry(place.id)?;
        match entry.kind {
            Type::Float => self.write(entry.at(place.base), value.to_le_bytes()),
            _ => self.set(place, value as i32 as u32),
        }
    }

    /// Returns the number of elements of an array.
    pub(super) fn count(&self, array: Place) -> Result<usize, Fault> {
        Ok(self.dope[self.vector(array)?].count)
    }

    /// Returns the place of an array's element.
    #[inline]
    pub(super) fn element(&self, array: Place, index: usize) -> Result<Place, Fault> {
        self.touch(1)?;
        let vector = self.dope[self.vector(array)?];
        match vector.offset {
            Some(offset) if index < vector.count => {
                Ok(Place { id: array.id + 1, base: offset + vector.element_bytes * index })
            }
            _ => Err(Fault::Argument),
        }
    }

    /// Returns an array's elements as bytes.
    pub(super) fn array(&self, array: Place) -> Result<&[u8], Fault> {
        let vector = self.dope[self.vector(array)?];
        let offset = vector.offset.unwrap_or(0);
        let bytes = self.bytes.get(offset..offset + vector.element_bytes * vector.count).ok_or(Fault::Pointer)?;
        self.touch(bytes.len() / BYTES_PER_PART)?;
        Ok(bytes)
    }

    /// Replaces the contents of an array.
    pub(super) fn set_array(&mut self, array: Place, bytes: &[u8]) -> Result<(), Fault> {
        let vector = self.vector(array)?;
        let element_bytes = self.dope[vector].element_bytes.max(1);
        self.resize(array, bytes.len() / element_bytes)?;
        let offset = self.dope[vector].offset.unwrap_or(0);
        let room = self.bytes.get_mut(offset..offset + bytes.len()).ok_or(Fault::Pointer)?;
        room.copy_from_slice(bytes);
        Ok(())
    }

    /// Resizes an array to `count` elements. After a [`Fault::Memory`] everything is unchanged; call
    /// [`compact`](Self::compact) and try again.
    pub(super) fn resize(&mut self, array: Place, count: usize) -> Result<(), Fault> {
        let vector = self.vector(array)?;
        let old_count = self.dope[vector].count;
        if old_count == count {
            return Ok(());
        }
        let element_id = array.id + 1;
        let holds_arrays = self.kind(element_id)?.is_aggregate();
        if holds_arrays {
            for index in count..old_count {
                let base = self.element(array, index)?.base;
                self.free_arrays_in(Place { id: element_id, base })?;
            }
        }
        self.resize_vector(vector, count)?;
        if holds_arrays {
            for index in old_count..count {
                let base = self.element(array, index)?.base;
                self.add_arrays_in(Place { id: element_id, base })?;
            }
        }
        Ok(())
    }

    /// Moves all arrays together, in the order of their offsets.
    pub(super) fn compact(&mut self) {
        let parts = self.bytes.len() / BYTES_PER_PART + self.dope.len();
        self.parts.set(self.parts.get().saturating_add(parts as u32));
        let mut order: Vec<usize> = (0..self.dope.len()).filter(|i| self.dope[*i].offset.is_some()).collect();
        order.sort_by_key(|i| self.dope[*i].offset);
        let mut end = self.static_bytes;
        for vector in order {
            let DopeVector { offset, element_bytes, count, .. } = self.dope[vector];
            let size = element_bytes * count;
            let to = end.next_multiple_of(4);
            if let Some(from) = offset
                && from + size <= self.bytes.len()
                && to <= from
            {
                self.bytes.copy_within(from..from + size, to);
                self.dope[vector].offset = Some(to);
                end = to + size;
            }
            self.dope[vector].capacity = size;
        }
        self.bytes.truncate(end);
    }

    /// Returns the peak size of the dataspace, in bytes.
    pub(super) fn peak_bytes(&self) -> usize {
        self.peak_bytes
    }

    /// Returns whether two entries describe the same type.
    pub(super) fn is_same_type(&self, left: u16, right: u16) -> Result<bool, Fault> {
        let (left_entry, right_entry) = (self.entry(left)?, self.entry(right)?);
        if left_entry.kind != right_entry.kind {
            return Ok(false);
        }
        match left_entry.kind {
            Type::Array => self.is_same_type(left + 1, right + 1),
            Type::Cluster if left_entry.members != right_entry.members => Ok(false),
            Type::Cluster => {
                let (mut left, mut right) = (left + 1, right + 1);
                for _ in 0..left_entry.members {
                    if !self.is_same_type(left, right)? {
                        return Ok(false);
                    }
                    (left, right) = (self.entry(left)?.next, self.entry(right)?.next);
                }
                Ok(true)
            }
            _ => Ok(true),
        }
    }

    /// Appends the bytes of a value, its parts in order and without padding.
    pub(super) fn flatten(&self, place: Place, bytes: &mut Vec<u8>) -> Result<(), Fault> {
        let entry = self.entry(place.id)?;
        match entry.kind {
            Type::Array if !self.kind(place.id + 1)?.is_aggregate() => bytes.extend(self.array(place)?),
            Type::Array => {
                for index in 0..self.count(place)? {
                    self.flatten(self.element(place, index)?, bytes)?;
                }
            }
            Type::Cluster => {
                let mut id = place.id + 1;
                for _ in 0..entry.members {
                    self.flatten(Place { id, base: place.base }, bytes)?;
                    id = self.entry(id)?.next;
                }
            }
            kind => {
                let at = entry.at(place.base);
                bytes.extend(self.bytes.get(at..at + kind.bytes()).ok_or(Fault::Pointer)?);
            }
        }
        Ok(())
    }

    /// Inverts [`flatten`](Self::flatten). Arrays have to have their lengths already.
    pub(super) fn unflatten(&mut self, place: Place, bytes: &mut &[u8]) -> Result<(), Fault> {
        let entry = self.entry(place.id)?;
        match entry.kind {
            Type::Array => {
                for index in 0..self.count(place)? {
                    self.unflatten(self.element(place, index)?, bytes)?;
                }
                Ok(())
            }
            Type::Cluster => self.each_member(place, |memory, member| memory.unflatten(member, bytes)),
            kind => {
                let at = entry.at(place.base);
                let value = bytes.split_off(..kind.bytes()).ok_or(Fault::Pointer)?;
                self.bytes.get_mut(at..at + kind.bytes()).ok_or(Fault::Pointer)?.copy_from_slice(value);
                Ok(())
            }
        }
    }

    fn vector(&self, array: Place) -> Result<usize, Fault> {
        let entry = self.entry(array.id)?;
        if entry.kind != Type::Array {
            return Err(Fault::Argument);
        }
        let vector = usize::from(u16::from_le_bytes(self.read(entry.at(array.base))?));
        if vector == TABLE || vector >= self.dope.len() {
            return Err(Fault::Pointer);
        }
        Ok(vector)
    }

    fn resize_vector(&mut self, vector: usize, count: usize) -> Result<(), Fault> {
        let DopeVector { offset, element_bytes, count: old_count, capacity } = self.dope[vector];
        let size = element_bytes * count;
        if count > old_count && (offset.is_none() || size > capacity) {
            let to = self.bytes.len().next_multiple_of(4);
            if to + size >= self.limit {
                return Err(Fault::Memory);
            }
            self.bytes.resize(to + size, 0);
            self.peak_bytes = self.peak_bytes.max(to + size);
            if let Some(from) = offset {
                self.bytes.copy_within(from..from + element_bytes * old_count, to);
            }
            self.dope[vector].offset = Some(to);
            self.dope[vector].capacity = size;
        }
        self.dope[vector].count = count;
        Ok(())
    }

    fn add_dope_vectors(&mut self, count: usize) -> Result<(), Fault> {
        let old = self.dope.len();
        self.resize_vector(TABLE, old + count)?;
        self.dope.resize(old + count, DopeVector { offset: None, element_bytes: 0, count: 0, capacity: 0 });
        self.free.extend((old..old + count).rev().map(|vector| vector as u16));
        Ok(())
    }

    fn add_arrays_in(&mut self, element: Place) -> Result<(), Fault> {
        let entry = self.entry(element.id)?;
        match entry.kind {
            Type::Array => {
                let element_bytes = self.layout(element.id + 1)?.0;
                if self.free.is_empty() {
                    self.add_dope_vectors(DOPE_VECTORS_ADDED)?;
                }
                let vector = self.free.pop().ok_or(Fault::Memory)?;
                self.dope[usize::from(vector)] = DopeVector { offset: None, element_bytes, count: 0, capacity: 0 };
                self.write(entry.at(element.base), vector.to_le_bytes())
            }
            Type::Cluster => self.each_member(element, Self::add_arrays_in),
            _ => Ok(()),
        }
    }

    fn free_arrays_in(&mut self, element: Place) -> Result<(), Fault> {
        match self.kind(element.id)? {
            Type::Array => {
                let vector = self.vector(element)?;
                if self.kind(element.id + 1)?.is_aggregate() {
                    for index in 0..self.dope[vector].count {
                        let inner = self.element(element, index)?;
                        self.free_arrays_in(inner)?;
                    }
                }
                self.dope[vector] = DopeVector { offset: None, element_bytes: 0, count: 0, capacity: 0 };
                self.free.push(vector as u16);
                Ok(())
            }
            Type::Cluster => self.each_member(element, Self::free_arrays_in),
            _ => Ok(()),
        }
    }

    fn each_member(
        &mut self,
        cluster: Place,
        mut act: impl FnMut(&mut Self, Place) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let mut id = cluster.id + 1;
        for _ in 0..self.entry(cluster.id)?.members {
            act(self, Place { id, base: cluster.base })?;
            id = self.entry(id)?.next;
        }
        Ok(())
    }

    /// Returns the size and the alignment of a value of this type, in bytes.
    fn layout(&self, id: u16) -> Result<(usize, usize), Fault> {
        let entry = self.entry(id)?;
        if entry.kind != Type::Cluster {
            let bytes = entry.kind.bytes();
            return Ok((bytes, bytes.max(1)));
        }
        let (mut size, mut alignment, mut member) = (0usize, 1, id + 1);
        for _ in 0..entry.members {
            let (bytes, align) = self.layout(member)?;
            size = size.next_multiple_of(align) + bytes;
            alignment = alignment.max(align);
            member = self.entry(member)?.next;
        }
        Ok((size.next_multiple_of(alignment), alignment))
    }

    fn read<const N: usize>(&self, at: usize) -> Result<[u8; N], Fault> {
        self.bytes.get(at..at + N).and_then(|bytes| bytes.try_into().ok()).ok_or(Fault::Pointer)
    }

    fn write<const N: usize>(&mut self, at: usize, value: [u8; N]) -> Result<(), Fault> {
        self.bytes.get_mut(at..at + N).ok_or(Fault::Pointer)?.copy_from_slice(&value);
        Ok(())
    }
}
