//! What every other crate of the host builds on: errors, random streams, vector lanes, statistics, geometry, motion.

pub mod chance;
pub mod channel;
pub mod counter;
pub mod error;
pub mod geometry;
pub mod lanes;
pub mod motion;
pub mod statistics;
