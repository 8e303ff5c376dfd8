//! The gap between a simulator and logs: where it lies, which effect causes it, and how far it shrinks.

pub mod baseline;
pub mod effect;
pub mod effects;
pub mod evidence;
pub mod hypothesis;
pub mod search;
