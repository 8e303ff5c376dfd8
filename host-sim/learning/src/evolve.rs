//! Evolution of controllers in a simulator (paper, section IX).

pub mod chance;
pub mod controller_file;
pub mod fitness;
pub mod genome;
pub mod paper;
pub mod prefixes;
pub mod request;
pub mod robust;
mod stops;
pub mod task;
#[cfg(test)]
mod test_support;
pub mod trial;
pub mod way;
