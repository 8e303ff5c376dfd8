//! What the tests share: the built command, and the folders of logs that a public clone does not have.

pub mod controllers;
pub mod fixed_point_error;
pub mod nbc;
pub mod on_board;
