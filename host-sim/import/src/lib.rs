//! Imports recordings of a real robot as a log folder.
//!
//! - [`brick`]: brick logs and camera tracks, read by [`brick_log`] and [`track`] and aligned by [`clocks`].
//! - [`streams`] and [`bag`]: commands, poses and readings as CSV or as a ROS 2 bag. Both become [`recording`]s, which
//!   [`assemble`] combines; [`draft`] writes the known dimensions of the robot and marks the missing ones.
//!
//! Wherever two sources meet, [`scale_check`] compares their motion in one unit. Reports list everything that was guessed,
//! changed or left out.

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
pub mod scale_check;
pub mod streams;
mod table;
mod timestamps;
pub mod track;
pub mod units;
