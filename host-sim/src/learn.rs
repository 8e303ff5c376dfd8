//! Learning a simulator from logs: data sets, the trainers, and how well the networks do on logs they never saw.

pub mod dataset;
pub mod fast;
pub mod genome;
pub mod kernel;
pub mod nominal;
pub mod paper;
pub mod scatter;
pub mod train;
