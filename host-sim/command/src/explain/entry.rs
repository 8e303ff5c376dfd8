//! A fixed explanation.

/// A fixed explanation of a finding, a verdict or a term.
pub struct Entry {
    /// Id as in JSON.
    pub id: &'static str,
    /// What it is.
    pub what: &'static str,
    /// What imitates it; may be empty.
    pub imitated_by: &'static str,
    /// How to check it.
    pub check: &'static str,
}
