//! Procedures that use everything else: the closed loop with a robot, fleets, the blind challenge, the demo.

pub mod adapt;
pub mod challenge;
pub mod demo;
pub mod fleet;
pub mod on_board;
pub mod trials;
