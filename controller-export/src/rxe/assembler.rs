//! A small assembler for the standard firmware, with a single clump and one method per instruction.

use super::layout::{Array, Cluster, Dataspace, Number};
use crate::bytecode::{
    Comparison, HEADER_BYTES, InputField, MAGIC, NONE, Op, OutputField, Syscall, Type, VARIABLE_SIZE,
};

/// The file version of firmware 1.28 and later.
const FILE_VERSION: [u8; 2] = [0, 6];

/// A program under construction. Data are declared as needed; instructions are appended in order.
#[derive(Debug, Default)]
pub(super) struct Assembler {
    data: Dataspace,
    code: Vec<u16>,
    labels: Vec<Option<usize>>,
    branches: Vec<Branch>,
}

/// A position in the code, which is [bound](Assembler::bind) once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label(usize);

#[derive(Debug)]
struct Branch {
    /// Offset of the branch instruction, to which its target is relative.
    at: usize,
    to: Label,
}

impl Assembler {
    pub(super) fn number(&mut self, kind: Type, value: i32) -> Number {
        self.data.number(kind, value)
    }

    pub(super) fn array(&mut self, kind: Type, values: impl IntoIterator<Item = i32>) -> Array {
        self.data.array(kind, values)
    }

    /// Declares a string: its bytes and a NUL.
    pub(super) fn string(&mut self, text: &str) -> Array {
        self.data.array(Type::U8, text.bytes().chain([0]).map(i32::from))
    }

    /// Declares a cluster whose members are the numbers and arrays declared next.
    pub(super) fn cluster(&mut self, members: u16) -> Cluster {
        self.data.cluster(members)
    }

    pub(super) fn label(&mut self) -> Label {
        self.labels.push(None);
        Label(self.labels.len() - 1)
    }

    /// Binds a label to the current position.
    pub(super) fn bind(&mut self, label: Label) {
        self.labels[label.0] = Some(self.code.len());
    }

    /// Returns a label bound to the current position.
    pub(super) fn here(&mut self) -> Label {
        let label = self.label();
        self.bind(label);
        label
    }

    pub(super) fn mov(&mut self, to: Number, from: Number) {
        self.instruction(Op::Mov, None, &[to.0, from.0]);
    }

    pub(super) fn mov_array(&mut self, to: Array, from: Array) {
        self.instruction(Op::Mov, None, &[to.0, from.0]);
    }

    pub(super) fn set(&mut self, to: Number, value: u16) {
        self.instruction(Op::Set, None, &[to.0, value]);
    }

    pub(super) fn add(&mut self, to: Number, left: Number, right: Number) {
        self.instruction(Op::Add, None, &[to.0, left.0, right.0]);
    }

    pub(super) fn sub(&mut self, to: Number, left: Number, right: Number) {
        self.instruction(Op::Sub, None, &[to.0, left.0, right.0]);
    }

    pub(super) fn abs(&mut self, to: Number, from: Number) {
        self.instruction(Op::Abs, None, &[to.0, from.0]);
    }

    pub(super) fn index(&mut self, to: Number, array: Array, index: Number) {
        self.instruction(Op::Index, None, &[to.0, array.0, index.0]);
    }

    pub(super) fn jump(&mut self, to: Label) {
        self.branch(to);
        self.instruction(Op::Jmp, None, &[0]);
    }

    /// Branches if the comparison of two numbers holds.
    pub(super) fn branch_if(&mut self, left: Number, comparison: Comparison, right: Number, to: Label) {
        self.branch(to);
        self.instruction(Op::BrCmp, Some(comparison), &[0, left.0, right.0]);
    }

    /// Branches if the comparison of a number with zero holds.
    pub(super) fn branch_if_zero(&mut self, value: Number, comparison: Comparison, to: Label) {
        self.branch(to);
        self.instruction(Op::BrTst, Some(comparison), &[0, value.0]);
    }

    pub(super) fn call(&mut self, call: Syscall, arguments: Cluster) {
        self.instruction(Op::Syscall, None, &[call as u16, arguments.0]);
    }

    pub(super) fn wait(&mut self, ms: Number) {
        self.instruction(Op::Wait, None, &[NONE, ms.0]);
    }

    pub(super) fn tick(&mut self, to: Number) {
        self.instruction(Op::GetTick, None, &[to.0]);
    }

    pub(super) fn set_input(&mut self, port: Number, field: InputField, value: Number) {
        self.instruction(Op::SetIn, None, &[value.0, port.0, field as u16]);
    }

    pub(super) fn get_input(&mut self, to: Number, port: Number, field: InputField) {
        self.instruction(Op::GetIn, None, &[to.0, port.0, field as u16]);
    }

    pub(super) fn get_output(&mut self, to: Number, port: Number, field: OutputField) {
        self.instruction(Op::GetOut, None, &[to.0, port.0, field as u16]);
    }

    /// Sets fields of one output, in the given order.
    pub(super) fn set_output<const N: usize>(&mut self, port: Number, fields: [(OutputField, Number); N]) {
        let words = 3 + 2 * N as u16;
        self.code.extend([VARIABLE_SIZE << 12 | Op::SetOut as u16, 2 * words, port.0]);
        self.code.extend(fields.into_iter().flat_map(|(field, value)| [field as u16, value.0]));
    }

    pub(super) fn stop(&mut self) {
        self.instruction(Op::Stop, None, &[NONE]);
    }

    /// Returns the program as an .rxe file. Every label that is used has to be bound.
    pub(super) fn into_file(mut self) -> Vec<u8> {
        for Branch { at, to } in &self.branches {
            let target = self.labels[to.0].expect("a label is bound where it is used");
            self.code[at + 1] = (target as i32 - *at as i32) as i16 as u16;
        }
        let data = self.data.into_sections();
        let dynamic_offset = data.defaults.len() - data.dynamic_bytes;
        let fields = [
            data.table.len() / 4,
            data.static_bytes + data.dynamic_bytes,
            data.static_bytes,
            data.defaults.len(),
            dynamic_offset,
            data.dynamic_bytes,
            data.head.into(),
            data.tail.into(),
            data.dope_offset,
            1,
            self.code.len(),
        ];
        let mut file = [&MAGIC[..], &FILE_VERSION].concat();
        file.extend(fields.into_iter().flat_map(|field| (field as u16).to_le_bytes()));
        debug_assert_eq!(file.len(), HEADER_BYTES);
        file.extend(data.table);
        file.extend(data.defaults);
        file.resize(file.len().next_multiple_of(2), 0);
        // The only clump waits for none, starts none, and begins at the first word.
        file.extend([0, 0, 0, 0]);
        file.extend(self.code.iter().flat_map(|word| word.to_le_bytes()));
        file
    }

    fn branch(&mut self, to: Label) {
        self.branches.push(Branch { at: self.code.len(), to });
    }

    fn instruction(&mut self, op: Op, comparison: Option<Comparison>, operands: &[u16]) {
        let bytes = 2 + 2 * operands.len() as u16;
        debug_assert_eq!(op.bytes(), Some(bytes));
        let comparison = comparison.map_or(0, |comparison| comparison as u16);
        self.code.push(bytes << 12 | comparison << 8 | op as u16);
        self.code.extend(operands);
    }
}
