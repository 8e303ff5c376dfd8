#![doc = include_str!("../README.md")]
//!
//! ## Modules
//!
//! * [`controller`]: a [`Tuple`](controller::Tuple), a [`Controller`](controller::Controller) of six tuples, and the
//!   [`Machine`](controller::Machine) that steps through them.
//! * [`network`]: a trained network with one hidden layer of summation and product units.
//! * [`folded`]: networks with their summation units folded into one affine map, and their evaluator, which works on any
//!   [`Scalar`](scalar::Scalar).
//! * [`fixed_network`]: folded networks in fixed point, built on the numbers and functions of [`fixed_point`].
//! * [`chance`]: random draws in fixed point: whether an echo returns, and the noise of a reading.
//! * [`monitor`]: onboard monitor that detects when a robot no longer matches its simulator.
//! * [`maths`]: powers, logarithms and sines in `f32`, with the same bits on every machine.
//! * [`scalar`], [`pair`]: the numbers that networks are evaluated on.
//! * [`limits`]: the memory of an NXT-class brick, checked when this crate is compiled.
//!
//! "The paper" in these pages is C. J. Pretorius, M. C. du Plessis and C. B. Cilliers (2013), *A Neural Network Ultrasonic
//! Sensor Simulator for Evolutionary Robotics*.
#![cfg_attr(not(test), no_std)]

pub mod chance;
pub mod controller;
pub mod fixed_network;
pub mod fixed_point;
pub mod folded;
pub mod limits;
pub mod maths;
pub mod monitor;
pub mod network;
pub mod pair;
pub mod scalar;

pub use fixed;
pub use heapless;
pub use rand_core;
