//! Prediction errors of a simulator on logs: per step, over open-loop paths, and at the end of a controller's runs.

pub mod accuracy;
pub mod dead_reckoning;
pub mod final_position;
pub mod observations;
pub mod paths;
pub mod predictions;
pub mod repeats;
pub mod replay;
pub mod sensor_models;
pub mod support;
