//! Accuracy of fixed point, function by function and network by network.

mod firmware_networks;
mod function_error;
mod network_accuracy;
