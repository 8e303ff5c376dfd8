//! What runs on the robot: the six-tuple threshold controller and small simulator neural networks (SNNs).
//!
//! * [`controller`]: a [`Tuple`](controller::Tuple), a [`Controller`](controller::Controller) of six of them, and the
//!   [`Machine`](controller::Machine) that steps through it.
//! * [`network`]: one hidden layer of summation and product units, evaluated over any [`Scalar`](scalar::Scalar).
//! * [`maths`]: the only powers, logarithms and sines in use, the same bits on every machine.
//! * [`binary`]: networks and controllers as checked bytes.
//!
//! Nothing here allocates, panics or calls the platform's maths.
#![cfg_attr(not(test), no_std)]

pub mod binary;
pub mod chance;
pub mod controller;
pub mod fixed_network;
pub mod fixed_point;
pub mod folded;
pub mod maths;
pub mod network;
pub mod scalar;
