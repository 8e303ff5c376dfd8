//! Results as text for one screen: of a terminal, or on a page.

mod budget;
mod diagnosis;
mod survey;

pub use diagnosis::text as diagnosis;
pub use survey::{amounts, holdings, text as survey};
