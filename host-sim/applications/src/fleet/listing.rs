//! What lies where the logs of a fleet are.

/// The robots of a fleet by the names of their folders, in order.
#[derive(Debug, Default, PartialEq)]
pub struct Listing {
    /// The robots.
    pub names: Vec<String>,
    /// What lies beside them and is no robot's: files.
    pub left_out: Vec<String>,
}
