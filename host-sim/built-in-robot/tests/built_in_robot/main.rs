//! Tests of the built-in robot, healthy and with effects, by its logs.

mod effect_signatures;
mod healthy;
