//! Logs of the built-in robot, resampled and as tables in memory.

mod resample;
mod tables;
