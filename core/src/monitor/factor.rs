//! Products that take one multiplication of 32 bits.

/// Fractional bits of the factor.
pub const FACTOR_BITS: u32 = 14;

/// A factor that also changes the number of fractional bits. A processor without a 64-bit product needs less than half the time
/// for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Factor {
    /// The factor, with [`FACTOR_BITS`]. It is most precise from one to two.
    pub factor: i16,
    /// How many bits a number loses first, at most 31.
    pub shift: u8,
    /// Limit on the magnitude of the shifted number; larger ones are clamped.
    pub most: i16,
}

impl Factor {
    /// Returns the product.
    #[inline(always)]
    pub(super) fn times(&self, number: i32) -> i32 {
        let most = i32::from(self.most);
        let number = number.wrapping_shr(u32::from(self.shift));
        let number = if number > most {
            most
        } else if number < -most {
            -most
        } else {
            number
        };
        (number * i32::from(self.factor)) >> FACTOR_BITS
    }
}
