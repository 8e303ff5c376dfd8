//! What the tests share: the built command, the folders of logs that a public clone does not have, golden files, and
//! the compiler for NXT programs.

pub mod command;
pub mod elsewhere;
pub mod golden;
pub mod nbc;
pub mod rooms;
