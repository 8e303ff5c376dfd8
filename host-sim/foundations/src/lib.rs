//! Foundations of every host crate: errors, random streams, SIMD lanes, statistics, geometry.

pub mod counter;
pub mod error;
pub mod executor;
pub mod geometry;
pub mod lanes;
pub mod random;
pub mod statistics;
