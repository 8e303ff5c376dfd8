//! Each effect of the built-in robot leaves its own signature in the logs; the healthy robot shows none of them.
//!
//! Every test records the same random driving with and without an effect and compares one measure.

mod drive;
mod held_out;
mod measures;
mod outside_table;
mod sonar;
mod tracker;
