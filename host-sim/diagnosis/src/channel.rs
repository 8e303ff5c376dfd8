//! The five things that a simulator predicts of a step.

pub use mindgap_foundations::channel::Channel;
