//! How far compressed files may expand: a small one can hold endless data.

/// Maximum ratio of expanded to compressed size: robot logs compress by about a factor of ten, and those of a robot at rest, which
/// repeat the same line, stay below it.
pub const MOST_TIMES: u64 = 256;
/// Expanded size that is always allowed, bytes, for small files.
pub const LEAST_BYTES: u64 = 1 << 20;

/// Returns the largest allowed size of what a file of `compressed` bytes expands to, bytes.
pub fn most_bytes(compressed: u64) -> u64 {
    MOST_TIMES * compressed + LEAST_BYTES
}
