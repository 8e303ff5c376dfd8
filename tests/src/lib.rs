//! What the tests share: the built command, golden files, error bounds of fixed point, the compiler for NXT programs,
//! ROS 2 bags, how often robots end where they are expected, how programs that measure end, and which modules of a crate
//! know which.

pub mod command;
pub mod controllers;
pub mod coverage;
pub mod exit_code;
pub mod faults;
pub mod firmware_networks;
pub mod fixed_point_error;
pub mod golden;
pub mod held_out_scans;
pub mod module_order;
pub mod modules;
pub mod nbc;
pub mod plausible_networks;
pub mod rooms;
pub mod ros_bags;
