//! The host harness: learns a robot's simulator neural networks from its logs, evolves controllers in them, and
//! evaluates both.
//!
//! It follows and extends C. J. Pretorius, M. C. du Plessis and C. B. Cilliers (2013), "A Neural Network Ultrasonic Sensor
//! Simulator for Evolutionary Robotics", called "the paper" in this crate.

pub mod adapt;
pub mod built_in_robot;
pub mod challenge;
pub mod chance;
pub mod cli;
pub mod crosscheck;
pub mod demo;
pub mod effects;
pub mod error;
pub mod evaluation;
pub mod evolve;
pub mod files;
pub mod fleet;
pub mod gap;
pub mod genetic;
pub mod geometry;
pub mod import;
pub mod inspection;
pub mod lanes;
pub mod learn;
pub mod logs;
pub mod on_board;
pub mod page;
pub mod pictures;
pub mod report;
pub mod simulator;
pub mod sonar;
pub mod statistics;
pub mod survey;
pub mod trials;
pub mod workers;

#[cfg(test)]
#[test]
#[should_panic = "attempt to add with overflow"]
fn tests_run_with_overflow_checks() {
    std::hint::black_box(std::hint::black_box(u8::MAX) + 1);
}
