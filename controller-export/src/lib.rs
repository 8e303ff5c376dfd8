//! Turns a six-tuple controller into an onboard program.

pub mod rust_networks;
