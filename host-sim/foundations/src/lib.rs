//! Foundations of every host crate: errors, random streams, SIMD lanes, statistics, geometry, motion.

pub mod channel;
pub mod counter;
pub mod error;
pub mod executor;
pub mod geometry;
pub mod lanes;
pub mod motion;
pub mod random;
pub mod schema_number;
pub mod statistics;
