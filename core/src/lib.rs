//! What runs on the robot: the six-tuple threshold controller and small simulator neural networks (SNNs).
//!
//! * [`controller`]: a [`Tuple`](controller::Tuple), a [`Controller`](controller::Controller) of six of them, and the
//!   [`Machine`](controller::Machine) that steps through it.
//! * [`network`]: a trained network, one hidden layer of summation and product units.
//! * [`folded`]: the one evaluator of networks, their summation units folded together, over any
//!   [`Scalar`](scalar::Scalar); a [`Pair`](pair::Pair) of numbers is one.
//! * [`fixed_network`]: folded networks in fixed point, over the numbers and functions of [`fixed_point`].
//! * [`chance`]: whether an echo comes back, and the scatter of a reading, in fixed point.
//! * [`maths`]: the only powers, logarithms and sines of floats in use, the same bits on every machine.
//! * [`limits`]: what an NXT-class brick has room for, checked when this crate is compiled.
//!
//! Nothing here allocates, panics or calls the platform's maths.
#![cfg_attr(not(test), no_std)]

pub mod chance;
pub mod controller;
pub mod fixed_network;
pub mod fixed_point;
pub mod folded;
pub mod limits;
pub mod maths;
pub mod network;
pub mod pair;
pub mod scalar;
