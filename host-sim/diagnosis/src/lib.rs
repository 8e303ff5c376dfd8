//! The gap between a simulator and logs: where it lies, which effect causes it, and how far it shrinks.
//!
//! [`mod@diagnose`] is the method, stage by stage: validate, condition, fit, compare, confirm, account, explain, propose.
//! Each stage has a file of that name. A [hypothesis] is one or more [effects](mindgap_models::effects) round a step of the
//! [baseline](mindgap_models::simulator::baseline); the [omnibus] residual model bounds what any effect could explain; the
//! thresholds are those of the [calibration]. What is left may follow a [formula].

pub mod account;
pub mod budget;
pub mod calibration;
pub mod channel;
pub mod compare;
pub mod condition;
pub mod confirm;
pub mod diagnose;
pub mod diagnosis;
pub mod excitation;
pub mod explain;
mod feigned;
pub mod fit;
pub mod formula;
pub mod gain;
pub mod hypothesis;
mod ledger;
mod memo;
pub mod method;
pub mod omnibus;
pub mod own_error;
pub mod progress;
pub mod propose;
pub mod remainder;
pub mod request;
pub mod residual_law;
pub mod scatter;
pub mod scope;
pub mod survey;
#[cfg(test)]
pub(crate) mod test_support;
pub mod validate;

pub use diagnose::{Findings, diagnose, findings, findings_watched};
pub use diagnosis::Diagnosis;
pub use method::Method;
