//! Learns a simulator from logs: data sets, trainers, and evaluation on held-out logs.

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
