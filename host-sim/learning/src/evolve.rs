//! Evolution of controllers in a simulator (paper, section IX).

pub mod success_probability;
pub mod fitness;
pub mod genome;
pub mod paper;
pub mod explore;
pub mod request;
pub mod robust;
mod stops;
pub mod task;
#[cfg(test)]
mod test_support;
pub mod trial;
pub mod route;
