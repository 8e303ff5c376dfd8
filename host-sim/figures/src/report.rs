//! Figures of the paper and of a diagnosis, drawn from plain data.
//!
//! There is one module a figure. Each returns a [`Figure`], which is written as SVG, and as PNG and PDF made from that SVG.
//! Nothing here depends on how the data were made, and the same data give the same bytes.

pub mod bars;
pub mod curves;
pub mod expected_against_predicted;
pub mod figure;
pub mod paths;
pub mod sonar_surfaces;

mod chart;
mod glyph;
mod legend;
mod projection;
mod style;
mod trend;

pub use bars::bars;
pub use curves::curves;
pub use expected_against_predicted::expected_against_predicted;
pub use figure::Figure;
pub use paths::paths;
pub use sonar_surfaces::sonar_surfaces;
