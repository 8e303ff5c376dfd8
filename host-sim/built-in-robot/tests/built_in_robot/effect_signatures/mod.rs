//! Each effect of the built-in robot leaves its own mark in the logs, and the healthy robot leaves none of them.
//!
//! Every test records the same random driving with and without an effect and takes one measure of both.

mod beside;
mod drive;
mod held_out;
mod measures;
mod sonar;
mod tracker;
