//! Logs of the built-in robot: resampled, as tables in memory, and the robot that they belong to.

mod resample;
mod robot;
mod tables;
