//! A user's own simulator against the robot: both sides as recordings, the simulator learned from one and diagnosed on the other.

pub mod coverage;
pub mod layers;
pub mod pairs;
pub mod sides;
pub mod verify;
