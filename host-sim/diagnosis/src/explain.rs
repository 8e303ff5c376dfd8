//! Explanation of a gap for people: where it lies, what it depends on, and the evidence for each effect.

mod covariates;
pub mod evidence;
pub mod profile;
pub mod room_map;
pub mod strata;
