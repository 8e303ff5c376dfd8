//! The host harness: learns a robot's simulator neural networks from its logs, evolves controllers in them, and
//! measures both.

pub mod built_in_robot;
pub mod chance;
pub mod cli;
pub mod files;
pub mod geometry;
pub mod logs;
pub mod problem;
