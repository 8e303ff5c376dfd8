//! Logs of the built-in robot: commands at their own times, resampled, as tables in memory, and the robot that they belong to.

mod commands;
mod range_sensor;
mod resample;
mod robot;
mod tables;
