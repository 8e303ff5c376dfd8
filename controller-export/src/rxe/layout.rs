//! The dataspace of an .rxe file, laid out as nbc does: its table, its default values, and its arrays with the linked list
//! of the firmware's memory manager.

use crate::bytecode::{DEFAULT_ZERO, DOPE_VECTOR_BYTES, NONE, Type};

/// A number in the dataspace.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number(pub(super) u16);

/// An array of numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Array(pub(super) u16);

/// A cluster: the arguments of a call.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster(pub(super) u16);

/// A dataspace under construction.
#[derive(Debug, Default)]
pub(super) struct Dataspace {
    table: Vec<u8>,
    defaults: Vec<u8>,
    static_bytes: usize,
    arrays: Vec<Stored>,
}

/// The sections of a dataspace in the file.
#[derive(Debug)]
pub(super) struct Sections {
    /// Four bytes per entry: type, flags, offset.
    pub(super) table: Vec<u8>,
    /// Values that are not zero, then [`dynamic_bytes`](Self::dynamic_bytes) of arrays.
    pub(super) defaults: Vec<u8>,
    pub(super) static_bytes: usize,
    /// Size of the arrays and their dope vectors, which are the last bytes of the defaults.
    pub(super) dynamic_bytes: usize,
    /// Offset of the dope vectors in the dataspace.
    pub(super) dope_offset: usize,
    /// First and last dope vector of the memory manager's list.
    pub(super) head: u16,
    pub(super) tail: u16,
}

#[derive(Debug)]
struct Stored {
    slot: usize,
    element_bytes: usize,
    content: Vec<u8>,
}

impl Dataspace {
    pub(super) fn number(&mut self, kind: Type, value: i32) -> Number {
        let offset = self.reserve(kind.bytes());
        let id = self.entry(kind, value == 0, offset);
        if value != 0 {
            self.defaults.extend(&value.to_le_bytes()[..kind.bytes()]);
        }
        Number(id)
    }

    pub(super) fn array(&mut self, kind: Type, values: impl IntoIterator<Item = i32>) -> Array {
        let slot = self.reserve(Type::Array.bytes());
        let id = self.entry(Type::Array, false, slot);
        self.entry(kind, false, 0);
        let content = values.into_iter().flat_map(|value| value.to_le_bytes().into_iter().take(kind.bytes())).collect();
        self.arrays.push(Stored { slot, element_bytes: kind.bytes(), content });
        // Dope vector 0 is that of the table itself.
        self.defaults.extend((self.arrays.len() as u16).to_le_bytes());
        Array(id)
    }

    /// Declares a cluster of the next `members` numbers and arrays.
    pub(super) fn cluster(&mut self, members: u16) -> Cluster {
        self.reserve_aligned(4);
        Cluster(self.entry(Type::Cluster, false, usize::from(members)))
    }

    pub(super) fn into_sections(mut self) -> Sections {
        self.reserve_aligned(4);
        let static_bytes = self.static_bytes;
        let mut dynamic = Vec::new();
        let mut offsets = Vec::new();
        for array in &self.arrays {
            pad(&mut dynamic);
            offsets.push((!array.content.is_empty()).then_some(static_bytes + dynamic.len()));
            dynamic.extend(&array.content);
        }
        pad(&mut dynamic);
        let dope_offset = static_bytes + dynamic.len();

        // The list is ordered by offset: arrays with content, the table of dope vectors, arrays without content.
        let numbers = |filled: bool| (1..).zip(&offsets).filter(move |(_, o)| o.is_some() == filled).map(|(i, _)| i);
        let list: Vec<u16> = numbers(true).chain([0]).chain(numbers(false)).collect();
        let link = |vector: u16| {
            let after = list.iter().skip_while(|other| **other != vector).nth(1);
            after.copied().unwrap_or(NONE)
        };
        let count = self.arrays.len() + 1;
        // The fourth field once pointed back to the array; the firmware sets it.
        let table = [dope_offset as u16, DOPE_VECTOR_BYTES as u16, count as u16, NONE, link(0)];
        dynamic.extend(table.iter().flat_map(|field| field.to_le_bytes()));
        for ((vector, array), offset) in (1..).zip(&self.arrays).zip(&offsets) {
            let elements = array.content.len() / array.element_bytes;
            let offset = offset.map_or(NONE, |offset| offset as u16);
            let fields = [offset, array.element_bytes as u16, elements as u16, array.slot as u16, link(vector)];
            dynamic.extend(fields.iter().flat_map(|field| field.to_le_bytes()));
        }
        self.defaults.extend(&dynamic);
        Sections {
            table: self.table,
            defaults: self.defaults,
            static_bytes,
            dynamic_bytes: dynamic.len(),
            dope_offset,
            head: list[0],
            tail: list[list.len() - 1],
        }
    }

    fn entry(&mut self, kind: Type, zero: bool, offset: usize) -> u16 {
        let id = (self.table.len() / 4) as u16;
        self.table.extend([kind as u8, if zero { DEFAULT_ZERO } else { 0 }]);
        self.table.extend((offset as u16).to_le_bytes());
        id
    }

    /// Reserves an aligned offset for a value, because the processor needs natural alignment.
    fn reserve(&mut self, bytes: usize) -> usize {
        self.reserve_aligned(bytes);
        self.static_bytes += bytes;
        self.static_bytes - bytes
    }

    fn reserve_aligned(&mut self, bytes: usize) {
        self.static_bytes = self.static_bytes.next_multiple_of(bytes);
    }
}

fn pad(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0xFF);
}
