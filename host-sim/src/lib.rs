//! The host harness: learns a robot's simulator neural networks from its logs, evolves controllers in them, and
//! measures both.

pub mod chance;
pub mod cli;
pub mod files;
pub mod genetic;
pub mod geometry;
pub mod lanes;
pub mod logs;
pub mod problem;
pub mod learn;
pub mod simulator;
