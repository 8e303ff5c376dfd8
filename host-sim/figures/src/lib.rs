//! Figures of what commands find, as files.

pub mod pictures;
pub mod report;
