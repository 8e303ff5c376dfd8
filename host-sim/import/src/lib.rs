//! Imports recordings of a real robot as a folder of logs.
//!
//! - [`brick`]: a brick's logs and a camera's tracks. [`brick_log`] and [`track`] read them, and [`clocks`] aligns theirs.
//! - [`streams`] and [`bag`]: commands, poses and readings as CSV or as a ROS 2 bag. Both become [`recording`]s, which
//!   [`assemble`] puts together; [`draft`] writes what is known of the robot, and marks the rest.
//!
//! Wherever two sources meet, [`sides`] holds their motion against each other in one unit. Reports name everything that was
//! guessed, changed or left out.

pub mod assemble;
pub mod bag;
pub mod brick;
pub mod brick_log;
pub mod clocks;
mod columns;
pub mod draft;
pub mod frame;
pub mod mapping;
pub mod motion;
mod quantities;
pub mod recording;
pub mod report;
pub mod sides;
pub mod streams;
mod table;
mod timestamps;
pub mod track;
pub mod units;
