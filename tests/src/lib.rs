//! What the tests share: the built command, and the folders of logs that a public clone does not have.

pub mod firmware_networks;
pub mod fixed_point_error;
pub mod plausible_networks;
