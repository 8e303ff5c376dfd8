//! What is known of an effect, whichever list it is in.

use super::Scale;

/// An entry of a list of effects.
pub(super) struct Entry {
    pub id: &'static str,
    pub about: &'static str,
    pub in_table: bool,
    pub strength: Scale,
    pub detail: Option<Scale>,
}
