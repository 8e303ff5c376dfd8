//! Statistics without a robot in them.

pub mod agreement;
pub mod bootstrap;
pub mod maximise;
pub mod student;
pub mod summary;
