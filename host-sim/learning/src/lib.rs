//! Networks from logs and controllers from networks, with their evaluation.
//!
//! It follows and extends C. J. Pretorius, M. C. du Plessis and C. B. Cilliers (2013), "A Neural Network Ultrasonic Sensor
//! Simulator for Evolutionary Robotics", called "the paper" in these crates.

pub mod crosscheck;
pub mod evaluation;
pub mod evolve;
pub mod genetic;
pub mod learn;
