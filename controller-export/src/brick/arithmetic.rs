//! Arithmetic of the firmware. Integers are 32 bits wide and wrap; x/0 is 0 and x%0 is x.

use std::cmp::Ordering;

use super::Fault;
use crate::bytecode::{Comparison, Op, Type};

/// A decoded instruction on numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Operation {
    pub(super) op: Op,
    pub(super) comparison: Comparison,
}

/// Returns the order of two integers, which are compared as signed numbers when both types are signed.
pub(super) fn order(left: u32, right: u32, left_type: Type, right_type: Type) -> Ordering {
    if left_type.is_signed() && right_type.is_signed() { (left as i32).cmp(&(right as i32)) } else { left.cmp(&right) }
}

impl Operation {
    pub(super) fn unary(self, x: u32, kind: Type) -> Result<u32, Fault> {
        Ok(match self.op {
            Op::Mov => x,
            Op::Neg => x.wrapping_neg(),
            // Logical, not bit by bit.
            Op::Not => u32::from(x == 0),
            Op::Tst => u32::from(self.comparison.holds(Some(order(x, 0, kind, kind)))),
            Op::Abs => (x as i32).unsigned_abs(),
            // The firmware does not implement the square root of an integer.
            Op::Sqrt => 0,
            _ => return Err(Fault::Instruction),
        })
    }

    pub(super) fn unary_float(self, x: f32) -> Result<f32, Fault> {
        Ok(match self.op {
            Op::Mov => x,
            Op::Neg => -x,
            Op::Not => truth(x == 0.0),
            Op::Tst => truth(self.comparison.holds(x.partial_cmp(&0.0))),
            Op::Abs => x.abs(),
            Op::Sqrt => x.sqrt(),
            _ => return Err(Fault::Instruction),
        })
    }

    #[inline]
    pub(super) fn binary(self, left: u32, right: u32, left_type: Type, right_type: Type) -> Result<u32, Fault> {
        let signed = left_type.is_signed() && right_type.is_signed();
        Ok(match self.op {
            Op::Add => left.wrapping_add(right),
            Op::Sub => left.wrapping_sub(right),
            Op::Mul => left.wrapping_mul(right),
            Op::Div if right == 0 => 0,
            Op::Div if signed => (left as i32).wrapping_div(right as i32) as u32,
            Op::Div => left / right,
            Op::Mod if right == 0 => left,
            Op::Mod if signed => (left as i32).wrapping_rem(right as i32) as u32,
            Op::Mod => left % right,
            Op::And => left & right,
            Op::Or => left | right,
            Op::Xor => left ^ right,
            Op::Cmp => u32::from(self.comparison.holds(Some(order(left, right, left_type, right_type)))),
            _ => return Err(Fault::Instruction),
        })
    }

    pub(super) fn binary_float(self, left: f32, right: f32) -> Result<f32, Fault> {
        let bits = |act: fn(i32, i32) -> i32| act(left as i32, right as i32) as f32;
        Ok(match self.op {
            Op::Add => left + right,
            Op::Sub => left - right,
            Op::Mul => left * right,
            Op::Div if right == 0.0 => 0.0,
            Op::Div => left / right,
            Op::Mod if right == 0.0 => left,
            // The divisor is truncated, and ARM's division by zero leaves no remainder.
            Op::Mod => bits(|a, b| if b == 0 { 0 } else { a.wrapping_rem(b) }),
            Op::And => bits(|a, b| a & b),
            Op::Or => bits(|a, b| a | b),
            Op::Xor => bits(|a, b| a ^ b),
            Op::Cmp => truth(self.comparison.holds(left.partial_cmp(&right))),
            _ => return Err(Fault::Instruction),
        })
    }
}

fn truth(holds: bool) -> f32 {
    f32::from(u8::from(holds))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binary(op: Op, left: i32, right: i32, left_type: Type, right_type: Type) -> i32 {
        let operation = Operation { op, comparison: Comparison::Less };
        operation.binary(left as u32, right as u32, left_type, right_type).unwrap() as i32
    }

    #[test]
    fn integers_wrap_and_division_by_zero_is_defined() {
        use Type::I32;
        assert_eq!(binary(Op::Mul, 46341, 46341, I32, I32), -2_147_479_015);
        assert_eq!(binary(Op::Div, -7, 2, I32, I32), -3);
        assert_eq!(binary(Op::Mod, -7, 2, I32, I32), -1);
        assert_eq!(binary(Op::Div, i32::MIN, -1, I32, I32), i32::MIN);
        assert_eq!(binary(Op::Div, 7, 0, I32, I32), 0);
        assert_eq!(binary(Op::Mod, 7, 0, I32, I32), 7);
    }

    #[test]
    fn comparison_is_unsigned_if_either_side_is() {
        assert_eq!(binary(Op::Cmp, -1, 1, Type::I32, Type::I16), 1);
        assert_eq!(binary(Op::Cmp, -1, 1, Type::I32, Type::U8), 0);
    }
}
