//! What every other crate of the host builds on: errors, random streams, vector lanes, statistics, geometry.

pub mod chance;
pub mod counter;
pub mod error;
pub mod geometry;
pub mod lanes;
pub mod statistics;
