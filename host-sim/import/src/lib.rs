//! Imports recordings of a real robot as a log folder.
//!
//! - Every text table is read by one parser: `table` finds header and rows, `layouts` knows the formats of motion capture,
//!   `columns` assigns quantities and units, and `file_streams` makes streams of them.
//! - [`brick`]: brick logs and camera tracks, aligned by [`clocks`].
//! - [`streams`] and [`bag`]: commands, poses and readings as tables or as a bag of ROS. Both become [`recording`]s, which
//!   [`assemble`] combines; [`draft`] writes the known dimensions of the robot and marks the missing ones.
//! - [`ros2_bag`] writes bags: commands for a simulator, and drives to look at in other tools.
//! - [`left_out`]: everything that is not used, with the reason. [`contents`]: what a recording holds.
//!
//! Wherever two sources meet, [`scale_check`] compares their motion in one unit. Reports list everything that was guessed,
//! changed or left out.

pub mod assemble;
pub mod bag;
mod batch;
mod body;
pub mod brick;
pub mod brick_log;
mod choice;
pub mod clocks;
mod column;
mod columns;
mod command_times;
pub mod contents;
pub mod draft;
mod expansion;
mod file_streams;
pub mod frame;
pub mod given;
mod joints;
mod layouts;
pub mod left_out;
pub mod mapping;
pub mod motion;
mod own_motion;
mod quantities;
mod range_sensors;
pub mod recording;
pub mod report;
pub mod ros2_bag;
mod rotation;
pub mod scale_check;
mod spatial_pose;
pub mod statements;
pub mod streams;
mod table;
mod timestamps;
pub mod track;
pub mod units;
mod upright;
mod words;
