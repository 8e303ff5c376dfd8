//! Reads and validates an .rxe file: afterwards every reference between parts of the file is valid.

use std::ops::Range;

use mindgap_core::limits::POOL_BYTES;

use super::decode::{Decoded, decode};
use crate::bytecode::{CLUMP_RECORD_BYTES, DEFAULT_ZERO, DOPE_VECTOR_BYTES, HEADER_BYTES, MAGIC, NONE, Type};

/// Deepest nesting of data that is accepted. The firmware has no limit; sensible programs have at most four levels.
const MAX_NESTING: u16 = 6;
/// The first bytes of a program in native code, which only extended firmware runs.
const NATIVE_MAGIC: &[u8] = b"NXTBINARY";
const OLDEST_MINOR_VERSION: u8 = 4;
const NEWEST_MAJOR_VERSION: u8 = 1;
/// One clump number is reserved for "none".
const MAX_CLUMPS: u16 = 254;

/// A program for the standard firmware, checked and ready to run.
///
/// ```
/// use mindgap_controller_export::brick::Program;
/// use mindgap_controller_export::onboard::Safety;
/// use mindgap_controller_export::rxe;
/// use mindgap_controller_export::wiring::Wiring;
/// # use mindgap_core::controller::{Controller, Tuple, When};
/// # let ahead = Tuple { left: 55, right: 48, when: When::Smaller, threshold_cm: 42 };
/// # let controller = Controller { step_ms: 400, max_steps: 150, tuples: [ahead; 6] };
///
/// let file = rxe::program(&controller, &Wiring::default(), Safety::default())?;
/// assert_eq!(Program::load(&file)?.file_bytes(), file.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    pub(super) entries: Vec<Entry>,
    pub(super) clumps: Vec<Clump>,
    pub(super) code: Vec<u16>,
    /// The instruction at each word of the code.
    pub(super) decoded: Vec<Decoded>,
    /// The dataspace at the start of the program: values, then arrays.
    pub(super) data: Vec<u8>,
    pub(super) static_bytes: usize,
    pub(super) dope: Vec<DopeVector>,
    file_bytes: usize,
}

/// The reason why the firmware would refuse a program.
///
/// ```
/// use mindgap_controller_export::brick::Program;
///
/// let error = Program::load(b"no program").unwrap_err();
/// assert_eq!(error.to_string(), "not a program for the standard firmware: it is shorter than its header");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("not a program for the standard firmware: {0}")]
pub struct LoadError(&'static str);

/// A value, or the description of an array's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) kind: Type,
    /// Offset in the dataspace, or within the element of its array; 0 for a cluster.
    offset: u16,
    /// Number of members of a cluster.
    pub(super) members: u16,
    /// Index of the entry after this one and all its parts.
    pub(super) next: u16,
    /// Whether the initial value is stored in the file; otherwise it is zero.
    stored: bool,
}

/// A unit of scheduling: a task or a subroutine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Clump {
    /// Number of clumps that have to finish before this one starts.
    pub(super) fire_count: u8,
    pub(super) dependents: Vec<u8>,
    /// Range of its instructions in the program's code.
    pub(super) code: Range<usize>,
}

/// Location and size of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DopeVector {
    /// Offset in the dataspace; `None` until the array has its first element.
    pub(super) offset: Option<usize>,
    pub(super) element_bytes: usize,
    pub(super) count: usize,
    /// Size to which the array can grow without moving, in bytes.
    pub(super) capacity: usize,
}

impl Program {
    /// Reads an .rxe file, with all checks of the firmware and those that it omits.
    ///
    /// # Errors
    /// Returns a [`LoadError`] that names the first check that fails.
    pub fn load(file: &[u8]) -> Result<Program, LoadError> {
        let header = Header::read(file)?;
        let mut rest = Reader { bytes: file, at: HEADER_BYTES };
        let entries = read_entries(rest.take(4 * usize::from(header.entries))?)?;
        rest.align();
        let defaults = rest.take(usize::from(header.default_bytes))?;
        rest.align();
        let clumps = read_clumps(&mut rest, &header)?;
        let code: Vec<u16> = words(rest.take(2 * usize::from(header.code_words))?).collect();
        if rest.at != file.len() {
            return Err(LoadError("there are bytes after the code"));
        }
        let data = inflate(&entries, defaults, &header)?;
        let dope = read_dope_vectors(&data, &header)?;
        let static_bytes = usize::from(header.static_bytes);
        let decoded = decode(&code);
        let program = Program { entries, clumps, code, decoded, data, static_bytes, dope, file_bytes: file.len() };
        if program.pool_bytes() > POOL_BYTES {
            return Err(LoadError("it needs more memory than the brick has for programs"));
        }
        Ok(program)
    }

    /// Returns the size of the file, in bytes.
    pub fn file_bytes(&self) -> usize {
        self.file_bytes
    }

