//! The gap between a simulator and logs: where it lies, which effect causes it, and how far it shrinks.
//!
//! [`diagnose`] answers with a [`Diagnosis`]. A hypothesis is one or more [`effects`], each a wrapper round a step of the
//! [`baseline`]; [`search`] fits it and judges it on runs that it was not fitted on, [`explanation`] settles on the
//! effects that hold, [`generic`] bounds what any effect could explain, and [`verdict`] weighs it all by thresholds that
//! [`calibration`] holds.

pub mod admission;
pub mod calibration;
pub mod channel;
pub mod circumstances;
pub mod confirmation;
pub mod contexts;
pub mod diagnosis;
pub mod excitation;
pub mod experiment;
pub mod explanation;
pub mod generic;
pub mod hypothesis;
pub mod scripts;
pub mod search;
pub mod shape;
pub mod shrink;
pub mod verdict;

pub use diagnosis::{Diagnosis, Findings, closed, diagnose, findings};
