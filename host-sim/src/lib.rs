//! The host harness: learns a robot's simulator neural networks from its logs, evolves controllers in them, and
//! measures both.

pub mod built_in_robot;
pub mod challenge;
pub mod chance;
pub mod cli;
pub mod crosscheck;
pub mod demo;
pub mod effects;
pub mod evaluation;
pub mod evolve;
pub mod files;
pub mod gap;
pub mod genetic;
pub mod geometry;
pub mod import;
pub mod lanes;
pub mod learn;
pub mod logs;
pub mod problem;
pub mod report;
pub mod simulator;
pub mod sonar;
pub mod statistics;