    /// Returns the memory at the start for clump records, values and arrays, in bytes. The brick has [`POOL_BYTES`].
    pub fn pool_bytes(&self) -> usize {
        (self.clumps.len() * CLUMP_RECORD_BYTES).next_multiple_of(4) + self.data.len()
    }

    /// Returns the number of 16-bit words of code.
    pub fn code_words(&self) -> usize {
        self.code.len()
    }
}

impl Entry {
    /// Returns the offset in the dataspace, given that of the array element that contains this entry.
    pub(super) fn at(&self, base: usize) -> usize {
        usize::from(self.offset) + base
    }
}

struct Header {
    entries: u16,
    data_bytes: u16,
    static_bytes: u16,
    default_bytes: u16,
    dynamic_offset: u16,
    dynamic_bytes: u16,
    head: u16,
    tail: u16,
    dope_offset: u16,
    clumps: u16,
    code_words: u16,
}

impl Header {
    fn read(file: &[u8]) -> Result<Header, LoadError> {
        if file.starts_with(NATIVE_MAGIC) {
            return Err(LoadError("it is native code, not bytecode"));
        }
        let header = file.get(..HEADER_BYTES).ok_or(LoadError("it is shorter than its header"))?;
        if header[..MAGIC.len()] != MAGIC {
            return Err(LoadError("it does not begin with MindstormsNXT"));
        }
        if header[14] > NEWEST_MAJOR_VERSION || header[15] < OLDEST_MINOR_VERSION {
            return Err(LoadError("the firmware does not support its file version"));
        }
        let mut fields = words(&header[16..]);
        let mut field = || fields.next().ok_or(LoadError("it is shorter than its header"));
        let header = Header {
            entries: field()?,
            data_bytes: field()?,
            static_bytes: field()?,
            default_bytes: field()?,
            dynamic_offset: field()?,
            dynamic_bytes: field()?,
            head: field()?,
            tail: field()?,
            dope_offset: field()?,
            clumps: field()?,
            code_words: field()?,
        };
        if header.clumps == 0 || header.clumps > MAX_CLUMPS {
            return Err(LoadError("it has no clump, or more than 254"));
        }
        if header.code_words == 0 || header.data_bytes == 0 || header.entries == NONE {
            return Err(LoadError("it has no code or no data"));
        }
        Ok(header)
    }
}

fn read_entries(table: &[u8]) -> Result<Vec<Entry>, LoadError> {
    let mut entries = Vec::with_capacity(table.len() / 4);
    for row in table.chunks_exact(4) {
        let kind = Type::from_number(row[0]).ok_or(LoadError("it has an unknown data type"))?;
        let offset = u16::from_le_bytes([row[2], row[3]]);
        let (offset, members) = if kind == Type::Cluster { (0, offset) } else { (offset, 0) };
        let stored = row[1] & DEFAULT_ZERO == 0;
        entries.push(Entry { kind, offset, members, next: NONE, stored });
    }
    // Parts follow the value that contains them, so in reverse order every part comes before it.
    let mut depths = vec![0; entries.len()];
    for at in (0..entries.len()).rev() {
        let parts = match entries[at].kind {
            Type::Array => 1,
            Type::Cluster => entries[at].members,
            _ => 0,
        };
        let mut next = at + 1;
        for _ in 0..parts {
            let part = entries.get(next).ok_or(LoadError("an array or cluster lacks its parts"))?;
            depths[at] = depths[at].max(depths[next] + 1);
            next = usize::from(part.next);
        }
        if depths[at] > MAX_NESTING {
            return Err(LoadError("its data are nested too deeply"));
        }
        entries[at].next = u16::try_from(next).map_err(|_| LoadError("it has too many data entries"))?;
    }
    Ok(entries)
}

fn read_clumps(rest: &mut Reader, header: &Header) -> Result<Vec<Clump>, LoadError> {
    let records: Vec<_> = rest.take(4 * usize::from(header.clumps))?.chunks_exact(4).collect();
    let starts: Vec<_> = records.iter().map(|r| usize::from(u16::from_le_bytes([r[2], r[3]]))).collect();
    let ends = starts.iter().skip(1).copied().chain([usize::from(header.code_words)]);
    let mut clumps = Vec::new();
    for ((record, start), end) in records.iter().zip(&starts).zip(ends) {
        if *start >= end {
            return Err(LoadError("a clump has no code"));
        }
        let dependents = rest.take(usize::from(record[1]))?.to_vec();
        if dependents.iter().any(|clump| u16::from(*clump) >= header.clumps) {
            return Err(LoadError("a clump waits for one that does not exist"));
        }
        clumps.push(Clump { fire_count: record[0], dependents, code: *start..end });
    }
    rest.align();
    if clumps.iter().all(|clump| clump.fire_count > 0) {
        return Err(LoadError("no clump starts"));
    }
    Ok(clumps)
}

