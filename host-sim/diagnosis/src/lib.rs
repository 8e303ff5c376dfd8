//! The gap between a simulator and logs: where it lies, which effects cause it, and how far it shrinks.
//!
//! [`mod@diagnose`] is the method, one stage after the other: [`Fits`](search::Fits) → [`Search`](search::Search) →
//! [`Confirmed`](confirm::Confirmed) → [`Findings`]; each stage owns the one before. Logs are split into [rows](sample) that
//! explanations are fitted to and rows that they predict. An [explanation] of any kind [scores] them: a [fit] of
//! one or more [effects](mindgap_models::effects) around a step of the [baseline](mindgap_models::simulator::baseline), the [omnibus] regression
//! that bounds what any effect could explain, a [formula], [wider noise](wider_noise), or the simulator's
//! [epistemic error](epistemic_error). The thresholds are those of the [calibration].
//!
//! [`minimal`] is the same method in a few pages. Read it first.

pub mod account;
pub mod between_sessions;
pub mod budget;
pub mod calibration;
pub mod confirm;
pub mod diagnose;
pub mod diagnosis;
pub mod epistemic_error;
pub mod excitation;
pub mod explain;
pub mod explanation;
pub mod fit;
mod form_error;
pub mod formula;
pub mod further_shares;
pub mod gain;
mod gap_parts;
pub mod hypothesis;
pub mod interval;
pub mod method;
pub mod minimal;
pub mod motion_uncertainty;
pub mod noise_model;
pub mod omnibus;
pub mod outliers;
mod predictive_check;
pub mod progress;
pub mod propose;
pub mod remainder;
pub mod request;
mod residuals;
pub mod ruler;
pub mod sample;
pub mod scope;
pub mod scores;
pub mod search;
mod sensor_cache;
pub mod sensors;
pub mod sessions;
mod shipped;
pub mod slot;
pub mod split;
mod strength;
pub mod survey;
#[cfg(test)]
pub(crate) mod test_support;
pub mod validate;
pub mod verdict;
pub mod wider_noise;
pub mod witnesses;

pub use diagnose::{Findings, diagnose, findings, findings_watched};
pub use diagnosis::Diagnosis;
pub use method::Method;
