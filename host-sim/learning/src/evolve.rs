//! Evolution of controllers in a simulator (paper, section IX).

pub mod explore;
pub mod fitness;
pub mod genome;
pub mod paper;
pub mod request;
pub mod robust;
pub mod route;
mod stops;
pub mod success_probability;
pub mod task;
#[cfg(test)]
mod test_support;
pub mod trial;
