//! Learns a simulator from logs: data sets, trainers, and evaluation on held-out logs.

pub mod beam;
pub mod dataset;
pub mod drive_filter;
pub mod echo_law;
pub mod ensemble;
pub mod familiar;
pub mod fast;
mod feature_regression;
pub mod genome;
pub mod kernel;
pub mod nominal;
pub mod paper;
pub mod place_bound;
pub mod scans;
pub mod scatter;
pub mod sensor_law;
pub mod train;
pub mod wheels;
