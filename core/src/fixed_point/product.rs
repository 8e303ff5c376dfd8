//! Products of two 32-bit words.
//!
//! Processors without an instruction for the 64-bit product (`build.rs` names them) compute it from four 16-bit products,
//! in a third of the time of the compiler's own routine for two 64-bit words.

/// Returns the whole product.
#[cfg(not(short_products))]
#[inline(always)]
pub fn product(a: i32, b: i32) -> i64 {
    i64::from(a) * i64::from(b)
}

/// Returns the upper half of the product. With p and q fractional bits in `a` and `b` it has p + q - 32.
#[cfg(not(short_products))]
#[inline(always)]
pub fn upper_product(a: u32, b: u32) -> u32 {
    ((u64::from(a) * u64::from(b)) >> 32) as u32
}

/// Returns the upper half of the product, for a number that is stored in halves, the lower one first.
#[cfg(not(short_products))]
#[inline(always)]
pub fn upper_product_of_halves(a: [u16; 2], b: u32) -> u32 {
    upper_product((u32::from(a[1]) << 16) | u32::from(a[0]), b)
}

#[cfg(short_products)]
pub use short::{product, upper_product, upper_product_of_halves};

#[cfg(any(test, short_products))]
mod short {
    pub fn product(a: i32, b: i32) -> i64 {
        let (a_low, a_high) = (a & 0xffff, a >> 16);
        let (b_low, b_high) = (b & 0xffff, b >> 16);
        let low = (a_low as u32).wrapping_mul(b_low as u32);
        // |high · low| is at most 2^15 · (2^16 - 1), which leaves room to add 16 bits.
        let middle = (a_high * b_low).wrapping_add((low >> 16) as i32);
        let other = (a_low * b_high).wrapping_add(middle & 0xffff);
        let high = (a_high * b_high).wrapping_add(middle >> 16).wrapping_add(other >> 16);
        (i64::from(high) << 32) | i64::from(((other as u32) << 16) | (low & 0xffff))
    }

    pub fn upper_product(a: u32, b: u32) -> u32 {
        upper_product_of_halves([a as u16, (a >> 16) as u16], b)
    }

    /// The compiler does not see a whole number in the halves, and so does not call its routine for 64-bit products.
    pub fn upper_product_of_halves(a: [u16; 2], b: u32) -> u32 {
        let (a_low, a_high) = (u32::from(a[0]), u32::from(a[1]));
        let (b_low, b_high) = (b & 0xffff, b >> 16);
        let middle = (a_high * b_low).wrapping_add((a_low * b_low) >> 16);
        let other = (a_low * b_high).wrapping_add(middle & 0xffff);
        (a_high * b_high).wrapping_add(middle >> 16).wrapping_add(other >> 16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn short_products_are_exact_at_the_ends_of_the_range() {
        let ends = [i32::MIN, i32::MIN + 1, -65_537, -65_536, -1, 0, 1, 65_535, 65_536, i32::MAX - 1, i32::MAX];
        for a in ends {
            for b in ends {
                assert_eq!(short::product(a, b), product(a, b), "{a} · {b}");
                let (a, b) = (a as u32, b as u32);
                assert_eq!(short::upper_product(a, b), upper_product(a, b), "{a} · {b}");
            }
        }
    }

    proptest! {
        #[test]
        fn short_products_are_exact(a in any::<i32>(), b in any::<i32>()) {
            prop_assert_eq!(short::product(a, b), product(a, b));
            prop_assert_eq!(short::upper_product(a as u32, b as u32), upper_product(a as u32, b as u32));
        }
    }
}
