//! Statistics without a robot in them.

pub mod agreement;
pub mod bootstrap;
pub mod intraclass;
pub mod maximise;
pub mod ridge;
pub mod rounding;
pub mod student;
pub mod summary;
