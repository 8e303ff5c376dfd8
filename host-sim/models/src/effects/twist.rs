//! The twist of a differential drive: what both wheels do alike, and what they do against each other.

/// Returns the mean of left and right wheel, and half of the difference of right and left one.
pub fn twist([left, right]: [f64; 2]) -> [f64; 2] {
    [0.5 * (left + right), 0.5 * (right - left)]
}

/// Returns left and right wheel of a [`twist`].
pub fn wheels([mean, half_difference]: [f64; 2]) -> [f64; 2] {
    [mean - half_difference, mean + half_difference]
}
