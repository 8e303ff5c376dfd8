//! Effects: candidate causes of a sim-to-real gap, as wrappers around one simulator step with a few named parameters.
//!
//! An [`Effect`] has an id of the table in docs/reference/effects.md and one or more [`Variant`]s, its functional forms. A variant's
//! hooks change the commands that reach the motors, the motion that results, or the sensor; at its nominal parameters it
//! changes nothing. The same variant is a hypothesis while a gap is diagnosed, and a part of the simulator once it is
//! [`applied`].
//!
//! To add an effect, write a file in `effects/catalogue/` and a line in `effects/catalogue.rs`; users define [`own`] ones.

pub mod applied;
pub mod catalogue;
pub mod chain;
pub mod context;
pub mod drive_filter;
pub mod lagging_heading;
pub mod own;
pub mod parameter;
pub mod pieces;
pub mod scales;
pub mod twist;
pub mod variant;
pub mod witness;

pub use catalogue::{CATALOGUE, Candidate};
pub use context::StepContext;
pub use parameter::Parameter;
pub use variant::{Effect, Hook, Late, Place, SensorState, Variant};
