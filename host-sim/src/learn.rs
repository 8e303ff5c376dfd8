//! Learning a simulator from logs: data sets, the trainers, and how well the networks do on logs they never saw.

pub mod dataset;
pub mod evaluate;
pub mod fast;
pub mod genome;
pub mod kernel;
pub mod paper;
pub mod reference;
pub mod scatter;
pub mod statistics;
pub mod train;
