//! The built-in robot, healthy and with its effects, as its logs show it.

mod effect_signatures;
mod healthy;
