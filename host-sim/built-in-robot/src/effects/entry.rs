//! The entry of an effect in the catalogue or the held-out list.

use super::Scale;

/// Description and scales of an effect.
pub(super) struct Entry {
    pub id: &'static str,
    pub about: &'static str,
    pub in_table: bool,
    pub strength: Scale,
    pub detail: Option<Scale>,
}
