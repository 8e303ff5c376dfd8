//! Procedures built on the other crates: the closed loop with a robot, fleets, bundles, the blind challenge, the demo.

pub mod adapt;
pub mod bundle;
pub mod challenge;
pub mod closed_loop;
pub mod compare;
pub mod demo;
pub mod experiments;
pub mod export;
pub mod fleet;
pub mod on_board;
