//! Figures of the paper and charts of the pages, drawn from plain data.
//!
//! There is one module per figure, on a small set of common parts: [`svg`] writes shapes, [`axis`] and [`chart`] draw planes with
//! axes, `legend` and `glyph` draw keys and marks. Every drawing is a [`Figure`]: a file of its own as SVG or PNG, or an element
//! of a page. Nothing here depends on how the data were made, and the same data give the same bytes.

pub mod axis;
pub mod before_and_after;
pub mod chart;
pub mod curves;
pub mod driven;
pub mod expected_against_predicted;
pub mod figure;
pub mod over_time;
pub mod paths;
pub mod room;
pub mod room_map;
pub mod scatter;
pub mod segments;
pub mod shares;
pub mod sonar_surfaces;
pub mod style;
pub mod svg;

mod glyph;
mod legend;
mod output;
#[cfg(not(target_family = "wasm"))]
mod png;
mod projection;
mod scale;
mod trend;

pub use expected_against_predicted::expected_against_predicted;
pub use figure::Figure;
pub use paths::paths;
pub use sonar_surfaces::sonar_surfaces;
