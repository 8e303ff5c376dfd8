//! Helpers that tests of several crates share, and measurements that the programs in `examples` print.

pub mod command;
pub mod controllers;
pub mod coverage;
pub mod exit_code;
pub mod faults;
pub mod firmware_networks;
pub mod fixed_point_error;
pub mod form;
pub mod golden;
pub mod held_out_scans;
pub mod module_order;
pub mod modules;
pub mod nbc;
pub mod plausible_networks;
pub mod range_sensors;
pub mod rooms;
pub mod ros_bags;
