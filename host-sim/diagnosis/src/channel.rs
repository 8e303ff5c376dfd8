//! The five quantities that a simulator predicts per step.

pub use mindgap_foundations::channel::Channel;