/// Expands the stored defaults into the initial dataspace.
fn inflate(entries: &[Entry], defaults: &[u8], header: &Header) -> Result<Vec<u8>, LoadError> {
    const TOO_SMALL: LoadError = LoadError("it has data outside the dataspace");
    let (static_bytes, dynamic_at) = (usize::from(header.static_bytes), usize::from(header.dynamic_offset));
    let (stored, dynamic) =
        defaults.split_at_checked(dynamic_at).ok_or(LoadError("its default values are cut short"))?;
    if dynamic.len() != usize::from(header.dynamic_bytes) {
        return Err(LoadError("its default values are cut short"));
    }
    let mut data = vec![0; usize::from(header.data_bytes)];
    let mut stored = Reader { bytes: stored, at: 0 };
    let mut at = 0;
    while let Some(entry) = entries.get(at) {
        // A cluster's members follow as separate entries; an array's element is only described.
        at = if entry.kind == Type::Array { usize::from(entry.next) } else { at + 1 };
        let bytes = entry.kind.bytes();
        if bytes > 0 {
            let at = entry.at(0);
            let place = data.get_mut(at..at + bytes).ok_or(TOO_SMALL)?;
            if entry.stored {
                place.copy_from_slice(stored.take(bytes)?);
            }
        }
    }
    if !stored.is_at_end() {
        return Err(LoadError("it has more default values than data"));
    }
    data.get_mut(static_bytes..static_bytes + dynamic.len()).ok_or(TOO_SMALL)?.copy_from_slice(dynamic);
    Ok(data)
}

/// Reads the dope vectors and walks their list as the firmware's memory manager does: in the order of their offsets, and
/// every vector once.
fn read_dope_vectors(data: &[u8], header: &Header) -> Result<Vec<DopeVector>, LoadError> {
    const BROKEN: LoadError = LoadError("its list of arrays is damaged");
    let at = usize::from(header.dope_offset);
    let first = data.get(at..at + DOPE_VECTOR_BYTES).ok_or(BROKEN)?;
    let [offset, element_bytes, count, ..] = fields(first);
    if usize::from(offset) != at || usize::from(element_bytes) != DOPE_VECTOR_BYTES {
        return Err(BROKEN);
    }
    let table = data.get(at..at + DOPE_VECTOR_BYTES * usize::from(count)).ok_or(BROKEN)?;
    let vectors: Vec<_> = table.chunks_exact(DOPE_VECTOR_BYTES).map(fields).collect();

    let mut list = Vec::new();
    let mut next = header.head;
    while next != NONE {
        let [offset, .., link] = *vectors.get(usize::from(next)).ok_or(BROKEN)?;
        if list.len() == vectors.len() || (link == NONE) != (next == header.tail) {
            return Err(BROKEN);
        }
        list.push((next, offset));
        next = link;
    }
    let placed = list.iter().filter(|(_, offset)| *offset != NONE);
    if list.len() != vectors.len() || !placed.clone().is_sorted_by_key(|(_, offset)| *offset) {
        return Err(BROKEN);
    }

    let mut dope = vec![DopeVector { offset: None, element_bytes: 0, count: 0, capacity: 0 }; vectors.len()];
    let ends = placed.clone().skip(1).map(|(_, offset)| usize::from(*offset)).chain([data.len()]);
    for ((vector, offset), end) in placed.zip(ends) {
        let [_, element_bytes, count, ..] = vectors[usize::from(*vector)];
        let (offset, element_bytes, count) = (usize::from(*offset), usize::from(element_bytes), usize::from(count));
        if offset + element_bytes * count > end {
            return Err(BROKEN);
        }
        let capacity = end - offset;
        dope[usize::from(*vector)] = DopeVector { offset: Some(offset), element_bytes, count, capacity };
    }
    for (vector, [offset, element_bytes, ..]) in dope.iter_mut().zip(&vectors) {
        if *offset == NONE {
            vector.element_bytes = usize::from(*element_bytes);
        }
    }
    Ok(dope)
}

fn fields(vector: &[u8]) -> [u16; 5] {
    std::array::from_fn(|i| u16::from_le_bytes([vector[2 * i], vector[2 * i + 1]]))
}

fn words(bytes: &[u8]) -> impl Iterator<Item = u16> {
    bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
}

struct Reader<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Reader<'b> {
    fn take(&mut self, count: usize) -> Result<&'b [u8], LoadError> {
        let taken = self.bytes.get(self.at..self.at + count).ok_or(LoadError("it is cut short"))?;
        self.at += count;
        Ok(taken)
    }

    /// Skips to an even offset, because the firmware reads words only there.
    fn align(&mut self) {
        self.at += self.at % 2;
    }

    fn is_at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }
}
