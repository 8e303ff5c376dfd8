//! A fixed explanation.

/// A fixed explanation of a finding or a verdict.
pub struct Entry {
    /// Id as in JSON.
    pub id: &'static str,
    /// What it is.
    pub what: &'static str,
    /// What imitates it.
    pub imitated_by: &'static str,
    /// How to check it.
    pub check: &'static str,
}
