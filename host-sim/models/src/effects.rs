//! What a simulator may lack of reality: effects, as wrappers round one simulator step with a few named parameters.
//!
//! An [`Effect`] has an id of the table in docs/formats.md and one or more [`Variant`]s, the functional forms in which
//! it may show. A variant's hooks change the commands that reach the motors, the increment of the pose that comes out,
//! or the sensor; at its nominal parameters it changes nothing. The same variant is a hypothesis while a gap is
//! diagnosed and a part of the simulator once it is [`applied`].
//!
//! A further effect is a file in `effects/catalogue/` and a line in `effects/catalogue.rs`; users state [`own`] ones.

pub mod applied;
pub mod catalogue;
pub mod chain;
pub mod context;
pub mod own;
pub mod parameter;
pub mod pose_increment;
pub mod signs;
pub mod variant;

pub use catalogue::{CATALOGUE, Candidate};
pub use context::StepContext;
pub use parameter::Parameter;
pub use pose_increment::PoseIncrement;
pub use variant::{Effect, Hook, Late, SensorState, Variant};
