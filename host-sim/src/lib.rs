//! The host harness: learns a robot's simulator neural networks from its logs, evolves controllers in them, and
//! measures both.

pub mod chance;
pub mod files;
pub mod geometry;
pub mod logs;
pub mod problem;
pub mod report;
