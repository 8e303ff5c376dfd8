//! Writes the causes of a gap into the model file of somebody's simulator: text in, text out.
//!
//! - [`cause`]: a named effect with unrounded numbers; [`engine`]: which engine ignores which tag.
//! - [`model`]: a model file. One module per format knows its tags: `urdf`, `sdf`, `mjcf`, `webots`, `ros_yaml` and
//!   `robot_toml`.
//! - [`patch`]: which cause goes into which file, and why the others do not; [`diff`]: the same for people; [`snippet`]: what no
//!   tag can say, as lines for a driver.
//!
//! The digits of a value are replaced in place. All other bytes of a file stay as they are, and so does its number of lines.

pub mod cause;
pub mod diff;
mod edit;
pub mod engine;
pub mod estimate;
mod gazebo;
mod mjcf;
pub mod model;
mod orientation;
pub mod patch;
mod payload;
mod refusal;
mod robot_toml;
mod ros_yaml;
mod sdf;
pub mod snippet;
mod urdf;
mod webots;
mod wheels;
mod xml;
